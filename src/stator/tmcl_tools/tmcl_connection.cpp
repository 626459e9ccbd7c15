#include "stator/tmcl_tools/tmcl_connection.hpp"

#include <algorithm>
#include <span>

#include "stator/tmcl/assembler/program_image.hpp"
#include "stator/tmcl/command.hpp"

namespace stator::tmcl_tools {

namespace {

constexpr std::uint8_t kVersionText = 0;

bool asks_for_version_text(const tmcl::Instruction& instruction) {
  return static_cast<tmcl::Command>(instruction.command) == tmcl::Command::get_firmware_version &&
         instruction.type == kVersionText;
}

}  // namespace

bool has_reply(const tmcl::Instruction& instruction) {
  return static_cast<tmcl::Command>(instruction.command) != tmcl::Command::restore_factory_settings;
}

TmclReply reply_in(std::span<const std::byte> bytes, const tmcl::Instruction& instruction) {
  TmclReply reply;
  if (asks_for_version_text(instruction)) {
    for (const std::byte each : bytes) {
      reply.version += static_cast<char>(each);
    }
    return reply;
  }
  tmcl::Telegram telegram{};
  std::ranges::copy(bytes.first(std::min<std::size_t>(bytes.size(), 8)), telegram.begin() + 1);
  const tmcl::Reply decoded = tmcl::decode_reply(telegram);
  const bool reads_memory =
      static_cast<tmcl::Command>(instruction.command) == tmcl::Command::read_memory;
  // A refusal names the command it refuses; else the bytes are those of the cell.
  if (reads_memory && decoded.command != instruction.command) {
    const auto cell = tmcl::program_in(bytes.first(tmcl::kInstructionLength));
    reply.cell = cell->front();
    return reply;
  }
  reply.status = decoded.status;
  reply.value = decoded.value;
  return reply;
}

}  // namespace stator::tmcl_tools
