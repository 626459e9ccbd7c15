// The program stator with a product of one's own: every command knows it, so it can be run,
// scanned, described and tested as the products that Stator has.

#include "own_product/own_stepper.hpp"
#include "stator/cli/program.hpp"
#include "stator/devices/catalogue/products.hpp"

int main(int argc, char** argv) {
  stator::product::Catalogue catalogue = stator::devices::products();
  catalogue.add(own_product::own_stepper_product());
  return stator::cli::run(argc, argv, catalogue);
}
