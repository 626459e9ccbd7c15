// What a fault comes to with one product, where that is not what its kind says of all.
#pragma once

#include <string_view>

namespace stator::product {

/// A kind of fault (rack::FaultKind) at a product.
struct FaultConsequence {
  std::string_view kind;         ///< e.g. "motor-stall"
  std::string_view product;      ///< type, e.g. "tmcc160"
  std::string_view consequence;  ///< what its master sees: codes of emergencies, states
};

}  // namespace stator::product
