#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

/// Bytes of an instruction in program memory and on every wire: command, type, motor, and the value
/// with its most significant byte first (TMCM-142 TMCL Firmware Manual, L446-L460).
inline constexpr std::size_t kInstructionLength = 7;

[[nodiscard]] std::vector<std::byte> image_of(std::span<const Instruction> program);
/// The program of an image; none if its length is no multiple of kInstructionLength.
[[nodiscard]] std::optional<std::vector<Instruction>> program_in(std::span<const std::byte> image);

/// What a host sends to put a program into the memory of the module with that address, from memory
/// address 0 on: start of the download, the program, its end (L778-L783). The module answers each.
[[nodiscard]] std::vector<Telegram> download_of(std::span<const Instruction> program,
                                                std::uint8_t module_address);
/// The program that such telegrams download; none if one has a wrong checksum. Telegrams that start
/// and end a download may be missing.
[[nodiscard]] std::optional<std::vector<Instruction>> program_in(
    std::span<const Telegram> download);

}  // namespace stator::tmcl
