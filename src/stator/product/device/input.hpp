// Names base::Input and base::InputRange, the settable inputs of a device, in the namespace of
// products.
#pragma once

#include "stator/base/input.hpp"

namespace stator::product {

using base::Input;
using base::InputRange;

}  // namespace stator::product
