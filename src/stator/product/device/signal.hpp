#pragma once

#include "stator/base/signal.hpp"

namespace stator::product {

/// Its name is unique within the device.
using base::Signal;

}  // namespace stator::product
