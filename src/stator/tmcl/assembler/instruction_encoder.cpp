#include "stator/tmcl/assembler/instruction_encoder.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "stator/tmcl/module/violations.hpp"

namespace stator::tmcl {

namespace {

constexpr std::int64_t kLargestByte = 255;
constexpr std::int64_t kLeastValue = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t kLargestValue = std::numeric_limits<std::int32_t>::max();

std::string_view name_of(Meaning meaning) {
  switch (meaning) {
    case Meaning::motor:
      return "motor";
    case Meaning::axis_parameter:
    case Meaning::global_parameter:
      return "parameter";
    case Meaning::bank:
      return "bank";
    case Meaning::coordinate:
      return "coordinate";
    case Meaning::port:
      return "port";
    case Meaning::address:
      return "label";
    case Meaning::ticks:
      return "ticks";
    case Meaning::number:
    case Meaning::symbol:
      break;
  }
  return "value";
}

std::string count_of(std::size_t operands) {
  return std::to_string(operands) + (operands == 1 ? " operand" : " operands");
}

/// Words with `separator` between them and `last_separator` before the last.
std::string joined(const std::vector<std::string_view>& words, std::string_view separator,
                   std::string_view last_separator) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += i == 0 ? "" : i + 1 == words.size() ? last_separator : separator;
    text += words[i];
  }
  return text;
}

std::vector<std::string_view> names_of(std::span<const Symbol> symbols) {
  std::vector<std::string_view> names;
  std::ranges::transform(symbols, std::back_inserter(names), &Symbol::name);
  return names;
}

/// As a person would write it: "MVP ABS|REL|COORD, motor, value".
std::string syntax_of(const CommandDeclaration& declaration) {
  std::string text(declaration.mnemonic);
  for (std::size_t i = 0; i < declaration.operand_count(); ++i) {
    const Meaning meaning = declaration.operands[i].meaning;
    text += i == 0 ? " " : ", ";
    text += meaning == Meaning::symbol ? joined(names_of(declaration.symbols), "|", "|")
                                       : std::string(name_of(meaning));
  }
  return text;
}

void put(Instruction& instruction, Field field, std::int64_t value) {
  if (field == Field::type) {
    instruction.type = static_cast<std::uint8_t>(value);
  } else if (field == Field::motor) {
    instruction.motor = static_cast<std::uint8_t>(value);
  } else if (field == Field::value) {
    instruction.value = static_cast<std::int32_t>(value);
  }
}

bool is_one_name(std::span<const Token> tokens) {
  return tokens.size() == 2 && tokens.front().kind == TokenKind::name;
}

std::vector<std::string_view> symbols_of(std::span<const ParameterDeclaration> parameters) {
  std::vector<std::string_view> symbols;
  std::ranges::transform(parameters, std::back_inserter(symbols), &ParameterDeclaration::symbol);
  return symbols;
}

const ParameterDeclaration* find_symbol(std::span<const ParameterDeclaration> parameters,
                                        std::string_view name) {
  const auto found = std::ranges::find_if(parameters, [&](const ParameterDeclaration& each) {
    return base::same_word(each.symbol, name);
  });
  return found != parameters.end() ? &*found : nullptr;
}

}  // namespace

std::optional<Instruction> InstructionEncoder::encode(std::size_t line,
                                                      std::span<const Token> statement) {
  line_ = line;
  const std::string_view mnemonic = statement.front().text;
  if (base::same_word(mnemonic, kRawMnemonic)) {
    return encode_raw(statement);
  }
  const CommandDeclaration* declaration = module_.commands.find(mnemonic);
  if (declaration == nullptr || !declaration->use.program) {
    unknown_command(statement);
    return std::nullopt;
  }
  return encode_declared(*declaration, statement);
}

std::optional<Instruction> InstructionEncoder::encode_declared(
    const CommandDeclaration& declaration, std::span<const Token> statement) {
  const auto operands = operands_of(statement, declaration.operand_count(), syntax_of(declaration));
  if (!operands) {
    return std::nullopt;
  }
  Instruction instruction{.command = static_cast<std::uint8_t>(declaration.command)};
  bool complete = true;
  for (std::size_t i = 0; i < operands->size(); ++i) {
    const Operand& operand = declaration.operands[i];
    const auto value = value_of(operand, declaration, (*operands)[i]);
    if (value && in_range(*value, operand, (*operands)[i].front())) {
      put(instruction, operand.field, *value);
    } else {
      complete = false;
    }
  }
  if (!complete || !in_its_bank(declaration, *operands, instruction)) {
    return std::nullopt;
  }
  for (Violation& violation : violations_of(instruction, declaration, module_)) {
    std::size_t column = statement.front().column;
    for (std::size_t i = 0; i < operands->size(); ++i) {
      if (declaration.operands[i].field == violation.field) {
        column = (*operands)[i].front().column;
      }
    }
    diagnostics_.push_back({Severity::warning, line_, column, std::move(violation.message)});
  }
  return instruction;
}

std::optional<Instruction> InstructionEncoder::encode_raw(std::span<const Token> statement) {
  constexpr std::size_t kFields = 4;
  const auto operands = operands_of(statement, kFields, "RAW command, type, motor, value");
  if (!operands) {
    return std::nullopt;
  }
  std::array<std::int64_t, kFields> values{};
  bool complete = true;
  for (std::size_t i = 0; i < kFields; ++i) {
    const auto value = expression((*operands)[i], OperandScope(names_, false));
    const bool byte = i + 1 < kFields;
    const bool valid =
        value && in_range(*value, byte ? 0 : kLeastValue, byte ? kLargestByte : kLargestValue,
                          (*operands)[i].front(), byte ? "byte" : "number of 32 bits");
    values[i] = valid ? *value : 0;
    complete = complete && valid;
  }
  return complete ? std::optional(Instruction{.command = static_cast<std::uint8_t>(values[0]),
                                              .type = static_cast<std::uint8_t>(values[1]),
                                              .motor = static_cast<std::uint8_t>(values[2]),
                                              .value = static_cast<std::int32_t>(values[3])})
                  : std::nullopt;
}

std::optional<InstructionEncoder::Operands> InstructionEncoder::operands_of(
    std::span<const Token> statement, std::size_t count, std::string_view syntax) {
  Operands operands;
  const std::span<const Token> tokens = statement.subspan(1);
  std::size_t begin = 0;
  for (std::size_t i = 0; tokens.size() > 1 && i < tokens.size(); ++i) {
    const bool comma = tokens[i].kind == TokenKind::punctuation && tokens[i].text == ",";
    if (comma || tokens[i].kind == TokenKind::end) {
      operands.push_back(tokens.subspan(begin, i + 1 - begin));
      begin = i + 1;
    }
  }
  if (operands.size() == count) {
    return operands;
  }
  const Token& at = operands.size() > count ? operands[count].front() : tokens.back();
  error(at, "found " + count_of(operands.size()) + "; expected " +
                (count == 0 ? "none" : std::to_string(count)) + ": " + std::string(syntax));
  return std::nullopt;
}

std::optional<std::int64_t> InstructionEncoder::value_of(const Operand& operand,
                                                         const CommandDeclaration& declaration,
                                                         std::span<const Token> tokens) {
  const bool axis = operand.meaning == Meaning::axis_parameter;
  if (operand.meaning == Meaning::symbol) {
    return symbol(declaration, tokens);
  }
  if (!axis && operand.meaning != Meaning::global_parameter) {
    return expression(tokens, OperandScope(names_, operand.meaning == Meaning::address));
  }
  const auto& parameters = axis ? module_.axis_parameters : module_.global_parameters;
  const auto& others = axis ? module_.global_parameters : module_.axis_parameters;
  if (is_one_name(tokens)) {
    const std::string_view name = tokens.front().text;
    if (const ParameterDeclaration* parameter = find_symbol(parameters, name)) {
      return parameter->number;
    }
    if (names_.find(name) == nullptr && find_symbol(others, name) != nullptr) {
      error(tokens.front(), quoted(tokens.front()) + " is " + (axis ? "a global" : "an axis") +
                                " parameter; " + std::string(declaration.mnemonic) + " expects " +
                                (axis ? "an axis" : "a global") + " parameter");
      return std::nullopt;
    }
  }
  return expression(tokens, OperandScope(names_, false, symbols_of(parameters)));
}

std::optional<std::int64_t> InstructionEncoder::symbol(const CommandDeclaration& declaration,
                                                       std::span<const Token> tokens) {
  const auto found = std::ranges::find_if(declaration.symbols, [&](const Symbol& each) {
    return base::same_word(each.name, tokens.front().text);
  });
  if (found != declaration.symbols.end() && tokens.size() == 2) {
    return found->value;
  }
  const bool known = found != declaration.symbols.end();
  const Token& at = known ? tokens[1] : tokens.front();
  const std::vector<std::string_view> names = names_of(declaration.symbols);
  const std::string expected = known ? "a comma" : joined(names, ", ", " or ");
  error(at, "found " + quoted(at) + "; expected " + expected +
                (at.kind == TokenKind::name && !known ? suggestion(at.text, names) : ""));
  return std::nullopt;
}

std::optional<std::int64_t> InstructionEncoder::expression(std::span<const Token> tokens,
                                                           const OperandScope& scope) {
  const auto value = value_of_expression(tokens, scope);
  if (value) {
    return *value;
  }
  if (!value.error().message.empty()) {
    error(value.error().at, value.error().message);
  }
  return std::nullopt;
}

bool InstructionEncoder::in_range(std::int64_t value, const Operand& operand, const Token& at) {
  if (operand.meaning == Meaning::symbol) {
    return true;
  }
  if (operand.meaning == Meaning::address) {
    const auto last = static_cast<std::int64_t>(module_.program_length) - 1;
    return in_range(value, 0, last, at, "place in the program memory");
  }
  return operand.field == Field::value
             ? in_range(value, kLeastValue, kLargestValue, at, "number of 32 bits")
             : in_range(value, 0, kLargestByte, at, name_of(operand.meaning));
}

bool InstructionEncoder::in_range(std::int64_t value, std::int64_t least, std::int64_t most,
                                  const Token& at, std::string_view what) {
  if (value < least || value > most) {
    error(at, "found " + std::to_string(value) + "; expected a " + std::string(what) + ", " +
                  std::to_string(least) + ".." + std::to_string(most));
    return false;
  }
  return true;
}

bool InstructionEncoder::in_its_bank(const CommandDeclaration& declaration,
                                     const Operands& operands, const Instruction& instruction) {
  for (std::size_t i = 0; i < operands.size(); ++i) {
    if (declaration.operands[i].meaning != Meaning::global_parameter || !is_one_name(operands[i])) {
      continue;
    }
    const Token& name = operands[i].front();
    const auto* parameter = find_symbol(module_.global_parameters, name.text);
    if (parameter != nullptr && parameter->bank != instruction.motor) {
      error(operands[i + 1 < operands.size() ? i + 1 : i].front(),
            "found bank " + std::to_string(instruction.motor) + "; expected " +
                std::to_string(parameter->bank) + ", the bank of " + quoted(name));
      return false;
    }
  }
  return true;
}

void InstructionEncoder::unknown_command(std::span<const Token> statement) {
  std::vector<std::string_view> mnemonics{kRawMnemonic};
  for (const CommandDeclaration& each : module_.commands.all()) {
    if (each.use.program) {
      mnemonics.push_back(each.mnemonic);
    }
  }
  const Token& word = statement.front();
  const Token& next = statement[1];
  const bool label = next.kind == TokenKind::name &&
                     std::ranges::any_of(mnemonics, [&](std::string_view mnemonic) {
                       return base::same_word(mnemonic, next.text);
                     });
  error(word, quoted(word) + " is no command for programs of the " + std::string(module_.product) +
                  (label ? "; a label needs a colon behind it" : suggestion(word.text, mnemonics)));
}

void InstructionEncoder::error(const Token& at, std::string message) {
  diagnostics_.push_back({Severity::error, line_, at.column, std::move(message)});
}

}  // namespace stator::tmcl
