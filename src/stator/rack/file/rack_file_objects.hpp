#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "stator/devices/tmc8670/objects.hpp"

namespace stator::rack {

/// An object with its value, and a few words that are written behind it where it is new.
struct WrittenObject {
  devices::tmc8670::ObjectValue object;
  std::string meaning;
};

/// Where a device stands in a rack file, both counted from 0.
struct DevicePlace {
  std::size_t segment = 0;
  std::size_t device = 0;
};

/// The text of a rack file in which the `objects` of a device have the given values: those there
/// are get the new value in their place, the others follow; comments and layout stay. Negative
/// values are the two's complement in `bits`. Throws RackFileError when the text is no TOML or the
/// device stands within an inline array.
[[nodiscard]] std::string with_objects(const std::string& text, const std::string& file,
                                       const DevicePlace& place,
                                       std::span<const WrittenObject> objects);

}  // namespace stator::rack
