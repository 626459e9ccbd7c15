// Reads EtherCAT slave information files (ETG.2000), as configuration tools have them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/dictionary/import_report.hpp"
#include "stator/ethercat/standard/imported_slave.hpp"

namespace stator::formats {

/// One device of a file, to choose among them.
struct EsiDevice {
  std::string type;            ///< <Type>, e.g. "EK1100"
  std::string name;            ///< for people
  std::uint32_t product = 0;   ///< product code
  std::uint32_t revision = 0;  ///< of it
  std::size_t line = 0;        ///< where it stands
};

/// Which device of a file is wanted.
struct EsiChoice {
  /// Its type or name, or its product code ("0x044C2C52" or in decimal), followed by "@" and a
  /// revision if it matters; empty: the only one, or the newest revision of the only type.
  std::string device;
  /// Types or idents of modules for its slots, in order; empty: those that the file has by default.
  std::vector<std::string> modules;
};

/// The devices of a file, those that are hidden as well.
[[nodiscard]] base::Expected<std::vector<EsiDevice>, dictionary::ImportError> esi_devices(
    std::string_view text);

/// Reads one device. What can be repaired is, and `report` says so; what was assumed or left out as
/// well. An error names line and rule, and the devices there are, if the choice fits none or
/// several.
[[nodiscard]] base::Expected<ethercat::ImportedSlave, dictionary::ImportError> read_esi(
    std::string_view text, const EsiChoice& choice, dictionary::ImportReport& report);

}  // namespace stator::formats
