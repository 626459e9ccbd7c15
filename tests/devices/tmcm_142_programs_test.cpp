// Programs of the TMCM-142's manual assembled to the bytes it prints, and back.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "source_paths.hpp"
#include "stator/devices/tmcm_142/parameters.hpp"
#include "stator/tmcl/assembler/assembler.hpp"
#include "stator/tmcl/assembler/disassembler.hpp"
#include "stator/tmcl/assembler/program_image.hpp"

namespace stator::devices {
namespace {

using tmcl::Instruction;

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string hexadecimal(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::byte each : bytes) {
    text += text.empty() ? "" : " ";
    text += kDigits[std::to_integer<std::size_t>(each >> 4)];
    text += kDigits[std::to_integer<std::size_t>(each & std::byte{0xF})];
  }
  return text;
}

/// Assembles what needs neither error nor warning.
std::vector<Instruction> assembled(const std::string& text) {
  const tmcl::Assembly assembly = tmcl::assemble(text, tmcm_142_description());
  for (const tmcl::Diagnostic& each : assembly.diagnostics) {
    ADD_FAILURE() << each.line << ':' << each.column << ": " << each.message;
  }
  return assembly.program.instructions;
}

std::vector<Instruction> example(const std::string& name) {
  auto program = assembled(content(STATOR_SOURCE_DIR "/examples/tmcl/" + name));
  EXPECT_FALSE(program.empty()) << name;
  return program;
}

/// A program of the document: its text, and what it prints for each instruction.
struct DocumentedProgram {
  std::string text;
  std::vector<std::string> core_bytes;
  std::vector<std::string> telegrams;
};

/// By the first word of their names, P1 to P6.
std::map<std::string, DocumentedProgram> documented_programs() {
  const auto rows = tests::parse_csv(content(STATOR_TEST_DATA "/tmcm-142/program_examples.csv"));
  std::map<std::string, DocumentedProgram> programs;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    DocumentedProgram& program = programs[rows[i][0].substr(0, 2)];
    std::string command = rows[i][3];
    if (command == "JC GE, Label (address 10 as printed)") {
      command = "JC GE, 10";
    } else if (command == "JA Loop (label 20 as printed)") {
      command = "JA 20";
    }
    command.resize(std::min(command.find(" ("), command.size()));
    program.text += (rows[i][2].empty() ? "" : rows[i][2] + ": ") + command + '\n';
    program.core_bytes.push_back(rows[i][4]);
    program.telegrams.push_back(rows[i][5]);
  }
  EXPECT_EQ(programs.size(), 6U);
  return programs;
}

TEST(Tmcm142Programs, ThoseOfTheDocumentBecomeThePrintedBytes) {
  for (const auto& [name, program] : documented_programs()) {
    SCOPED_TRACE(name);
    const tmcl::Assembly assembly = tmcl::assemble(program.text, tmcm_142_description());
    ASSERT_TRUE(assembly.succeeded()) << assembly.diagnostics.front().message;
    // As printed P3 ends with a jump and P3 and P4 jump to behind their ends.
    EXPECT_EQ(assembly.diagnostics.size(), name == "P3" ? 2U : name == "P4" ? 1U : 0U);
    const auto& instructions = assembly.program.instructions;
    ASSERT_EQ(instructions.size(), program.core_bytes.size());
    const auto telegrams = tmcl::download_of(instructions, 1);
    for (std::size_t i = 0; i < instructions.size(); ++i) {
      EXPECT_EQ(hexadecimal(tmcl::image_of(std::span(&instructions[i], 1))), program.core_bytes[i]);
      EXPECT_EQ(hexadecimal(telegrams[i + 1]), program.telegrams[i]);
    }
  }
}

TEST(Tmcm142Programs, ExamplesAreThoseOfTheDocument) {
  const std::map<std::string, std::string> files{{"P1", "test_program.tmc"},
                                                 {"P2", "inputs_to_outputs.tmc"},
                                                 {"P5", "subroutine.tmc"},
                                                 {"P6", "potentiometer_position.tmc"}};
  auto documented = documented_programs();
  for (const auto& [name, file] : files) {
    EXPECT_EQ(example(file), assembled(documented[name].text)) << file;
  }
  // These two as they are meant: the document prints addresses of a longer program.
  const auto loop = example("endless_loop.tmc");
  ASSERT_EQ(loop.size(), documented["P4"].core_bytes.size());
  EXPECT_EQ(loop.back(), (Instruction{22, 0, 0, 0}));
  const auto comparison = example("compare_and_jump.tmc");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(hexadecimal(tmcl::image_of(std::span(&loop[i], 1))), documented["P4"].core_bytes[i]);
    EXPECT_EQ(hexadecimal(tmcl::image_of(std::span(&comparison[i], 1))),
              documented["P3"].core_bytes[i]);
  }
  EXPECT_EQ(comparison[2], (Instruction{21, 5, 0, 5}));
}

TEST(Tmcm142Programs, EveryExampleAssemblesAndComesBackFromItsDisassembly) {
  std::set<std::string> names;
  for (const auto& entry :
       std::filesystem::directory_iterator(STATOR_SOURCE_DIR "/examples/tmcl")) {
    if (entry.path().extension() != ".tmc") {
      continue;
    }
    SCOPED_TRACE(entry.path().filename().string());
    names.insert(entry.path().stem().string());
    const auto program = assembled(content(entry.path()));
    EXPECT_FALSE(program.empty());
    for (const bool symbols : {true, false}) {
      const std::string text =
          tmcl::disassemble(program, tmcm_142_description(), {.parameter_symbols = symbols});
      EXPECT_EQ(text.find("RAW"), std::string::npos);
      EXPECT_EQ(assembled(text), program);
    }
  }
  EXPECT_EQ(names,
            (std::set<std::string>{"compare_and_jump", "endless_loop", "inputs_drive_moves",
                                   "inputs_to_outputs", "potentiometer_position",
                                   "potentiometer_speed", "reference_search", "subroutine",
                                   "subroutine_library", "test_program", "turns", "watchdog"}));
}

TEST(Tmcm142Programs, MayNameEveryParameterOfTheModule) {
  std::string text;
  std::vector<Instruction> expected;
  for (const tmcl::ParameterDeclaration& each : tmcm_142::axis_parameters()) {
    text += "GAP " + std::string(each.symbol) + ", 0\n";
    expected.push_back({6, each.number, 0, 0});
  }
  for (const tmcl::ParameterDeclaration& each : tmcm_142::global_parameters()) {
    text += "GGP " + std::string(each.symbol) + ", " + std::to_string(each.bank) + '\n';
    expected.push_back({10, each.number, each.bank, 0});
  }
  expected.push_back({28, 0, 0, 0});
  EXPECT_EQ(assembled(text + "STOP"), expected);
  EXPECT_EQ(assembled(tmcl::disassemble(expected, tmcm_142_description())), expected);
}

TEST(Tmcm142Programs, TheExampleOfTheDocumentWithACurrentOutOfRangeIsWarnedOf) {
  const auto assembly = tmcl::assemble("SAP 6, 0, 200\nSTOP", tmcm_142_description());
  EXPECT_TRUE(assembly.succeeded());
  ASSERT_EQ(assembly.diagnostics.size(), 1U);
  EXPECT_EQ(assembly.diagnostics[0].message,
            "axis parameter 6 (Max. current) takes 0..15; found 200");
}

TEST(Tmcm142Programs, PortsThatNoPinHasAreWarnedOf) {
  const auto assembly =
      tmcl::assemble("SIO 7, 2, 1\nSIO 3, 2, 1\nGIO 9, 0\nGIO 3, 1\nSTOP", tmcm_142_description());
  EXPECT_TRUE(assembly.succeeded());
  ASSERT_EQ(assembly.diagnostics.size(), 3U);
  EXPECT_EQ(assembly.diagnostics[0].message,
            "found output 3; the tmcm-142 has 0..2, 7, and 255 for all");
  EXPECT_EQ(assembly.diagnostics[1].message,
            "found digital input 9; the tmcm-142 has 0..8, and 255 for all");
  EXPECT_EQ(assembly.diagnostics[2].message, "found analog input 3; the tmcm-142 has 0..2");
}

}  // namespace
}  // namespace stator::devices
