#pragma once

#include <vector>

#include "stator/dictionary/dictionary.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::product {

/// The values of all objects that can be mapped to PDOs, in their order, but for strings; named as
/// the objects are, in small letters with _ for blanks. `objects` is finished and outlives them.
[[nodiscard]] std::vector<Signal> object_signals(const dictionary::Dictionary& objects);

}  // namespace stator::product
