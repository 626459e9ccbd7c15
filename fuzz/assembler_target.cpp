// Any text: the assembler comes to its end and tells where something is wrong. Any bytes as a
// program: what is disassembled assembles to the same instructions.

#include <algorithm>
#include <string_view>
#include <vector>

#include "input.hpp"
#include "stator/devices/tmcm_142/parameters.hpp"
#include "stator/tmcl/assembler/assembler.hpp"
#include "stator/tmcl/assembler/disassembler.hpp"
#include "stator/tmcl/assembler/program_image.hpp"

namespace {

using stator::fuzz::require;
using stator::tmcl::Assembly;
using stator::tmcl::Instruction;

const stator::tmcl::ModuleDescription& module() {
  return stator::devices::tmcm_142_description();
}

void require_same_again(const std::vector<Instruction>& program, bool symbols) {
  const std::string text =
      stator::tmcl::disassemble(program, module(), {.parameter_symbols = symbols});
  const Assembly again = stator::tmcl::assemble(text, module());
  require(again.succeeded() && again.program.instructions == program);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const Assembly assembly = stator::tmcl::assemble(text, module());
  for (const auto& each : assembly.diagnostics) {
    require(each.line > 0 && each.column > 0 && !each.message.empty());
  }
  const auto& program = assembly.program;
  require(assembly.succeeded() || program.instructions.empty());
  require(program.lines.size() == program.instructions.size());
  require_same_again(program.instructions, size % 2 == 0);

  const std::size_t whole =
      std::min(size / stator::tmcl::kInstructionLength, module().program_length) *
      stator::tmcl::kInstructionLength;
  const auto bytes = std::as_bytes(std::span(data, whole));
  require_same_again(*stator::tmcl::program_in(bytes), size % 2 == 0);
  return 0;
}
