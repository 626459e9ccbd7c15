// stator tmcl, with its commands assemble and disassemble.
#include <cstdint>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/files.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/tmcl/program_files.hpp"
#include "stator/cli/tmcl/tmcl_commands.hpp"
#include "stator/tmcl/assembler/assembler.hpp"
#include "stator/tmcl/assembler/disassembler.hpp"
#include "stator/tmcl_tools/program_formats.hpp"
#include "stator/tmcl_tools/tmcl_source.hpp"

namespace stator::cli {

namespace {

struct TmclOptions {
  std::string file;
  std::string output;
  std::string device = usual_tmcl_module();
};

struct AssembleOptions : TmclOptions {
  std::string format = "listing";
  unsigned address = 1;
};

struct DisassembleOptions : TmclOptions {
  bool numbers = false;
};

void assemble(const AssembleOptions& options) {
  const std::string text = read_file(options.file);
  const tmcl::Assembly assembly = tmcl::assemble(text, tmcl_module(options.device));
  tmcl_tools::report_diagnostics(assembly, options.file, "nothing is written",
                                 program_files().tell);
  const auto& program = assembly.program.instructions;
  const bool binary = options.format == "binary";
  const std::string content =
      binary                    ? tmcl_tools::program_as_binary(program)
      : options.format == "hex" ? tmcl_tools::program_as_hex(program)
      : options.format == "listing"
          ? tmcl_tools::program_as_listing(assembly.program, text)
          : tmcl_tools::program_as_telegrams(program, static_cast<std::uint8_t>(options.address));
  write_output(options.output, content, binary, "this format");
}

void disassemble(const DisassembleOptions& options) {
  const tmcl::ModuleDescription& module = tmcl_module(options.device);
  const auto program = tmcl_tools::read_program(read_file(options.file), options.file);
  if (program.size() > module.program_length) {
    throw Failure(fmt::format("{} holds {} instructions; the program memory of the {} holds {}",
                              options.file, program.size(), module.product, module.program_length));
  }
  write_output(options.output,
               tmcl::disassemble(program, module, {.parameter_symbols = !options.numbers}), false,
               "");
}

void add_common_options(CLI::App& command, TmclOptions& options) {
  command.add_option("-o,--output", options.output, "File to write; standard output if left out")
      ->check(names(Names::file));
  command.add_option("--device", options.device, "Module the program is for")
      ->check(names(Names::product))
      ->capture_default_str();
}

void add_assemble_command(CLI::App& app) {
  auto options = std::make_shared<AssembleOptions>();
  CLI::App* command = app.add_subcommand("assemble", "Make a program of its text");
  command->add_option("file", options->file, "Text of the program")
      ->required()
      ->check(names(Names::tmcl_program));
  add_common_options(*command, *options);
  command
      ->add_option("--format", options->format,
                   "binary (7 bytes per command), hex (the same as text), telegrams (of a "
                   "download, hexadecimal) or listing")
      ->check(one_of({"binary", "hex", "telegrams", "listing"}))
      ->capture_default_str();
  command->add_option("--address", options->address, "Address of the module, for telegrams")
      ->check(CLI::Range(0U, 255U))
      ->capture_default_str();
  command->footer(
      "Example:\n"
      "  stator tmcl assemble examples/tmcl/reference_search.tmc --format binary -o search.bin");
  command->callback([options] { assemble(*options); });
}

void add_disassemble_command(CLI::App& app) {
  auto options = std::make_shared<DisassembleOptions>();
  CLI::App* command = app.add_subcommand("disassemble", "Make the text of a program");
  command->add_option("file", options->file, "Program as binary, hex or telegrams")
      ->required()
      ->check(names(Names::file));
  add_common_options(*command, *options);
  command->add_flag(
      "--numbers", options->numbers,
      "Parameters by their numbers instead of symbols, as other assemblers need them");
  command->footer(
      "Example:\n"
      "  stator tmcl disassemble search.bin");
  command->callback([options] { disassemble(*options); });
}

}  // namespace

void add_tmcl_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "tmcl", "Write, run and debug programs in TMCL, and talk to their modules");
  command->require_subcommand(1);
  add_assemble_command(*command);
  add_disassemble_command(*command);
  add_tmcl_run_command(*command);
  add_tmcl_debug_command(*command);
  add_tmcl_shell_command(*command);
}

}  // namespace stator::cli
