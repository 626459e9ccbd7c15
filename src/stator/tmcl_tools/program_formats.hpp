#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/tmcl/assembler/program.hpp"
#include "stator/tmcl/instruction.hpp"

namespace stator::tmcl_tools {

/// Seven bytes per instruction, as program memory holds them.
[[nodiscard]] std::string program_as_binary(std::span<const tmcl::Instruction> program);
/// The same bytes in hexadecimal, one instruction per line.
[[nodiscard]] std::string program_as_hex(std::span<const tmcl::Instruction> program);
/// The telegrams of a download in hexadecimal, one per line.
[[nodiscard]] std::string program_as_telegrams(std::span<const tmcl::Instruction> program,
                                               std::uint8_t module_address);
/// `text` with addresses and bytes beside each line, then labels and constants.
[[nodiscard]] std::string program_as_listing(const tmcl::Program& program, std::string_view text);

/// Reads any of the first three, told by the content. Throws Failure with file and line.
[[nodiscard]] std::vector<tmcl::Instruction> read_program(std::string_view content,
                                                          const std::string& file);

}  // namespace stator::tmcl_tools
