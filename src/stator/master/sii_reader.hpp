#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "stator/master/bus.hpp"
#include "stator/master/slave.hpp"

namespace stator::master {

/// Reads a slave's SII from the start to the end of its categories, through registers 0500h to
/// 050Fh (ETG.1000.4 §6.5). The master takes the EEPROM from the host if need be.
[[nodiscard]] Result<std::vector<std::byte>> read_sii(Bus& bus, const Station& station);

/// What SII contents say (ETG.2010), as far as the master uses it. ErrorCode::sii if they are
/// damaged.
[[nodiscard]] Result<SlaveInformation> parse_sii(std::span<const std::byte> contents);

}  // namespace stator::master
