#include "stator/tmcl/assembler/assembler.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "stator/tmcl/assembler/instruction_encoder.hpp"
#include "stator/tmcl/assembler/lexer.hpp"
#include "stator/tmcl/assembler/name_table.hpp"
#include "stator/tmcl/assembler/program_flow.hpp"

namespace stator::tmcl {

namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_error(const Diagnostic& diagnostic) {
  return diagnostic.severity == Severity::error;
}

bool is_sign(const Token& token, std::string_view sign) {
  return token.kind == TokenKind::punctuation && token.text == sign;
}

class Assembler {
 public:
  Assembler(std::string_view text, const ModuleDescription& module)
      : text_(text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text),
        module_(module) {}

  Assembly assemble() {
    read_lines();
    encode_statements();
    if (std::ranges::none_of(result_.diagnostics, is_error)) {
      warn_of_the_end();
    } else {
      result_.program = {};
    }
    std::ranges::stable_sort(result_.diagnostics, {}, [](const Diagnostic& each) {
      return std::tuple(each.line, each.column);
    });
    return std::move(result_);
  }

 private:
  /// A line with a command, from its mnemonic on.
  struct Statement {
    std::size_t line;
    std::vector<Token> tokens;
  };

  /// Finds commands and learns the names of labels and constants.
  void read_lines() {
    std::string_view rest = text_;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      ++line_;
      read_line(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }

  void read_line(std::string_view text) {
    std::vector<Token> tokens = tokens_of(text);
    std::size_t position = 0;
    while (tokens[position].kind == TokenKind::name && is_sign(tokens[position + 1], ":")) {
      add_label(tokens[position]);
      position += 2;
    }
    const Token& first = tokens[position];
    if (first.kind == TokenKind::name && is_sign(tokens[position + 1], "=")) {
      add_constant(std::span(tokens).subspan(position));
    } else if (first.kind == TokenKind::name) {
      tokens.erase(tokens.begin(), tokens.begin() + static_cast<std::ptrdiff_t>(position));
      statements_.push_back({line_, std::move(tokens)});
    } else if (first.text == "#") {
      error(first, "found \"#\"; directives are not known, a program is one text");
    } else if (first.kind != TokenKind::end) {
      error(first, "found " + quoted(first) + "; expected a label, a command or a constant");
    }
  }

  void add_label(const Token& name) {
    if (add_name(name, NameTable::Kind::label, static_cast<std::int64_t>(statements_.size()))) {
      result_.program.labels.push_back({std::string(name.text), statements_.size(), line_});
    }
  }

  /// `tokens` are NAME = EXPRESSION.
  void add_constant(std::span<const Token> tokens) {
    const auto value = value_of_expression(tokens.subspan(2), OperandScope(names_, false));
    if (!value && !value.error().message.empty()) {
      error(value.error().at, value.error().message);
    } else if (value && *value > INT32_MAX) {
      error(tokens[2],
            "found " + std::to_string(*value) + "; expected a number of 32 bits, up to 2147483647");
    }
    const bool valid = value && *value <= INT32_MAX && is_free(tokens[0], *value);
    if (add_name(tokens[0], NameTable::Kind::constant,
                 valid ? std::optional(*value) : std::nullopt) &&
        valid) {
      result_.program.constants.push_back(
          {std::string(tokens[0].text), static_cast<std::int32_t>(*value), line_});
    }
  }

  bool add_name(const Token& name, NameTable::Kind kind, std::optional<std::int64_t> value) {
    const NameTable::Entry* other =
        names_.add({.name = name.text, .kind = kind, .value = value, .line = line_});
    if (other != nullptr) {
      error(name, quoted(name) + " is there already, in line " + std::to_string(other->line));
    }
    return other == nullptr;
  }

  /// A constant must not give another number to a name that stands for a parameter.
  bool is_free(const Token& name, std::int64_t value) {
    for (const auto& table : {module_.axis_parameters, module_.global_parameters}) {
      for (const ParameterDeclaration& each : table) {
        if (base::same_word(each.symbol, name.text) && value != each.number) {
          error(name, quoted(name) + " is the symbol of parameter " + std::to_string(each.number) +
                          "; choose another name");
          return false;
        }
      }
    }
    return true;
  }

  void encode_statements() {
    InstructionEncoder encoder(module_, names_, result_.diagnostics);
    for (std::size_t address = 0; address < statements_.size(); ++address) {
      const Statement& statement = statements_[address];
      line_ = statement.line;
      if (address == module_.program_length) {
        error(statement.tokens.front(),
              "found command " + std::to_string(module_.program_length + 1) +
                  "; the program memory of the " + std::string(module_.product) + " holds " +
                  std::to_string(module_.program_length));
        return;
      }
      const auto instruction = encoder.encode(statement.line, statement.tokens);
      result_.program.instructions.push_back(instruction.value_or(Instruction()));
      result_.program.lines.push_back(statement.line);
    }
  }

  void warn_of_the_end() {
    const std::span<const Instruction> program = result_.program.instructions;
    for (std::size_t address = 0; address < program.size(); ++address) {
      const auto target = jump_target(program[address]);
      if (target && *target >= program.size()) {
        warning(statements_[address], "the jump leads to address " + std::to_string(*target) +
                                          ", behind the last command of the program");
      }
    }
    if (can_run_past_end(program)) {
      warning(statements_.back(),
              "the program can run on behind its last command; expected STOP or JA at its end");
    }
  }

  void warning(const Statement& statement, std::string message) {
    result_.diagnostics.push_back(
        {Severity::warning, statement.line, statement.tokens.front().column, std::move(message)});
  }
  void error(const Token& at, std::string message) {
    result_.diagnostics.push_back({Severity::error, line_, at.column, std::move(message)});
  }

  std::string_view text_;
  const ModuleDescription& module_;
  std::size_t line_ = 0;
  NameTable names_;
  std::vector<Statement> statements_;
  Assembly result_;
};

}  // namespace

bool Assembly::succeeded() const {
  return std::ranges::none_of(diagnostics, is_error);
}

Assembly assemble(std::string_view text, const ModuleDescription& module) {
  return Assembler(text, module).assemble();
}

}  // namespace stator::tmcl
