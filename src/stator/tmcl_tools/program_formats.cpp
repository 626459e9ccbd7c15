#include "stator/tmcl_tools/program_formats.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <iterator>

#include <fmt/format.h>

#include "stator/tmcl/assembler/program_image.hpp"
#include "stator/tmcl_tools/failure.hpp"

namespace stator::tmcl_tools {

namespace {

using tmcl::Instruction;

std::string hexadecimal(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte each : bytes) {
    text += fmt::format("{}{:02x}", text.empty() ? "" : " ", std::to_integer<unsigned>(each));
  }
  return text;
}

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

bool is_space(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}
bool is_hexadecimal(char c) {
  return std::isxdigit(static_cast<unsigned char>(c)) != 0;
}

/// The lines of a text without their ends, the last also if it has none.
std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// The bytes that the digits of a line stand for.
std::vector<std::byte> bytes_in(std::string_view line, const std::string& place) {
  std::string digits;
  std::ranges::copy_if(line, std::back_inserter(digits), is_hexadecimal);
  if (digits.size() % 2 != 0) {
    throw Failure(
        fmt::format("{}: found {} hexadecimal digits; two make a byte", place, digits.size()));
  }
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    unsigned value = 0;
    std::from_chars(digits.data() + i, digits.data() + i + 2, value, 16);
    bytes.push_back(static_cast<std::byte>(value));
  }
  return bytes;
}

/// Of one line of instructions or telegrams; none for an empty line and those that only frame a
/// download.
std::vector<Instruction> program_in_line(std::string_view line, const std::string& place) {
  const std::vector<std::byte> bytes = bytes_in(line, place);
  if (bytes.empty()) {
    return {};
  }
  if (bytes.size() == tmcl::kInstructionLength) {
    return *tmcl::program_in(std::span(bytes));
  }
  if (bytes.size() != tmcl::kTelegramLength) {
    throw Failure(fmt::format("{}: found {} bytes; an instruction has {}, a telegram {}", place,
                              bytes.size(), tmcl::kInstructionLength, tmcl::kTelegramLength));
  }
  std::array<tmcl::Telegram, 1> telegram{};
  std::ranges::copy(bytes, telegram[0].begin());
  const auto program = tmcl::program_in(std::span<const tmcl::Telegram>(telegram));
  if (!program) {
    throw Failure(fmt::format("{}: found checksum {:02x}; the sum of the bytes before it is {:02x}",
                              place, std::to_integer<unsigned>(bytes.back()),
                              tmcl::checksum(telegram[0])));
  }
  return *program;
}

void append_names(std::string& text, const tmcl::Program& program) {
  if (!program.labels.empty()) {
    text += fmt::format("\n{:32}  {:>11}  {:>4}\n", "LABEL", "ADDRESS", "LINE");
  }
  for (const tmcl::Label& label : program.labels) {
    text += fmt::format("{:32}  {:11}  {:4}\n", label.name, label.address, label.line);
  }
  if (!program.constants.empty()) {
    text += fmt::format("\n{:32}  {:>11}  {:>4}\n", "CONSTANT", "VALUE", "LINE");
  }
  for (const tmcl::Constant& constant : program.constants) {
    text += fmt::format("{:32}  {:11}  {:4}\n", constant.name, constant.value, constant.line);
  }
}

}  // namespace

std::string program_as_binary(std::span<const Instruction> program) {
  const auto image = tmcl::image_of(program);
  return {reinterpret_cast<const char*>(image.data()), image.size()};
}

std::string program_as_hex(std::span<const Instruction> program) {
  std::string text;
  for (const Instruction& each : program) {
    text += hexadecimal(tmcl::image_of(std::span(&each, 1))) + '\n';
  }
  return text;
}

std::string program_as_telegrams(std::span<const Instruction> program,
                                 std::uint8_t module_address) {
  std::string text;
  for (const tmcl::Telegram& each : tmcl::download_of(program, module_address)) {
    text += hexadecimal(each) + '\n';
  }
  return text;
}

std::string program_as_listing(const tmcl::Program& program, std::string_view text) {
  std::string listing =
      fmt::format("{:>7}  {:20}  {:>4}  {}\n", "ADDRESS", "BYTES", "LINE", "TEXT");
  std::size_t address = 0;
  std::size_t number = 0;
  for (std::string_view line : lines_of(text)) {
    ++number;
    while (!line.empty() && is_space(line.back())) {
      line.remove_suffix(1);
    }
    std::string place;
    std::string bytes;
    if (address < program.lines.size() && program.lines[address] == number) {
      place = std::to_string(address);
      bytes = hexadecimal(tmcl::image_of(std::span(&program.instructions[address], 1)));
      ++address;
    }
    listing += fmt::format("{:>7}  {:20}  {:4}{}{}\n", place, bytes, number,
                           line.empty() ? "" : "  ", line);
  }
  append_names(listing, program);
  return listing;
}

std::vector<Instruction> read_program(std::string_view content, const std::string& file) {
  const bool text =
      std::ranges::all_of(content, [](char c) { return is_hexadecimal(c) || is_space(c); });
  if (!text) {
    const auto program = tmcl::program_in(bytes_of(content));
    if (!program) {
      throw Failure(fmt::format(
          "{} is no program: found {} bytes; expected hexadecimal digits, or {} bytes for each "
          "instruction",
          file, content.size(), tmcl::kInstructionLength));
    }
    return *program;
  }
  std::vector<Instruction> program;
  std::size_t number = 0;
  for (const std::string_view line : lines_of(content)) {
    const auto more = program_in_line(line, fmt::format("{}:{}", file, ++number));
    program.insert(program.end(), more.begin(), more.end());
  }
  return program;
}

}  // namespace stator::tmcl_tools
