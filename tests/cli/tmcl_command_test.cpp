#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using tests::content;
using tests::Outcome;
using tests::stator;
using tests::temporary;

/// A file with that content, gone at the end of the test.
class File {
 public:
  File(const std::string& name, const std::string& text) : path_(temporary(name)) {
    std::ofstream(path_, std::ios::binary) << text;
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { std::filesystem::remove(path_); }

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

constexpr const char* kText =
    "Far = $2710 // microsteps\n"
    "\n"
    "Loop:\tMVP ABS, 0, Far\n"
    "  JA Loop\n";

TEST(TmclCommand, AListingShowsAddressesAndBytesBesideTheText) {
  const File text("listing.tmc", kText);
  const Outcome outcome = stator("tmcl assemble " + text.path());
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.output,
            "ADDRESS  BYTES                 LINE  TEXT\n"
            "                                  1  Far = $2710 // microsteps\n"
            "                                  2\n"
            "      0  04 00 00 00 00 27 10     3  Loop:\tMVP ABS, 0, Far\n"
            "      1  16 00 00 00 00 00 00     4    JA Loop\n"
            "\n"
            "LABEL                                 ADDRESS  LINE\n"
            "Loop                                        0     3\n"
            "\n"
            "CONSTANT                                VALUE  LINE\n"
            "Far                                     10000     1\n");
}

TEST(TmclCommand, ProgramsAreWrittenAsBytesHexAndTelegrams) {
  const File text("formats.tmc", kText);
  const std::string command = "tmcl assemble " + text.path();
  EXPECT_EQ(stator(command + " --format hex").output,
            "04 00 00 00 00 27 10\n"
            "16 00 00 00 00 00 00\n");
  EXPECT_EQ(stator(command + " --format telegrams --address 3").output,
            "03 84 00 00 00 00 00 00 87\n"
            "03 04 00 00 00 00 27 10 3e\n"
            "03 16 00 00 00 00 00 00 19\n"
            "03 85 00 00 00 00 00 00 88\n");
  const std::string binary = temporary("formats.bin");
  EXPECT_EQ(stator(command + " --format binary -o " + binary).status, 0);
  EXPECT_EQ(content(binary), std::string("\4\0\0\0\0\x27\x10\x16\0\0\0\0\0\0", 14));
  std::filesystem::remove(binary);
}

TEST(TmclCommand, EveryFormatIsDisassembled) {
  const File text("back.tmc", kText);
  for (const char* format : {"binary", "hex", "telegrams"}) {
    const std::string program = temporary("back.program");
    ASSERT_EQ(
        stator("tmcl assemble " + text.path() + " --format " + format + " -o " + program).status,
        0);
    const Outcome outcome = stator("tmcl disassemble " + program);
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.output,
              "L0:      MVP ABS, 0, 10000\n"
              "         JA L0\n")
        << format;
    std::filesystem::remove(program);
  }
}

TEST(TmclCommand, ParametersAreDisassembledAsSymbolsOrNumbers) {
  const File program("numbers.hex", "05 06 00 00 00 00 08\n");
  EXPECT_EQ(stator("tmcl disassemble " + program.path()).output,
            "         SAP MAX_CURRENT, 0, 8\n");
  EXPECT_EQ(stator("tmcl disassemble --numbers " + program.path()).output,
            "         SAP 6, 0, 8\n");
}

TEST(TmclCommand, ErrorsNameFileLineAndColumn) {
  const File text("errors.tmc", "MPV ABS, 0, 1\n  SAP 6, 0, x\n");
  const Outcome outcome = stator("tmcl assemble " + text.path());
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.output,
            text.path() +
                ":1:1: error: \"MPV\" is no command for programs of the tmcm-142; did you mean "
                "\"MVP\"?\n" +
                text.path() + ":2:13: error: \"x\" is no constant\n" + "stator: " + text.path() +
                " has 2 errors; nothing is written\n");
}

TEST(TmclCommand, WarningsDoNotKeepAProgramFromBeingWritten) {
  const File text("warnings.tmc", "MST 1\n");
  const Outcome outcome = stator("tmcl assemble --format hex " + text.path());
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.output,
              HasSubstr(":1:5: warning: found motor 1; the tmcm-142 has motor 0\n"));
  EXPECT_THAT(outcome.output, HasSubstr("03 00 01 00 00 00 00\n"));
}

TEST(TmclCommand, WhatIsNoProgramIsRefused) {
  const File odd("odd.bin", "no program");
  EXPECT_THAT(stator("tmcl disassemble " + odd.path()).output,
              HasSubstr("found 10 bytes; expected hexadecimal digits, or 7 bytes for each"));
  const File cut("cut.hex", "05 06 00 00 00 00 08\n05 06\n");
  EXPECT_THAT(stator("tmcl disassemble " + cut.path()).output,
              HasSubstr(cut.path() + ":2: found 2 bytes; an instruction has 7, a telegram 9"));
  const File half("half.hex", "05 06 00 00 00 00 0\n");
  EXPECT_THAT(stator("tmcl disassemble " + half.path()).output,
              HasSubstr(half.path() + ":1: found 13 hexadecimal digits; two make a byte"));
  const File damaged("damaged.hex", "01 05 06 00 00 00 00 08 15\n");
  const Outcome outcome = stator("tmcl disassemble " + damaged.path());
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output,
              HasSubstr(damaged.path() + ":1: found checksum 15; the sum of the bytes before it "
                                         "is 14"));
  const File large("large.bin", std::string(std::size_t{7} * 2049, '\0'));
  EXPECT_THAT(stator("tmcl disassemble " + large.path()).output,
              HasSubstr("holds 2049 instructions; the program memory of the tmcm-142 holds 2048"));
}

TEST(TmclCommand, FilesAndDevicesThatAreNotThereAreNamed) {
  const Outcome missing = stator("tmcl assemble /nonexistent.tmc");
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.output,
              StartsWith("stator: cannot read /nonexistent.tmc: No such file or directory"));
  EXPECT_THAT(stator("tmcl assemble /tmp").output,
              HasSubstr("cannot read /tmp: it is a directory"));
  const File text("device.tmc", "STOP\n");
  EXPECT_THAT(stator("tmcl assemble " + text.path() + " -o /nonexistent/x").output,
              HasSubstr("cannot write /nonexistent/x: No such file or directory"));
  const Outcome device = stator("tmcl assemble --device tmcm-3315 " + text.path());
  EXPECT_EQ(device.status, 1);
  EXPECT_THAT(
      device.output,
      HasSubstr("\"tmcm-3315\" runs no programs in TMCL; the device that does is tmcm-142"));
  EXPECT_EQ(stator("tmcl").status, 2);
  EXPECT_EQ(stator("tmcl assemble --format xml " + text.path()).status, 2);
}

}  // namespace
}  // namespace stator
