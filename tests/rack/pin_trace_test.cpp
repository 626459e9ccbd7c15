#include "stator/rack/observe/pin_trace.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rack/io_board.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ::testing::HasSubstr;
using ::testing::Not;

/// A file of its own, removed in the end.
class PinTraceFile : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  RackConfiguration traced(std::vector<std::string> pins, ClockKind clock = ClockKind::lockstep) {
    RackConfiguration rack = IoBoard::without_events();
    rack.clock = clock;
    rack.trace = TraceConfiguration{.file = path_, .device = {}, .pins = std::move(pins)};
    return rack;
  }
  [[nodiscard]] std::string content() const {
    std::ifstream file(path_);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  static std::size_t count(const std::string& text, const std::string& part) {
    std::size_t number = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
      ++number;
    }
    return number;
  }

  std::string path_ = ::testing::TempDir() + "stator-" +
                      ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".vcd";
};

TEST_F(PinTraceFile, HasEveryStepAtItsMoment) {
  IoBoard board(traced({"MFCIO03", "MFCIO04"}));
  board.put("SD_STEPLENGTH", 24);
  board.put("SD_CFG", 3);
  board.put("SD_CH0_STEPRATE", 549'756);
  board.cycles(1000);
  const auto steps = static_cast<std::size_t>(board.get("SD_CH0_STEPCOUNT"));
  board.rack.trace()->finish(board.port.now());
  EXPECT_TRUE(board.rack.trace()->output().complete());
  EXPECT_EQ(board.rack.trace()->dropped(), 0U);
  const std::string text = content();
  EXPECT_THAT(text, HasSubstr("$timescale 1 ns $end"));
  EXPECT_THAT(text, HasSubstr(" MFCIO03_axis_step $end"));
  EXPECT_THAT(text, Not(HasSubstr("MFCIO05")));
  EXPECT_GT(steps, 3000U);
  EXPECT_EQ(count(text, "\n1$\n"), steps) << "line 3 has the code $";
  const std::string end = "#" + std::to_string((board.port.now() - base::SimTime()).nanoseconds());
  EXPECT_EQ(text.substr(text.size() - end.size() - 1), end + "\n");
}

TEST_F(PinTraceFile, DecodesTheBusesAndIsTheSameEachTime) {
  std::string first;
  for (int run = 0; run < 2; ++run) {
    IoBoard board(traced({}));
    board.put("SPI_TIME", 2);
    board.spi(0, 0xE0080, 20);
    board.put("I2C_TIMEBASE", 1);
    board.i2c(0x20);
    board.put("I2C_ADDRESS", 0xA0);
    EXPECT_EQ(board.i2c(0x08), 0x34U) << "peripherals answer also while their lines are watched";
    board.rack.trace()->finish(board.port.now());
    if (run == 0) {
      first = content();
    }
  }
  EXPECT_THAT(first, Not(HasSubstr("filter_line"))) << "the converter's pin only when asked for";
  EXPECT_THAT(first, HasSubstr("sE0080>"));
  EXPECT_THAT(first, HasSubstr("sstart "));
  EXPECT_THAT(first, HasSubstr("sA0+ack "));
  EXPECT_EQ(content(), first);
}

// More edges in one go than the queue takes: with the machine's clock the bus does not wait.
TEST_F(PinTraceFile, CountsWhatIsLostAndShowsItAsUnknown) {
  RackConfiguration configuration = traced({"MFCIO05"}, ClockKind::real);
  configuration.trace->queue = 1000;
  IoBoard board(configuration);
  board.put("PWM_CFG", 9U | 7U << 16U);  // 10 MHz
  board.put("PWM1", 5);
  board.cycles(2);
  board.silence(100_ms);  // 2 million edges
  board.rack.trace()->finish(board.port.now());
  const PinTrace& trace = *board.rack.trace();
  EXPECT_GT(trace.dropped(), 0U);
  EXPECT_GT(trace.written(), 1000U);
  EXPECT_NE(content().find("\nx&\n"), std::string::npos);
}

TEST_F(PinTraceFile, NamesPinsAndChipsThatExist) {
  EventLog log;
  const auto refusal = [&log](const RackConfiguration& configuration) -> std::string {
    try {
      const Rack rack(configuration, log);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal(traced({"MFCIO16"})), HasSubstr("no pin \"MFCIO16\""));
  RackConfiguration elsewhere = traced({});
  elsewhere.trace->device = "ios";
  EXPECT_THAT(refusal(elsewhere), HasSubstr("there is \"io\""));
  RackConfiguration nowhere = traced({});
  nowhere.trace->file = "/nowhere/pins.vcd";
  EXPECT_THAT(refusal(nowhere), HasSubstr("cannot create \"/nowhere/pins.vcd\""));
}

}  // namespace
}  // namespace stator::rack
