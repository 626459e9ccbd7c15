#include "stator/tmcl_tools/tmcl_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "stator/base/spelling.hpp"
#include "stator/tmcl/assembler/disassembler.hpp"
#include "stator/tmcl/assembler/program_flow.hpp"
#include "stator/tmcl_tools/failure.hpp"
#include "stator/tmcl_tools/program_formats.hpp"

namespace stator::tmcl_tools {

namespace {

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    if (lines.back().ends_with('\r')) {
      lines.back().pop_back();
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// A line of the disassembler without its label.
std::string without_label(const std::string& line) {
  const std::size_t colon = line.find(':');
  const std::size_t begin = line.find_first_not_of(' ', colon == std::string::npos ? 0 : colon + 1);
  return begin == std::string::npos ? std::string() : line.substr(begin);
}

const tmcl::Label* label_at(const tmcl::Program& program, std::size_t address) {
  const auto found = std::ranges::find(program.labels, address, &tmcl::Label::address);
  return found != program.labels.end() ? &*found : nullptr;
}

std::vector<std::string> commands_of(const tmcl::Program& program,
                                     const tmcl::ModuleDescription& module) {
  std::vector<std::string> commands = lines_of(tmcl::disassemble(program.instructions, module));
  commands.resize(program.instructions.size());
  for (std::size_t address = 0; address < commands.size(); ++address) {
    std::string& command = commands[address];
    command = without_label(command);
    const auto target = tmcl::jump_target(program.instructions[address]);
    const tmcl::Label* label = target ? label_at(program, *target) : nullptr;
    if (label != nullptr && !command.starts_with("RAW")) {
      command = command.substr(0, command.rfind(' ') + 1) + label->name;
    }
  }
  const std::array empty{tmcl::Instruction{}};
  commands.push_back(without_label(lines_of(tmcl::disassemble(empty, module)).front()));
  return commands;
}

/// Text of a program, as opposed to its bytes: something no hexadecimal number contains.
bool is_text(std::string_view content) {
  bool other_than_hexadecimal = false;
  for (const char c : content) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < ' ' && c != '\n' && c != '\r' && c != '\t' && c != '\f') {
      return false;
    }
    other_than_hexadecimal =
        other_than_hexadecimal || (!std::isxdigit(byte) && !std::isspace(byte));
  }
  return other_than_hexadecimal;
}

}  // namespace

TmclSource::TmclSource(std::string file, std::string_view text, tmcl::Program program,
                       const tmcl::ModuleDescription& module)
    : file_(std::move(file)),
      lines_(lines_of(text)),
      program_(std::move(program)),
      module_(&module),
      commands_(commands_of(program_, module)) {}

std::optional<std::size_t> TmclSource::line_of(std::size_t address) const {
  return address < program_.lines.size() ? std::optional(program_.lines[address]) : std::nullopt;
}

std::optional<std::size_t> TmclSource::address_of_line(std::size_t line) const {
  const auto found = std::ranges::lower_bound(program_.lines, line);
  return found != program_.lines.end()
             ? std::optional(static_cast<std::size_t>(found - program_.lines.begin()))
             : std::nullopt;
}

std::optional<std::size_t> TmclSource::address_of_label(std::string_view name) const {
  const auto found = std::ranges::find_if(
      program_.labels, [&](const tmcl::Label& each) { return base::same_word(each.name, name); });
  return found != program_.labels.end() ? std::optional(found->address) : std::nullopt;
}

std::string TmclSource::place_of(std::size_t address) const {
  const std::string_view name = label_above(address);
  if (name.empty()) {
    return fmt::format("{}", address);
  }
  const std::size_t distance = address - *address_of_label(name);
  return distance == 0 ? std::string(name) : fmt::format("{}+{}", name, distance);
}

std::string_view TmclSource::label_above(std::size_t address) const {
  const tmcl::Label* nearest = nullptr;
  if (address < program_.instructions.size()) {
    for (const tmcl::Label& each : program_.labels) {
      if (each.address <= address && (nearest == nullptr || each.address > nearest->address)) {
        nearest = &each;
      }
    }
  }
  return nearest != nullptr ? std::string_view(nearest->name) : std::string_view();
}

const std::string& TmclSource::command_at(std::size_t address) const {
  return commands_[std::min(address, commands_.size() - 1)];
}

void report_diagnostics(const tmcl::Assembly& assembly, const std::string& file,
                        std::string_view consequence, const TellDiagnostic& tell) {
  for (const tmcl::Diagnostic& each : assembly.diagnostics) {
    const bool error = each.severity == tmcl::Severity::error;
    tell(fmt::format("{}:{}:{}: {}: {}", file, each.line, each.column, error ? "error" : "warning",
                     each.message));
  }
  if (!assembly.succeeded()) {
    const auto errors = std::ranges::count(assembly.diagnostics, tmcl::Severity::error,
                                           &tmcl::Diagnostic::severity);
    throw Failure(
        fmt::format("{} has {} error{}; {}", file, errors, errors == 1 ? "" : "s", consequence));
  }
}

TmclSource load_tmcl_source(const std::string& file, const tmcl::ModuleDescription& module,
                            const ProgramFiles& files) {
  const auto read = files.read(file);
  if (!read) {
    throw Failure(read.error());
  }
  std::string content = *read;
  if (!is_text(content)) {
    const auto program = read_program(content, file);
    if (program.size() > module.program_length) {
      throw Failure(fmt::format("{} holds {} instructions; the program memory of the {} holds {}",
                                file, program.size(), module.product, module.program_length));
    }
    content = tmcl::disassemble(program, module);
  }
  tmcl::Assembly assembly = tmcl::assemble(content, module);
  report_diagnostics(assembly, file, "it does not run", files.tell);
  if (assembly.program.instructions.empty()) {
    throw Failure(fmt::format("{} contains no command; write at least STOP", file));
  }
  return {file, content, std::move(assembly.program), module};
}

}  // namespace stator::tmcl_tools
