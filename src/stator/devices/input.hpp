#pragma once

#include "stator/base/input.hpp"

namespace stator::devices {

using base::Input;

}  // namespace stator::devices
