#include "stator/tmcl/assembler/direct_line.hpp"

#include <algorithm>
#include <cstddef>

#include "stator/tmcl/assembler/assembler.hpp"

namespace stator::tmcl {

namespace {

/// "sap 6 0 8" as "sap 6, 0, 8".
std::string with_commas(std::string_view line) {
  if (line.find(',') != std::string_view::npos) {
    return std::string(line);
  }
  std::string text;
  int words = 0;
  std::size_t position = 0;
  while ((position = line.find_first_not_of(" \t", position)) != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(" \t", position), line.size());
    text += words == 0 ? "" : words == 1 ? " " : ", ";
    text += line.substr(position, end - position);
    ++words;
    position = end;
  }
  return text;
}

}  // namespace

base::Expected<Instruction, std::string> parse_direct_line(std::string_view line,
                                                           const ModuleDescription& module) {
  const Assembly assembly = assemble(with_commas(line), module);
  for (const Diagnostic& each : assembly.diagnostics) {
    if (each.severity == Severity::error) {
      return base::Unexpected{each.message};
    }
  }
  if (assembly.program.instructions.size() != 1) {
    return base::Unexpected{std::string("found no command; expected e.g. GAP MAX_CURRENT, 0")};
  }
  return assembly.program.instructions.front();
}

}  // namespace stator::tmcl
