// The tables of the TMCM-142's document, row by row, against the firmware.

#include <charconv>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "source_paths.hpp"
#include "stator/tmcl/sessions/serial_session.hpp"
#include "tmcl/firmware_fixture.hpp"
#include "tmcl/serial_line.hpp"

namespace stator::tmcl {
namespace {

using namespace base::literals;
using tests::CsvRow;

std::vector<CsvRow> rows_of(const std::string& name) {
  std::ifstream file(STATOR_TEST_DATA "/tmcm-142/" + name);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::vector<CsvRow> rows = tests::parse_csv(text);
  EXPECT_GT(rows.size(), 1U) << name;
  rows.erase(rows.begin());
  return rows;
}

std::vector<std::byte> hexadecimal(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::byte> bytes;
  unsigned value = 0;
  while (stream >> std::hex >> value) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  return bytes;
}

Instruction instruction_in(const std::vector<std::byte>& core) {
  Telegram telegram{};
  std::copy_n(core.begin(), 7, telegram.begin() + 1);
  const Request request = decode_request(telegram);
  return {request.command, request.type, request.motor, request.value};
}

std::map<std::string, std::vector<Instruction>> documented_programs() {
  std::map<std::string, std::vector<Instruction>> programs;
  for (const CsvRow& row : rows_of("program_examples.csv")) {
    programs[row[0].substr(0, 2)].push_back(instruction_in(hexadecimal(row[4])));
  }
  return programs;
}

class DocumentedExamples : public tests::FirmwareFixture {
 protected:
  DocumentedExamples() {
    session_.connect(&line_);
    session_.power_on();
  }
  std::vector<std::byte> exchange(const std::vector<std::byte>& request) {
    line_.write(request);
    session_.serve(now_);
    return line_.read();
  }

  tests::SerialLine line_;
  SerialSession session_{firmware_};
};

TEST_F(DocumentedExamples, EveryPrintedTelegramIsAnsweredOnceWithTheStatusItDeserves) {
  // What the document's own notes make of some of them; the others succeed.
  const std::map<std::string, Status> expected{
      {"E07", Status::invalid_value},          // 200 for a current of 0 to 15
      {"E19", Status::wrong_type},             // channel 3
      {"E22", Status::command_not_available},  // COMP
      {"E23", Status::command_not_available},  // JC
      {"E24", Status::command_not_available},  // JA
      {"E25", Status::command_not_available},  // CSUB
      {"E26", Status::command_not_available},  // RSUB
      {"E27", Status::command_not_available},  // WAIT
      {"E28", Status::command_not_available},  // STOP
      {"E37", Status::command_not_available},  // CLE
  };
  int requests = 0;
  for (const CsvRow& row : rows_of("telegram_examples.csv")) {
    SCOPED_TRACE(row[0] + " " + row[2]);
    if (row[1] != "request") {
      continue;
    }
    ++requests;
    tests::FakeModule module;
    module.power_on();
    Firmware firmware(tests::FakeModule::description(), module);
    SerialSession session(firmware);
    session.connect(&line_);
    const std::vector<std::byte> request = hexadecimal(row[3]);
    ASSERT_EQ(request.size(), kTelegramLength);
    line_.write(request);
    session.serve(now_);
    const std::vector<std::byte> bytes = line_.read();
    ASSERT_EQ(bytes.size(), kTelegramLength);
    Telegram telegram{};
    std::copy_n(bytes.begin(), telegram.size(), telegram.begin());
    EXPECT_TRUE(has_right_checksum(telegram));
    const Reply reply = decode_reply(telegram);
    EXPECT_EQ(reply.host_address, 2);
    EXPECT_EQ(reply.module_address, 1);
    EXPECT_EQ(reply.command, std::to_integer<std::uint8_t>(request[1]));
    const auto found = expected.find(row[0]);
    EXPECT_EQ(reply.status, found == expected.end() ? Status::success : found->second);
  }
  EXPECT_EQ(requests, 33);
}

TEST_F(DocumentedExamples, PrintedRepliesAreTheRepliesToTheirRequests) {
  const std::map<std::string, std::vector<std::byte>> requests{
      {"E09", tests::bytes_of({1, 6, 1, 0, 0, 0, 0, 0, 8})},
      {"E14", tests::bytes_of({1, 10, 66, 0, 0, 0, 0, 0, 0x4D})},
      {"E20", tests::bytes_of({1, 15, 2, 1, 0, 0, 0, 0, 0x13})},  // a channel that exists
      {"E31", tests::bytes_of({1, 31, 1, 0, 0, 0, 0, 0, 0x21})}};
  module_.position = 711;
  module_.analog[2] = 506;
  std::size_t seen = 0;
  for (const CsvRow& row : rows_of("telegram_examples.csv")) {
    if (row[1] == "reply") {
      EXPECT_EQ(exchange(requests.at(row[0])), hexadecimal(row[3])) << row[0];
      ++seen;
    }
  }
  EXPECT_EQ(seen, requests.size());
}

// Of commands.csv: direct mode takes what its table says, with a type and motor that exist.
TEST_F(DocumentedExamples, EveryDocumentedCommandIsKnown) {
  for (const CsvRow& row : rows_of("commands.csv")) {
    SCOPED_TRACE(row[0] + " " + row[1]);
    const auto number_in = [](const std::string& text, int otherwise) {
      int number = otherwise;
      std::from_chars(text.data(), text.data() + text.size(), number);
      return number;
    };
    const int command = number_in(row[0], -1);
    const bool only_in_programs = row[5].starts_with("direct mode");
    const int type = row[2].starts_with("axis parameter")     ? 6
                     : row[2].starts_with("global parameter") ? 66
                                                              : number_in(row[2], 0);
    const int motor = row[3].starts_with("bank") ? number_in(row[3].substr(5), 0) : 0;
    // Of use for what divides by X and for what the accumulator is copied to.
    static_cast<void>(execute(Command::calculate, 9, 0, 3));
    static_cast<void>(execute(Command::calculate_with_x, 9));
    const bool factory_reset = row[1] == "restore factory settings";
    const HostAnswer answer =
        execute(static_cast<Command>(command), type, motor, factory_reset ? 1234 : 1);
    static_cast<void>(execute(Command::quit_download));
    EXPECT_EQ(answer.status, only_in_programs ? Status::command_not_available : Status::success);
    EXPECT_EQ(answer.form == ReplyForm::none, row[5] == "none");
  }
}

TEST_F(DocumentedExamples, EveryStatusCodeHasItsNumberAndItsOccasion) {
  const auto provoke = [this](int code) {
    switch (code) {
      case 1:
        return std::to_integer<int>(exchange(tests::bytes_of({1, 3, 0, 0, 0, 0, 0, 0, 5}))[2]);
      case 2:
        return static_cast<int>(status(static_cast<Command>(0)));
      case 3:
        return static_cast<int>(status(Command::get_axis_parameter, 200));
      case 4:
        return static_cast<int>(status(Command::set_axis_parameter, 6, 0, 16));
      case 5: {
        set_global(73, kLockEeprom);
        return static_cast<int>(status(Command::store_axis_parameter, 6));
      }
      case 6:
        return static_cast<int>(status(Command::jump_always));
      case 100:
        return static_cast<int>(status(Command::motor_stop));
      case 101: {
        static_cast<void>(execute(Command::start_download));
        const int code_of_stored = static_cast<int>(status(Command::motor_stop));
        static_cast<void>(execute(Command::quit_download));
        return code_of_stored;
      }
      case 128: {
        const auto both = exchange(tests::bytes_of({1, 138, 0, 0, 0, 0, 0, 1, 0x8C}));
        return both.size() == 18 ? std::to_integer<int>(both[11]) : 0;
      }
      default:
        return -1;
    }
  };
  for (const CsvRow& row : rows_of("error_codes.csv")) {
    EXPECT_EQ(provoke(std::stoi(row[0])), std::stoi(row[0])) << row[1];
  }
}

TEST_F(DocumentedExamples, EveryWordOfTheAsciiInterfaceIsAnswered) {
  const std::map<std::string, std::string> operands{
      {"MVP", "ABS, 0, 1"}, {"SAP", "6, 0, 1"}, {"SGP", "66, 0, 1"}, {"STGP", "3, 2"},
      {"RSGP", "3, 2"},     {"GGP", "66, 0"},   {"RFS", "STOP, 0"},  {"SIO", "0, 2, 1"},
      {"GIO", "0, 0"},      {"ROL", "0, 1"},    {"ROR", "0, 1"},     {"MST", "0"},
      {"SCO", "1, 0, 1"},   {"GCO", "1, 0"},    {"CCO", "1, 0"},     {"GAP", "1, 0"},
      {"STAP", "6, 0"},     {"RSAP", "6, 0"}};
  set_global(67, 0x21);
  for (const CsvRow& row : rows_of("ascii_commands.csv")) {
    session_.power_on();
    const auto found = operands.find(row[0]);
    std::string line = "A" + row[0];
    if (found != operands.end()) {
      line += " " + found->second;
    } else if (row[0].starts_with("UF")) {
      line += " 1, 2, 3";
    }
    line_.write(line + "\r");
    session_.serve(now_);
    EXPECT_TRUE(line_.read_text().starts_with(row[0] == "SAC" ? "BA 2 " : "BA 100 ")) << line;
  }
}

TEST_F(DocumentedExamples, TheTestProgramMakesTheDocumentedMoves) {
  start(documented_programs().at("P1"));
  pass();
  EXPECT_EQ(module_.velocity, -500'000);
  advance(5_s);
  EXPECT_EQ(module_.velocity, -500'000);
  pass(2);
  EXPECT_EQ(module_.velocity, 0);
  pass();
  EXPECT_EQ(module_.velocity, 250'000);
  advance(5_s + 300_us);
  EXPECT_EQ(module_.velocities, (std::vector<std::int32_t>{-500'000, 0, 250'000, 0}));
  module_.reached = false;
  pass(20);
  EXPECT_EQ(axis(4), 500'000);
  EXPECT_EQ(axis(5), 50'000);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(module_.target, i % 2 == 0 ? 10'000'000 : -1'000'000);
    module_.reached = true;
    pass();
    module_.reached = false;
    advance(1_s);
  }
}

TEST_F(DocumentedExamples, InputsShowOnTheOutputs) {
  start(documented_programs().at("P2"));
  for (const std::uint32_t inputs : {0x1FFU, 0x000U, 0x085U, 0x17AU}) {
    module_.inputs = inputs;
    pass(6);
    EXPECT_EQ(module_.outputs, inputs & 0x87U);
  }
}

TEST_F(DocumentedExamples, TheComparisonJumpsFrom1000On) {
  for (const std::int32_t position : {-5000, 999, 1000, 1001}) {
    module_.position = position;
    start(documented_programs().at("P3"));
    pass(3);
    EXPECT_EQ(counter(), position >= 1000 ? 10 : 3) << position;
  }
}

TEST_F(DocumentedExamples, TheEndlessLoopGoesToAndFro) {
  std::vector<Instruction> program = documented_programs().at("P4");
  program.back().value = 0;  // the label, not the printed address
  start(program);
  pass(5 * 3);
  EXPECT_EQ(module_.targets, (std::vector<std::int32_t>{10'000, 0, 10'000, 0, 10'000, 0}));
}

TEST_F(DocumentedExamples, TheSubroutineWaitsAndReturnsBehindItsCall) {
  module_.reached = false;
  start(documented_programs().at("P5"));
  pass(10);
  EXPECT_EQ(counter(), 4) << "WAIT POS in the subroutine";
  EXPECT_EQ(firmware_.interpreter().stack_depth(), 1U);
  module_.reached = true;
  pass();
  EXPECT_EQ(counter(), 5);
  advance(499_ms);
  EXPECT_EQ(counter(), 5) << "50 ticks are half a second";
  advance(2_ms);
  EXPECT_EQ(module_.targets, (std::vector<std::int32_t>{10'000, 0, 10'000}))
      << "the second move is not waited for";
}

TEST_F(DocumentedExamples, ThePotentiometerSetsTheTarget) {
  start(documented_programs().at("P6"));
  for (const std::int32_t voltage : {0, 1, 506, 1023}) {
    module_.analog[0] = voltage;
    pass(8);
    EXPECT_EQ(module_.target, 4 * voltage);
  }
}

TEST_F(DocumentedExamples, ProgramsDownloadedByTheirTelegramsAreReadBackTheSame) {
  for (const auto& [name, program] : documented_programs()) {
    static_cast<void>(execute(Command::start_download));
    for (const CsvRow& row : rows_of("program_examples.csv")) {
      if (row[0].starts_with(name)) {
        const auto reply = exchange(hexadecimal(row[5]));
        ASSERT_EQ(reply.size(), kTelegramLength);
        EXPECT_EQ(std::to_integer<int>(reply[2]), 101);
      }
    }
    static_cast<void>(execute(Command::quit_download));
    for (std::size_t i = 0; i < program.size(); ++i) {
      EXPECT_EQ(execute(Command::read_memory, 0, 0, static_cast<std::int32_t>(i)).instruction,
                program[i])
          << name << " " << i;
    }
  }
}

}  // namespace
}  // namespace stator::tmcl
