#pragma once

#include <optional>
#include <string_view>

#include "stator/devices/tmc8670/configuration.hpp"
#include "stator/devices/tmc8670/objects.hpp"
#include "stator/settings/key.hpp"

namespace stator::devices {

/// What a rack file says of a TMC8670 (docs/rack-file.md).
extern const settings::Section<Tmc8670Configuration> kTmc8670Keys;

namespace tmc8670 {

/// The object that a key of `objects` names: "6065" or "2030:03", hexadecimal as documents write
/// it, with or without h behind the index. Its value is 0.
[[nodiscard]] std::optional<ObjectValue> object_named(std::string_view key);

}  // namespace tmc8670

}  // namespace stator::devices
