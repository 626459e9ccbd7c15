// Names base::Input and what belongs to it, the settable inputs of a device, in the namespace of
// products.
#pragma once

#include "stator/base/input.hpp"

namespace stator::product {

using base::Input;
using base::InputGroup;
using base::InputRange;

}  // namespace stator::product
