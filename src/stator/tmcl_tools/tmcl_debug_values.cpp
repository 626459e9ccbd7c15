#include "stator/tmcl_tools/tmcl_debug_values.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "stator/base/spelling.hpp"
#include "stator/tmcl/assembler/lexer.hpp"
#include "stator/tmcl/assembler/name_table.hpp"
#include "stator/tmcl/command.hpp"

namespace stator::tmcl_tools {

namespace {

using tmcl::Command;
using Number = base::Expected<std::int64_t, std::string>;

/// Registers are written with this sign, which the lexer of programs knows as that of hexadecimal
/// numbers; inside, their names begin with two underscores.
constexpr char kRegisterSign = '$';
constexpr std::string_view kRegisterPrefix = "__";
constexpr std::array<std::string_view, 10> kRegisters{
    "accu", "x", "pc", "depth", "time", "zero", "equal", "lower", "greater", "errors"};

/// Things that are called by a word and a number.
struct NumberedThing {
  std::string_view word;
  Command read;
  Command write;
  std::uint8_t bank;
  bool writable;
};
constexpr std::array<NumberedThing, 6> kNumberedThings{{
    {"AP_", Command::get_axis_parameter, Command::set_axis_parameter, 0, true},
    {"GP_", Command::get_global_parameter, Command::set_global_parameter, 0, true},
    {"COORD_", Command::get_coordinate, Command::set_coordinate, 0, true},
    {"IN_", Command::get_input, Command::get_input, 0, false},
    {"ANALOG_", Command::get_input, Command::get_input, 1, false},
    {"OUT_", Command::get_input, Command::set_output, 2, true},
}};

bool is_word_part(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// In the words of the lexer: "$accu" and "coord[3]" become names.
std::string as_names(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == kRegisterSign) {
      std::size_t end = i + 1;
      while (end < text.size() && is_word_part(text[end])) {
        ++end;
      }
      const std::string_view word = text.substr(i + 1, end - i - 1);
      const bool is_register = std::ranges::any_of(
          kRegisters, [&](std::string_view each) { return base::same_word(each, word); });
      result += is_register ? kRegisterPrefix : std::string_view("$");
    } else if (c == '[') {
      result += '_';
    } else if (c != ']') {
      result += c;
    }
  }
  return result;
}

struct Comparison {
  std::string_view sign;
  bool (*holds)(std::int64_t, std::int64_t);
};
/// Longer signs first, so that "<=" is not taken for "<".
constexpr std::array<Comparison, 6> kComparisons{{
    {"==", [](std::int64_t a, std::int64_t b) { return a == b; }},
    {"!=", [](std::int64_t a, std::int64_t b) { return a != b; }},
    {"<=", [](std::int64_t a, std::int64_t b) { return a <= b; }},
    {">=", [](std::int64_t a, std::int64_t b) { return a >= b; }},
    {"<", [](std::int64_t a, std::int64_t b) { return a < b; }},
    {">", [](std::int64_t a, std::int64_t b) { return a > b; }},
}};

const tmcl::ParameterDeclaration* with_symbol(
    std::span<const tmcl::ParameterDeclaration> parameters, std::string_view name) {
  const auto found = std::ranges::find_if(
      parameters, [&](const auto& each) { return base::same_word(each.symbol, name); });
  return found != parameters.end() ? &*found : nullptr;
}

}  // namespace

struct TmclDebugValues::Place {
  Command read;
  Command write;
  std::uint8_t type = 0;
  std::uint8_t motor = 0;
  bool writable = true;
};

std::optional<TmclDebugValues::Place> TmclDebugValues::find(std::string_view name) const {
  const tmcl::ModuleDescription& module = source_.module();
  if (const auto* axis = with_symbol(module.axis_parameters, name)) {
    return Place{Command::get_axis_parameter, Command::set_axis_parameter, axis->number};
  }
  if (const auto* global = with_symbol(module.global_parameters, name)) {
    return Place{Command::get_global_parameter, Command::set_global_parameter, global->number,
                 global->bank};
  }
  for (const NumberedThing& thing : kNumberedThings) {
    if (name.size() <= thing.word.size() ||
        !base::same_word(name.substr(0, thing.word.size()), thing.word)) {
      continue;
    }
    std::uint8_t number = 0;
    const char* end = name.data() + name.size();
    const auto [read, error] = std::from_chars(name.data() + thing.word.size(), end, number);
    if (error == std::errc() && read == end) {
      return Place{thing.read, thing.write, number, thing.bank, thing.writable};
    }
  }
  return std::nullopt;
}

std::optional<std::int64_t> TmclDebugValues::register_value(std::string_view name) const {
  const tmcl::FirmwareState& state = bench_.firmware().state();
  const tmcl::Registers& registers = state.registers;
  const std::array<std::int64_t, kRegisters.size()> values{
      registers.accumulator,
      registers.x,
      state.program_counter,
      static_cast<std::int64_t>(bench_.firmware().interpreter().stack_depth()),
      bench_.now().nanoseconds() / 1'000'000,
      registers.zero ? 1 : 0,
      registers.equal ? 1 : 0,
      registers.lower ? 1 : 0,
      registers.greater ? 1 : 0,
      registers.errors};
  for (std::size_t i = 0; i < kRegisters.size(); ++i) {
    if (base::same_word(name, kRegisters[i])) {
      return values[i];
    }
  }
  return std::nullopt;
}

tmcl::HostAnswer TmclDebugValues::direct(Command command, std::uint8_t type, std::uint8_t motor,
                                         std::int32_t value) const {
  return bench_.firmware().execute(
      {.command = static_cast<std::uint8_t>(command), .type = type, .motor = motor, .value = value},
      tmcl::Origin::serial, bench_.now());
}

Number TmclDebugValues::value_of(std::string_view name) const {
  if (name.starts_with(kRegisterPrefix)) {
    if (const auto value = register_value(name.substr(kRegisterPrefix.size()))) {
      return *value;
    }
  }
  if (const auto place = find(name)) {
    const tmcl::HostAnswer answer = direct(place->read, place->type, place->motor, 0);
    if (answer.status != tmcl::Status::success) {
      return base::Unexpected{
          fmt::format("{} can not be read: {}", name, tmcl::status_text(answer.status))};
    }
    return std::int64_t{answer.value};
  }
  if (const auto address = source_.address_of_label(name)) {
    return static_cast<std::int64_t>(*address);
  }
  std::vector<std::string_view> known;
  for (const tmcl::Constant& constant : source_.program().constants) {
    if (base::same_word(constant.name, name)) {
      return std::int64_t{constant.value};
    }
    known.push_back(constant.name);
  }
  for (const tmcl::Label& label : source_.program().labels) {
    known.push_back(label.name);
  }
  for (const auto& table : {source_.module().axis_parameters, source_.module().global_parameters}) {
    std::ranges::transform(table, std::back_inserter(known), &tmcl::ParameterDeclaration::symbol);
  }
  return base::Unexpected{
      fmt::format("there is no \"{}\" here{}", name, tmcl::suggestion(name, known))};
}

Number TmclDebugValues::sum(std::string_view text) const {
  const std::vector<tmcl::Token> tokens = tmcl::tokens_of(text);
  const auto value = tmcl::value_of_expression(tokens, *this);
  if (!value) {
    return base::Unexpected{value.error().message};
  }
  return *value;
}

Number TmclDebugValues::evaluate(std::string_view text) const {
  const std::string names = as_names(text);
  const std::string_view whole = names;
  for (const Comparison& comparison : kComparisons) {
    const std::size_t place = whole.find(comparison.sign);
    if (place == std::string_view::npos) {
      continue;
    }
    Number left = sum(whole.substr(0, place));
    if (!left) {
      return left;
    }
    const Number right = sum(whole.substr(place + comparison.sign.size()));
    return right ? Number(comparison.holds(*left, *right) ? 1 : 0) : right;
  }
  return sum(whole);
}

base::Expected<void, std::string> TmclDebugValues::assign(std::string_view name,
                                                          std::int32_t value) {
  constexpr auto kLoad = std::uint8_t{9};  // CALC LOAD, CALCX LOAD
  const std::string inner = as_names(name);
  if (base::same_word(inner, "__accu")) {
    static_cast<void>(direct(Command::calculate, kLoad, 0, value));
    return {};
  }
  if (base::same_word(inner, "__x")) {
    const std::int32_t accumulator = bench_.firmware().state().registers.accumulator;
    static_cast<void>(direct(Command::calculate, kLoad, 0, value));
    static_cast<void>(direct(Command::calculate_with_x, kLoad, 0, 0));
    static_cast<void>(direct(Command::calculate, kLoad, 0, accumulator));
    return {};
  }
  const auto place = find(inner);
  if (!place || !place->writable) {
    return base::Unexpected{fmt::format(
        "\"{}\" can not be set here; what can: $accu, $x, parameters and variables by their "
        "symbols, coord[n], out[n]; what is around the module: set input NAME = VALUE",
        name)};
  }
  const tmcl::HostAnswer answer = direct(place->write, place->type, place->motor, value);
  if (answer.status != tmcl::Status::success) {
    return base::Unexpected{
        fmt::format("{} = {} is refused: {}", name, value, tmcl::status_text(answer.status))};
  }
  return {};
}

}  // namespace stator::tmcl_tools
