#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/standard/device_description.hpp"

namespace stator::formats {

/// The EtherCAT slave information file (ETG.2000) of a device, generated from its description, its
/// dictionary (with data types, defaults, ranges, access and the default PDO mapping) and its SII
/// image, whose first words become ConfigData.
[[nodiscard]] std::string esi_xml(const ethercat::DeviceDescription& description,
                                  const dictionary::Dictionary& dictionary,
                                  std::span<const std::byte> sii);

}  // namespace stator::formats
