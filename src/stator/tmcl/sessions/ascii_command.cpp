#include "stator/tmcl/sessions/ascii_command.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>

#include "stator/base/trimmed.hpp"

namespace stator::tmcl {

namespace {

bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, upper_case, upper_case);
}

std::optional<std::int64_t> number_in(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) {
      return std::nullopt;
    }
  }
  std::int64_t number = 0;
  const char* end = text.data() + text.size();
  const auto [read, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || read != end) {
    return std::nullopt;
  }
  return number;
}

std::optional<std::int64_t> value_of(std::string_view text, const Operand& operand,
                                     const CommandDeclaration& declaration) {
  if (operand.meaning == Meaning::symbol) {
    const auto symbol = std::ranges::find_if(
        declaration.symbols, [&](const Symbol& each) { return same_word(each.name, text); });
    if (symbol != declaration.symbols.end()) {
      return symbol->value;
    }
  }
  return number_in(text);
}

/// False: it does not fit.
bool put(Instruction& instruction, Field field, std::int64_t value) {
  const auto fits = [value](auto& target) {
    using Number = std::numeric_limits<std::remove_reference_t<decltype(target)>>;
    if (value < Number::min() || value > Number::max()) {
      return false;
    }
    target = static_cast<std::remove_reference_t<decltype(target)>>(value);
    return true;
  };
  switch (field) {
    case Field::type:
      return fits(instruction.type);
    case Field::motor:
      return fits(instruction.motor);
    case Field::value:
      return fits(instruction.value);
    case Field::none:
      break;
  }
  return false;
}

AsciiCommand refused(Status status) {
  return {.kind = LineKind::refused, .status = status};
}

/// Takes the text up to the next comma off `rest`; nothing: there is no further operand.
std::optional<std::string_view> next_operand(std::string_view& rest, bool& more) {
  if (!more) {
    return std::nullopt;
  }
  const auto comma = rest.find(',');
  const std::string_view operand = base::trimmed(rest.substr(0, comma), " ");
  more = comma != std::string_view::npos;
  rest = more ? rest.substr(comma + 1) : std::string_view();
  return operand;
}

}  // namespace

AsciiCommand parse_ascii_command(std::string_view line, const CommandSet& commands) {
  line = base::trimmed(line, " ");
  if (line.empty()) {
    return {};
  }
  const auto space = line.find(' ');
  const std::string_view word = line.substr(0, space);
  std::string_view rest =
      space == std::string_view::npos ? std::string_view() : base::trimmed(line.substr(space), " ");
  if (rest.empty()) {
    if (same_word(word, "BIN")) {
      return {.kind = LineKind::binary_mode};
    }
    if (same_word(word, "RUN")) {
      return {.kind = LineKind::run};
    }
    if (same_word(word, "STOP")) {
      return {.kind = LineKind::stop};
    }
  }
  const CommandDeclaration* declaration = commands.find(word);
  if (declaration == nullptr || !declaration->use.ascii) {
    return refused(Status::invalid_command);
  }
  AsciiCommand result{.kind = LineKind::command};
  result.instruction.command = static_cast<std::uint8_t>(declaration->command);
  bool more = !rest.empty();
  for (std::size_t i = 0; i < declaration->operand_count(); ++i) {
    const Operand& operand = declaration->operands[i];
    const auto text = next_operand(rest, more);
    const auto value = text ? value_of(*text, operand, *declaration) : std::nullopt;
    if (!value || !put(result.instruction, operand.field, *value)) {
      return refused(Status::invalid_value);
    }
  }
  return more ? refused(Status::invalid_value) : result;
}

}  // namespace stator::tmcl
