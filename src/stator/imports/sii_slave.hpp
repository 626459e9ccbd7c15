// A slave of which only its EEPROM is known.
#pragma once

#include <cstddef>
#include <span>

#include "stator/base/expected.hpp"
#include "stator/dictionary/import_report.hpp"
#include "stator/ethercat/standard/imported_slave.hpp"

namespace stator::imports {

/// What an SII image says of its slave (ETG.2010). Dumps of real devices end early, have categories
/// behind the end or a wrong checksum: what can be read is, and `report` says so.
[[nodiscard]] base::Expected<ethercat::ImportedSlave, dictionary::ImportError> slave_of_sii(
    std::span<const std::byte> image, dictionary::ImportReport& report);

}  // namespace stator::imports
