// The program stator, with the products that Stator has and those of files.
#include "stator/cli/program.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/imports/resolvers.hpp"

int main(int argc, char** argv) {
  stator::product::Catalogue catalogue = stator::devices::products();
  stator::imports::add_resolvers(catalogue);
  return stator::cli::run(argc, argv, catalogue);
}
