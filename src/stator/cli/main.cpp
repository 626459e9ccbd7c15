// The program stator, with the products that Stator has.
#include "stator/cli/program.hpp"
#include "stator/devices/catalogue/products.hpp"

int main(int argc, char** argv) {
  return stator::cli::run(argc, argv, stator::devices::products());
}
