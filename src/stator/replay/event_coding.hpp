// How recordings hold events of a rack and the addresses of devices.
#pragma once

#include <optional>

#include "stator/rack/core/rack_configuration.hpp"
#include "stator/replay/byte_coding.hpp"

namespace stator::replay {

void write_device(ByteWriter& writer, rack::DeviceAddress device);
[[nodiscard]] rack::DeviceAddress read_device(ByteReader& reader);

void write_event(ByteWriter& writer, const rack::RackEvent& event);
/// Nothing: there is no event that makes sense.
[[nodiscard]] std::optional<rack::RackEvent> read_event(ByteReader& reader);

}  // namespace stator::replay
