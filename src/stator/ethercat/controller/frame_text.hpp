#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "stator/ethercat/standard/frame.hpp"

namespace stator::ethercat {

/// "LRW", "FPRD" ...; "?" for a number that is no command (ETG.1000.4 §5.4.1).
[[nodiscard]] std::string_view to_text(Command command);

/// Name of the register that the byte at `address` belongs to, from the register tables, e.g. "AL
/// Control", with the number of its FMMU, sync manager or port; empty if there is none.
[[nodiscard]] std::string register_name(std::uint16_t address);

}  // namespace stator::ethercat
