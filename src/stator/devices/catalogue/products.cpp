#include "stator/devices/catalogue/products.hpp"

#include "stator/devices/junction/product.hpp"
#include "stator/devices/tmc8461/product.hpp"
#include "stator/devices/tmc8670/product.hpp"
#include "stator/devices/tmcc160/product.hpp"
#include "stator/devices/tmcm_142/product.hpp"
#include "stator/devices/tmcm_3315/product.hpp"

namespace stator::devices {

void add_products(product::Catalogue& catalogue) {
  catalogue.add(tmcm_3315_product());
  catalogue.add(tmc8670_product());
  catalogue.add(tmcc160_product());
  catalogue.add(tmcm_142_product());
  catalogue.add(tmc8461_product());
  catalogue.add(junction_product());
}

const product::Catalogue& products() {
  static const product::Catalogue catalogue = [] {
    product::Catalogue made;
    add_products(made);
    return made;
  }();
  return catalogue;
}

}  // namespace stator::devices
