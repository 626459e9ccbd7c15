#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "stator/ethercat/sii/sii_image.hpp"

namespace stator::formats {

/// The EtherCAT slave information file (ETG.2000) of a device without mailbox and dictionary, from
/// what its EEPROM says: sync managers, PDOs, and `image` as ConfigData and, if there is one,
/// category 1 as a vector of its own (TMC8461 datasheet L8903-L8947).
[[nodiscard]] std::string chip_esi_xml(const ethercat::SiiContents& contents,
                                       const std::string& vendor_name,
                                       std::span<const std::byte> image);

}  // namespace stator::formats
