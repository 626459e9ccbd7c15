#include "stator/tmcl/assembler/program_image.hpp"

#include <algorithm>

#include "stator/tmcl/command.hpp"

namespace stator::tmcl {

namespace {

Telegram to_telegram(const Instruction& instruction, std::uint8_t address) {
  return encode(Request{.address = address,
                        .command = instruction.command,
                        .type = instruction.type,
                        .motor = instruction.motor,
                        .value = instruction.value});
}

Instruction to_instruction(const Telegram& telegram) {
  const Request request = decode_request(telegram);
  return {.command = request.command,
          .type = request.type,
          .motor = request.motor,
          .value = request.value};
}

bool frames_download(const Instruction& instruction) {
  const auto command = static_cast<Command>(instruction.command);
  return command == Command::start_download || command == Command::quit_download;
}

}  // namespace

std::vector<std::byte> image_of(std::span<const Instruction> program) {
  std::vector<std::byte> image;
  image.reserve(program.size() * kInstructionLength);
  for (const Instruction& instruction : program) {
    const Telegram telegram = to_telegram(instruction, 0);
    image.insert(image.end(), telegram.begin() + 1, telegram.end() - 1);
  }
  return image;
}

std::optional<std::vector<Instruction>> program_in(std::span<const std::byte> image) {
  if (image.size() % kInstructionLength != 0) {
    return std::nullopt;
  }
  std::vector<Instruction> program;
  program.reserve(image.size() / kInstructionLength);
  for (std::size_t i = 0; i < image.size(); i += kInstructionLength) {
    Telegram telegram{};
    std::ranges::copy(image.subspan(i, kInstructionLength), telegram.begin() + 1);
    program.push_back(to_instruction(telegram));
  }
  return program;
}

std::vector<Telegram> download_of(std::span<const Instruction> program,
                                  std::uint8_t module_address) {
  const auto control = [&](Command command) {
    return to_telegram({.command = static_cast<std::uint8_t>(command)}, module_address);
  };
  std::vector<Telegram> download{control(Command::start_download)};
  for (const Instruction& instruction : program) {
    download.push_back(to_telegram(instruction, module_address));
  }
  download.push_back(control(Command::quit_download));
  return download;
}

std::optional<std::vector<Instruction>> program_in(std::span<const Telegram> download) {
  if (!std::ranges::all_of(download, has_right_checksum)) {
    return std::nullopt;
  }
  std::vector<Instruction> program;
  for (const Telegram& telegram : download) {
    const Instruction instruction = to_instruction(telegram);
    if (!frames_download(instruction)) {
      program.push_back(instruction);
    }
  }
  return program;
}

}  // namespace stator::tmcl
