// What a rack file says of devices that a file describes.
#pragma once

#include "stator/devices/generic/node.hpp"
#include "stator/devices/generic/slave.hpp"
#include "stator/devices/generic/terminal.hpp"
#include "stator/settings/key.hpp"

namespace stator::devices::generic {

/// Of one with a mailbox.
extern const settings::Section<SlaveConfiguration> kSlaveKeys;
/// Of one without.
extern const settings::Section<TerminalConfiguration> kTerminalKeys;
/// Of a node on CANopen.
extern const settings::Section<NodeConfiguration> kNodeKeys;

}  // namespace stator::devices::generic
