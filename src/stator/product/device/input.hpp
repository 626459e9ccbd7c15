#pragma once

#include "stator/base/input.hpp"

namespace stator::product {

using base::Input;

}  // namespace stator::product
