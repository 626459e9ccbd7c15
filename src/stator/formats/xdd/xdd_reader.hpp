// Reads XML descriptions of CANopen devices (CiA 311): XDD, of a type of them, and XDC, of one that
// is configured.
#pragma once

#include <string_view>

#include "stator/base/expected.hpp"
#include "stator/canopen/eds/eds_file.hpp"
#include "stator/dictionary/import_report.hpp"

namespace stator::formats {

/// Reads an XDD or an XDC as what an EDS or a DCF of the same device would say. What can be
/// repaired is, and `report` says so; what was assumed or left out as well. An error names line and
/// rule; descriptions of POWERLINK devices, which have the same root, are refused as
/// "powerlink-xdd".
[[nodiscard]] base::Expected<canopen::EdsFile, dictionary::ImportError> read_xdd(
    std::string_view text, dictionary::ImportReport& report);

}  // namespace stator::formats
