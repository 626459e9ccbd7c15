#pragma once

#include "base/input.hpp"

namespace stator::devices {

using base::Input;

}  // namespace stator::devices
