// What can be recorded of a device that a file describes.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "stator/devices/generic/drive.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::devices::generic {

/// The objects that can be mapped, named as object_names() has them, and what the drives have.
[[nodiscard]] std::vector<product::Signal> device_signals(const dictionary::Dictionary& objects,
                                                          const std::deque<Drive>& drives);

/// The entry is in the range of objects of one of so many drives.
[[nodiscard]] bool is_of_drive(const dictionary::Entry& entry, std::size_t drives);

}  // namespace stator::devices::generic
