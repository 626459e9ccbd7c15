#pragma once

#include "stator/base/input.hpp"

namespace stator::product {

using base::Input;
using base::InputRange;

}  // namespace stator::product
