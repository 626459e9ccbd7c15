#include "stator/rack/faults/fault_commands.hpp"

#include <array>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "stator/base/spelling.hpp"
#include "stator/ethercat/standard/frame.hpp"

namespace stator::rack {

namespace {

using ethercat::Command;

constexpr std::array<std::pair<std::string_view, Command>, 14> kCommands{{
    {"APRD", Command::aprd},
    {"APWR", Command::apwr},
    {"APRW", Command::aprw},
    {"FPRD", Command::fprd},
    {"FPWR", Command::fpwr},
    {"FPRW", Command::fprw},
    {"BRD", Command::brd},
    {"BWR", Command::bwr},
    {"BRW", Command::brw},
    {"LRD", Command::lrd},
    {"LWR", Command::lwr},
    {"LRW", Command::lrw},
    {"ARMW", Command::armw},
    {"FRMW", Command::frmw},
}};

std::uint16_t bit_of(std::string_view name) {
  for (const auto& [known, command] : kCommands) {
    if (base::same_word(known, name)) {
      return static_cast<std::uint16_t>(1U << static_cast<unsigned>(command));
    }
  }
  return 0;
}

}  // namespace

std::uint16_t command_mask(std::string_view text) {
  std::istringstream words{std::string(text)};
  unsigned mask = 0;
  for (std::string word; words >> word;) {
    mask |= bit_of(word);
  }
  return static_cast<std::uint16_t>(mask);
}

std::string command_problem(const std::string& text) {
  std::istringstream words{text};
  bool any = false;
  for (std::string word; words >> word;) {
    any = true;
    if (bit_of(word) == 0) {
      return fmt::format(
          "\"{}\" is no EtherCAT command; write names separated by spaces, e.g. "
          "\"LRW FPRD\"",
          word);
    }
  }
  return any ? "" : R"("commands" names none; write e.g. "LRW")";
}

}  // namespace stator::rack
