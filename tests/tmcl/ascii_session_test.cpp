// Lines of text on a serial line.

#include <string>

#include <gtest/gtest.h>

#include "stator/tmcl/sessions/ascii_command.hpp"
#include "stator/tmcl/sessions/serial_session.hpp"
#include "tmcl/firmware_fixture.hpp"
#include "tmcl/serial_line.hpp"

namespace stator::tmcl {
namespace {

using namespace base::literals;
using enum Command;

class AsciiSession : public tests::FirmwareFixture {
 protected:
  static constexpr std::int32_t kNoEcho = 0x21;
  static constexpr std::int32_t kLineEcho = 0x11;
  static constexpr std::int32_t kCharacterEcho = 0x01;

  AsciiSession() {
    session_.connect(&line_);
    start_with(kNoEcho);
  }

  void start_with(std::int32_t ascii_mode) {
    set_global(67, ascii_mode);
    session_.power_on();
  }
  std::string exchange(std::string_view text) {
    line_.write(text);
    session_.serve(now_);
    return line_.read_text();
  }

  tests::SerialLine line_;
  SerialSession session_{firmware_};
};

// L843-L845, with this module's number of the actual position (A15).
TEST_F(AsciiSession, AReplyHasBothLettersStatusAndValue) {
  module_.position = -5000;
  EXPECT_EQ(exchange("AGAP 1, 0\r"), "BA 100 -5000\r");
}

TEST_F(AsciiSession, SpacesBehindTheLetterAreOptional) {
  EXPECT_EQ(exchange("AMVP ABS, 0, 50000\r"), "BA 100 50000\r");
  EXPECT_EQ(exchange("A MVP ABS, 0, 50001\r"), "BA 100 50001\r");
  EXPECT_EQ(exchange("A   mvp   rel ,0,  -7  \r"), "BA 100 -7\r") << "nor is letter case";
  EXPECT_EQ(module_.targets, (std::vector<std::int32_t>{50000, 50001, -7}));
  EXPECT_EQ(exchange("AROL 0, 500\r"), "BA 100 500\r");
  EXPECT_EQ(module_.velocity, -500);
}

TEST_F(AsciiSession, LinesForOtherModulesPassInSilence) {
  start_with(kCharacterEcho);
  EXPECT_EQ(exchange("BMST 0\r"), "");
  EXPECT_EQ(exchange(" AMST 0\r"), "") << "the letter must come first";
  EXPECT_EQ(exchange("\r"), "");
  EXPECT_TRUE(module_.velocities.empty());
}

TEST_F(AsciiSession, AddressesGiveTheirLetters) {
  set_global(66, 3);
  set_global(76, 26);
  EXPECT_EQ(exchange("AMST 0\r"), "");
  EXPECT_EQ(exchange("cMST 0\r"), "ZC 100 0\r");
  EXPECT_EQ(letter_of(0), '?');
  EXPECT_EQ(letter_of(27), '?');
  set_global(66, 27);
  EXPECT_EQ(exchange("?MST 0\r"), "") << "has no letter";
}

TEST_F(AsciiSession, RefusalsAreStatusCodes) {
  EXPECT_EQ(exchange("ASAC 0, 0, 0\r"), "BA 2 0\r");
  EXPECT_EQ(exchange("AFOO\r"), "BA 2 0\r");
  EXPECT_EQ(exchange("AJA 0\r"), "BA 2 0\r") << "not for lines of text";
  EXPECT_EQ(exchange("ACALC ADD, 1\r"), "BA 2 0\r");
  EXPECT_EQ(exchange("AMST 1\r"), "BA 4 0\r") << "motor 1";
  EXPECT_EQ(exchange("ASAP 6, 0, 200\r"), "BA 4 200\r");
  EXPECT_EQ(exchange("AGAP 200, 0\r"), "BA 3 0\r");
  for (const char* line :
       {"AGAP 1\r", "AGAP\r", "AGAP 1, 0, 0\r", "AGAP x, 0\r", "AGAP 256, 0\r", "AGAP -1, 0\r",
        "AGAP 1, 0,\r", "AGAP ,\r", "ASAP 4, 0, 2147483648\r", "AMVP FOO, 0, 1\r",
        "AMVP ABS, 0, 1.5\r", "AMVP ABS 0, 1\r", "AMVP ABS, 0, +-1\r", "AMVP ABS, 0, -\r"}) {
    EXPECT_EQ(exchange(line), "BA 4 0\r") << line;
  }
  EXPECT_TRUE(module_.targets.empty());
}

TEST_F(AsciiSession, OperandsReachTheEndsOfTheirRange) {
  EXPECT_EQ(exchange("AMVP ABS, 0, -2147483648\r"), "BA 100 -2147483648\r");
  EXPECT_EQ(exchange("AMVP 0, 0, +2147483647\r"), "BA 100 2147483647\r");
  EXPECT_EQ(exchange("ASGP 55, 2, -1\r"), "BA 100 -1\r");
  EXPECT_EQ(exchange("AGGP 55, 2\r"), "BA 100 -1\r");
  EXPECT_EQ(exchange("ARFS STATUS, 0\r"), "BA 100 0\r");
}

TEST_F(AsciiSession, CharactersAreEchoedOnceTheModuleIsAddressed) {
  start_with(kCharacterEcho);
  EXPECT_EQ(exchange("A"), "A");
  EXPECT_EQ(exchange("MS"), "MS");
  EXPECT_EQ(exchange("T 0\r"), "T 0\rBA 100 0\r");
}

TEST_F(AsciiSession, TheLineIsEchoedAfterItsEnd) {
  start_with(kLineEcho);
  EXPECT_EQ(exchange("A mst "), "");
  EXPECT_EQ(exchange("0\r"), "A mst 0\rBA 100 0\r");
}

TEST_F(AsciiSession, WithoutEchoOnlyTheReplyIsSent) {
  for (const std::int32_t mode : {0x21, 0x31}) {
    start_with(mode);
    EXPECT_EQ(exchange("AMST 0\r"), "BA 100 0\r") << mode;
  }
}

TEST_F(AsciiSession, BackspaceTakesTheLatestCharacterAway) {
  start_with(kCharacterEcho);
  EXPECT_EQ(exchange("AGAP 1, 9\b0\r"), "AGAP 1, 9\b0\rBA 100 0\r");
  start_with(kNoEcho);
  EXPECT_EQ(exchange("AMST X\x7F"
                     "0\r"),
            "BA 100 0\r");
  EXPECT_EQ(exchange("B\bAMST 0\r"), "BA 100 0\r") << "also the letter";
  EXPECT_EQ(exchange("AX\b\bBMST 0\r"), "");
  EXPECT_EQ(exchange("A\b\r"), "") << "nothing is left";
  EXPECT_EQ(exchange("\b\b\bAMST 0\r"), "BA 100 0\r") << "there is nothing to take away";
}

TEST_F(AsciiSession, LineFeedsMeanNothing) {
  EXPECT_EQ(exchange("AMST 0\r\nAMST 0\r\n"), "BA 100 0\rBA 100 0\r");
}

TEST_F(AsciiSession, EmptyLinesAreNotAnswered) {
  EXPECT_EQ(exchange("A\r"), "");
  EXPECT_EQ(exchange("A  \r"), "");
}

TEST_F(AsciiSession, LinesThatAreTooLongAreRefused) {
  const std::string blanks(200, ' ');
  EXPECT_EQ(exchange("AMST 0" + blanks + "\r"), "BA 4 0\r");
  EXPECT_EQ(exchange("AMST 0\r"), "BA 100 0\r");
  EXPECT_EQ(exchange("AMST 0" + blanks + std::string(200, '\b') + "\r"), "BA 100 0\r")
      << "erased in time";
}

TEST_F(AsciiSession, BinGoesBackToTelegramsAnd139ToText) {
  EXPECT_TRUE(session_.in_ascii_mode());
  EXPECT_EQ(exchange("ABIN\r"), "BA 100 0\r");
  EXPECT_FALSE(session_.in_ascii_mode());
  line_.write(encode(Request{.address = 1, .command = 139}));
  session_.serve(now_);
  EXPECT_EQ(line_.read(), tests::bytes_of({2, 1, 0x64, 0x8B, 0, 0, 0, 0, 0xF2}))
      << "the reply is binary still";
  EXPECT_EQ(exchange("AMST 0\r"), "BA 100 0\r");
}

TEST_F(AsciiSession, TextModeCancelsTheEventThatWasAskedFor) {
  exchange("ABIN\r");
  module_.reached = false;
  line_.write(encode(Request{.address = 1, .command = 138, .value = 1}));
  line_.write(encode(Request{.address = 1, .command = 139}));
  EXPECT_EQ(exchange("").size(), 18U);
  module_.reached = true;
  EXPECT_EQ(exchange(""), "");
}

TEST_F(AsciiSession, TheModuleStartsWithTelegramsUnlessToldOtherwise) {
  for (const std::int32_t mode : {0x00, 0x10, 0x20}) {
    start_with(mode);
    EXPECT_FALSE(session_.in_ascii_mode());
  }
}

TEST_F(AsciiSession, RunAndStopControlTheProgram) {
  load({tests::instruction(calculate, 0, 0, 1), tests::instruction(jump_always)});
  EXPECT_EQ(exchange("ARUN\r"), "BA 100 0\r");
  EXPECT_EQ(application(), ApplicationStatus::run);
  pass(3);
  EXPECT_EQ(exchange("ASTOP\r"), "BA 100 0\r");
  EXPECT_EQ(application(), ApplicationStatus::stop);
  EXPECT_EQ(registers().accumulator, 2);
  EXPECT_EQ(exchange("aRun\r"), "BA 100 0\r");
  EXPECT_EQ(counter(), 0) << "from its begin";
  EXPECT_EQ(exchange("ARUN 1\r"), "BA 2 0\r");
}

TEST_F(AsciiSession, ThePauseHoldsRepliesBackAndOneLineWaits) {
  set_global(75, 10);
  EXPECT_EQ(exchange("AROR 0, 1\rAROR 0, 2\rAROR 0, 3\r"), "");
  EXPECT_EQ(module_.velocities, std::vector<std::int32_t>{1});
  now_ += 10_ms;
  EXPECT_EQ(exchange(""), "BA 100 1\r");
  now_ += 10_ms;
  EXPECT_EQ(exchange(""), "BA 100 2\r");
  now_ += 10_ms;
  EXPECT_EQ(exchange("AROR 0, 4\r"), "");
  EXPECT_EQ(module_.velocities, (std::vector<std::int32_t>{1, 2, 4}));
}

TEST_F(AsciiSession, LinesAreStoredInDownloadModeLikeTelegrams) {
  EXPECT_EQ(status(start_download), Status::success);
  EXPECT_EQ(exchange("AMVP ABS, 0, 1000\r"), "BA 101 1000\r");
  EXPECT_EQ(firmware_.memory()[0], tests::instruction(move_to_position, 0, 0, 1000));
}

}  // namespace
}  // namespace stator::tmcl
