#include "stator/product/catalogue/setup.hpp"

#include "stator/product/catalogue/product.hpp"

namespace stator::product {

std::unique_ptr<Device> Setup::make(base::EventReporter reporter) const {
  return product_->make(*this, reporter);
}

const CoeOptions* Setup::coe() const {
  return product_->coe(*this);
}

const dictionary::Quirks* Setup::quirks() const {
  return product_->quirks(*this);
}

const std::uint8_t* Setup::node_id() const {
  return product_->node_id(*this);
}

const TmclAddress* Setup::tmcl_address() const {
  return product_->tmcl_address(*this);
}

std::vector<AxisSetup> Setup::axes() {
  return product_->axes(*this);
}

}  // namespace stator::product
