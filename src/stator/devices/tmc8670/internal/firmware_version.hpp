#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace stator::devices::tmc8670 {

/// What 100Ah shows of a firmware image (A-57, F-79): the first "V<digits>.<digits>" in it, else
/// "image " with its CRC-32; V1.00, the firmware of the document, if there is none.
[[nodiscard]] std::string firmware_version(std::span<const std::byte> image);

}  // namespace stator::devices::tmc8670
