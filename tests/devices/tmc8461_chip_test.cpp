// The TMC8461 as a chip on a board: reset loop, configuration pins, lines to the controller beside
// it, EEPROM, and what it costs when nobody looks.

#include <array>
#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "board/bench.hpp"
#include "devices/tmc8461_board.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/ethercat/sii/sii_image.hpp"

namespace stator::devices {
namespace {

using base::SimDuration;
using base::SimTime;
using ethercat::AlState;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using tests::ChipBoard;
using namespace base::literals;

/// The key of a reset by the master, one byte in each of three frames (L2764).
void reset_by_master(ChipBoard& board) {
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    board.bus_write(0x0040, {key});
  }
}

TEST(Tmc8461Chip, AnswersTheDocumentsFirstReadAtThePdi) {
  ChipBoard board;
  EXPECT_THAT(board.pdi({0x00, 0x02, 0x00, 0x00, 0x00, 0xFF}),
              ElementsAre(0, 0, 0xD0, 0x61, 0x11, 0x00));
}

TEST(Tmc8461Chip, ResetByTheMasterPassesThroughResetOut) {
  ChipBoard board;
  board.watch({product::HostLine::reset_out, product::HostLine::eeprom_loaded});
  board.bus_write(0x0010, {0x34, 0x12});
  reset_by_master(board);
  EXPECT_THAT(board.rises(product::HostLine::reset_out), SizeIs(1));
  EXPECT_THAT(board.falls(product::HostLine::reset_out), SizeIs(1)) << "the reset clears it";
  EXPECT_FALSE(board.high(product::HostLine::reset_out));
  EXPECT_EQ(board.bus_read(0x0010), 0U);
  EXPECT_EQ(board.chip.reset_requests(), 1U);
}

TEST(Tmc8461Chip, WithoutTheLoopResetOutStaysHighAndNothingIsReset) {
  ChipBoard board({.reset_loop = false});
  board.bus_write(0x0010, {0x34, 0x12});
  reset_by_master(board);
  EXPECT_TRUE(board.high(product::HostLine::reset_out));
  EXPECT_EQ(board.bus_read(0x0010), 0x34U);
  board.chip.set_pin(product::HostPin::reset, false);
  EXPECT_FALSE(board.high(product::HostLine::reset_out)) << "NRESET clears it";
  board.chip.set_pin(product::HostPin::reset, true);
  EXPECT_EQ(board.bus_read(0x0010), 0U);
}

TEST(Tmc8461Chip, ResetByTheHostPassesThroughResetOut) {
  ChipBoard board;
  board.watch({product::HostLine::reset_out});
  board.bus_write(0x0010, {0x34, 0x12});
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    board.pdi_write(0x0041, {key});
  }
  EXPECT_THAT(board.rises(product::HostLine::reset_out), SizeIs(1));
  EXPECT_EQ(board.bus_read(0x0010), 0U);
}

TEST(Tmc8461Chip, HeldInResetItsSpiIsSilentAndItsLinesAreLow) {
  ChipBoard board;
  board.chip.set_pin(product::HostPin::reset, false);
  EXPECT_THAT(board.pdi({0x00, 0x02, 0xFF}), ElementsAre(0, 0, 0));
  EXPECT_EQ(board.chip.levels(), product::host_line(product::HostLine::power));
  board.chip.set_pin(product::HostPin::reset, true);
  EXPECT_THAT(board.pdi({0x00, 0x02, 0xFF}), ElementsAre(0, 0, 0xD0));
  EXPECT_TRUE(board.high(product::HostLine::eeprom_loaded));
}

TEST(Tmc8461Chip, HeldInResetItPassesNoFramesAndStartsInInitWhenLetGo) {
  ChipBoard board({.device_emulation = true});
  board.watch({product::HostLine::reset_out});
  board.bus.request(AlState::pre_operational);
  board.chip.set_pin(product::HostPin::reset, false);
  EXPECT_FALSE(board.bus.answers());
  EXPECT_FALSE(board.chip.controller().link(0)) << "nor does a neighbour see a link";
  board.chip.set_pin(product::HostPin::reset, true);
  EXPECT_TRUE(board.bus.answers());
  EXPECT_EQ(board.bus_read(0x0130), 1U);
  EXPECT_THAT(board.rises(product::HostLine::reset_out), IsEmpty())
      << "that was no register's doing";
  EXPECT_EQ(board.chip.reset_requests(), 0U);
}

TEST(Tmc8461Chip, PowerThatComesBackDoesNotEndItsReset) {
  ChipBoard board;
  board.chip.set_power(false, board.bus.now());
  board.chip.set_pin(product::HostPin::reset, false);
  board.chip.controller().restore_power();
  board.chip.set_power(true, board.bus.now());
  EXPECT_FALSE(board.bus.answers());
  EXPECT_EQ(board.chip.levels(), product::host_line(product::HostLine::power));
  board.chip.set_pin(product::HostPin::reset, true);
  EXPECT_TRUE(board.bus.answers());
}

TEST(Tmc8461Chip, ResetInTheMiddleOfADatagramEndsIt) {
  ChipBoard board;
  const auto head = ChipBoard::bytes({0x80, 0x04});
  ChipBoard::Bytes in(2);
  board.chip.select(product::HostSpi::pdi);
  board.chip.transfer(product::HostSpi::pdi, head, in, {});
  board.chip.set_pin(product::HostPin::reset, false);
  board.chip.set_pin(product::HostPin::reset, true);
  board.chip.transfer(product::HostSpi::pdi, ChipBoard::bytes({0x55, 0x55}), in, {});
  board.chip.deselect(product::HostSpi::pdi, 0);
  EXPECT_EQ(board.bus_read(0x1000), 0U);
}

TEST(Tmc8461Chip, WithDeviceEmulationTheStateFollowsTheMaster) {
  ChipBoard board({.device_emulation = true});
  for (const AlState state :
       {AlState::pre_operational, AlState::safe_operational, AlState::operational, AlState::init}) {
    EXPECT_EQ(board.bus.request(state), static_cast<std::uint16_t>(state));
  }
  EXPECT_EQ(board.bus_read(0x0141) & 1U, 1U);
}

TEST(Tmc8461Chip, WithoutEmulationAControllerAtThePdiAnswers) {
  ChipBoard board;
  EXPECT_EQ(board.bus.request(AlState::pre_operational), 1U) << "nobody has answered";
  EXPECT_THAT(board.pdi({0x09, 0x03, 0xFF, 0x00, 0xFF}), ElementsAre(1, 0, 0, 2, 0));
  board.pdi_write(0x0130, {2, 0});
  EXPECT_EQ(board.bus_read(0x0130), 2U);
}

TEST(Tmc8461Chip, InterruptFollowsTheEventMask) {
  ChipBoard board;
  board.watch({product::HostLine::interrupt});
  board.bus.request(AlState::pre_operational);
  ASSERT_TRUE(board.high(product::HostLine::interrupt))
      << "the mask lets everything through at first";
  board.pdi_write(0x0204, {0, 0, 0, 0});
  EXPECT_FALSE(board.high(product::HostLine::interrupt));
  board.pdi_write(0x0204, {1, 0, 0, 0});
  EXPECT_TRUE(board.high(product::HostLine::interrupt));
  board.pdi({0x09, 0x02, 0x00, 0xFF});
  EXPECT_FALSE(board.high(product::HostLine::interrupt)) << "acknowledged";
  EXPECT_THAT(board.rises(product::HostLine::interrupt), SizeIs(2));
  EXPECT_THAT(board.falls(product::HostLine::interrupt), SizeIs(2));
}

TEST(Tmc8461Chip, InterruptPinHasTheDriverAndPolarityOfItsConfiguration) {
  struct Pin {
    std::uint8_t configuration;
    double idle;
    double requests;
  };
  for (const Pin& pin :
       {Pin{0x03, 1.0, 0.0}, Pin{0x07, 0.5, 0.0}, Pin{0x0B, 0.0, 1.0}, Pin{0x0F, 0.5, 1.0}}) {
    ChipBoard board({.pdi_configuration = pin.configuration});
    const auto level = [&board] {
      for (const product::Signal& signal : board.chip.signals()) {
        if (signal.name == "pdi_spi_irq") {
          return signal.read();
        }
      }
      return -1.0;
    };
    board.pdi_write(0x0204, {1, 0, 0, 0});
    EXPECT_EQ(level(), pin.idle) << unsigned{pin.configuration};
    board.bus.request(AlState::pre_operational);
    EXPECT_EQ(level(), pin.requests) << unsigned{pin.configuration};
    board.pdi({0x09, 0x02, 0x00, 0xFF});
    EXPECT_EQ(level(), pin.idle) << unsigned{pin.configuration};
  }
}

TEST(Tmc8461Chip, EepromLoadedIsShownAndABadImageClosesThePdi) {
  auto image = ChipBoard().chip.sii_image();
  {
    Tmc8461Configuration good;
    good.sii = image;
    ChipBoard board(good);
    EXPECT_TRUE(board.high(product::HostLine::eeprom_loaded));
  }
  image[14] ^= std::byte{1};
  Tmc8461Configuration bad;
  bad.sii = image;
  ChipBoard board(bad);
  EXPECT_FALSE(board.high(product::HostLine::eeprom_loaded));
  EXPECT_THAT(board.pdi({0x00, 0x02, 0xFF}), ElementsAre(0, 0, 0));
  EXPECT_EQ(board.chip.sii_image(), image) << "what it was given is what it exports";
}

TEST(Tmc8461Chip, SizeOfTheEepromFollowsItsPin) {
  EXPECT_EQ(ChipBoard().bus_read(0x0502) & 0x80U, 0U);
  EXPECT_EQ(ChipBoard({.large_eeprom = true}).bus_read(0x0502) & 0x80U, 0x80U);
}

TEST(Tmc8461Chip, PhyOffsetMovesTheAddresses) {
  EXPECT_EQ(ChipBoard().bus_read(0x0510) >> 3U, 0U);
  EXPECT_EQ(ChipBoard({.phy_offset = true}).bus_read(0x0510) >> 3U, 1U);
}

TEST(Tmc8461Chip, TransmitShiftAndLinkPolarityAreThoseOfItsPins) {
  const auto delays = [](const Tmc8461Configuration& configuration) {
    Tmc8461 chip(configuration);
    const auto all = chip.controller().forwarding().transmit_delay;
    return std::array{all[0].nanoseconds(), all[1].nanoseconds()};
  };
  Tmc8461Configuration configuration;
  EXPECT_THAT(delays(configuration), ElementsAre(0, 0));
  configuration.tx_shift = std::uint8_t{3};
  EXPECT_THAT(delays(configuration), ElementsAre(30, 30)) << "one strap for both ports";
  configuration.tx_shift.reset();
  configuration.tx_clock_phase = {0, 12};
  EXPECT_THAT(delays(configuration), ElementsAre(0, 20)) << "found by the chip";

  Tmc8461Configuration wrong;
  wrong.link_polarity = true;
  EXPECT_FALSE(ChipBoard(wrong).bus.answers()) << "the PHYs are active low";
  wrong.phy_link_active_high = {true, true};
  EXPECT_TRUE(ChipBoard(wrong).bus.answers());
}

TEST(Tmc8461Chip, PhyThatIsNotFoundGivesItsPortNoLink) {
  Tmc8461Configuration configuration;
  configuration.phy_addresses = {{0, 9}};
  ChipBoard board(configuration);
  board.chip.controller().set_link(1, true);
  EXPECT_EQ(board.bus_read(0x0110) & 0x30U, 0x10U);
  EXPECT_EQ(board.bus_read(0x0519), 0x08U) << "read error";
  configuration.phy_addresses = {{5, 1}};
  EXPECT_FALSE(ChipBoard(configuration).bus.answers()) << "the port towards the master";
  configuration.phy_offset = true;
  configuration.phy_addresses = {{1, 2}};
  EXPECT_TRUE(ChipBoard(configuration).bus.answers());
}

TEST(Tmc8461Chip, ImageDescribesTheProcessDataItWasGiven) {
  Tmc8461Configuration configuration;
  configuration.output_bytes = 6;
  configuration.input_bytes = 2;
  configuration.output_address = 0x1800;
  configuration.station_alias = 77;
  const auto contents = ethercat::parse_sii_image(Tmc8461(configuration).sii_image());
  ASSERT_TRUE(contents);
  EXPECT_EQ(contents->station_alias, 77U);
  ASSERT_THAT(contents->sync_managers, SizeIs(4));
  EXPECT_EQ(contents->sync_managers[0].length, 0U) << "no mailbox";
  EXPECT_EQ(contents->sync_managers[2].start, 0x1800U);
  EXPECT_EQ(contents->sync_managers[2].length, 6U);
  EXPECT_EQ(contents->sync_managers[3].length, 2U);
  ASSERT_THAT(contents->rx_pdos, SizeIs(1));
  EXPECT_THAT(contents->rx_pdos[0].entries, SizeIs(6));
  EXPECT_EQ(Tmc8461(configuration).object_dictionary(), nullptr) << "it has no CoE";
}

TEST(Tmc8461Chip, FramesAndWatchdogPulseTheirPins) {
  ChipBoard board({.device_emulation = true});
  board.watch({product::HostLine::start_of_frame, product::HostLine::end_of_frame,
               product::HostLine::watchdog_trigger, product::HostLine::watchdog_state});
  board.bus_read(0x0000);
  EXPECT_THAT(board.rises(product::HostLine::start_of_frame), SizeIs(1));
  EXPECT_THAT(board.falls(product::HostLine::end_of_frame), SizeIs(1));
  EXPECT_THAT(board.rises(product::HostLine::watchdog_trigger), IsEmpty());
  board.bus_write(0x0810, {0x00, 0x10, 4, 0, 0x64, 0, 1, 0});
  board.bus_write(0x1000, {1, 2, 3, 4});
  EXPECT_THAT(board.rises(product::HostLine::watchdog_trigger), SizeIs(1));
  EXPECT_TRUE(board.high(product::HostLine::watchdog_state));
  const std::int64_t triggered = (board.bus.now() - SimTime()).nanoseconds();
  board.bus.pass(150_ms);
  EXPECT_FALSE(board.high(product::HostLine::watchdog_state));
  ASSERT_THAT(board.falls(product::HostLine::watchdog_state), SizeIs(1));
  EXPECT_NEAR(static_cast<double>(board.falls(product::HostLine::watchdog_state)[0] - triggered),
              100e6, 1000.0)
      << "told at its moment, not when somebody looked";
}

TEST(Tmc8461Chip, Sync0IsToldAtItsEdges) {
  ChipBoard board({.device_emulation = true});
  board.bus.pass(1_ms);
  board.watch({product::HostLine::sync0});
  board.bus_write(0x09A0, {0x40, 0x42, 0x0F, 0});  // 1 ms
  const std::uint64_t start = board.chip.controller().system_time(board.bus.now()) + 5'000'000;
  ChipBoard::Bytes time(8);
  base::store_le(time.data(), start);
  board.bus.write(0x0990, time);
  board.bus_write(0x0981, {0x03});
  board.bus.pass(10_ms);
  const auto rises = board.rises(product::HostLine::sync0);
  const auto falls = board.falls(product::HostLine::sync0);
  ASSERT_GE(rises.size(), 4U);
  ASSERT_EQ(falls.size(), rises.size());
  for (std::size_t i = 0; i < rises.size(); ++i) {
    EXPECT_EQ(falls[i] - rises[i], 10'000) << "pulse length of the EEPROM";
    if (i != 0) {
      EXPECT_EQ(rises[i] - rises[i - 1], 1'000'000);
    }
  }
}

TEST(Tmc8461Chip, LedsBlinkAsTheirStatesSay) {
  ChipBoard board({.device_emulation = true});
  board.watch({product::HostLine::run_led});
  EXPECT_FALSE(board.high(product::HostLine::run_led)) << "Init";
  board.bus.request(AlState::pre_operational);
  board.changes.clear();
  board.bus.pass(2000_ms);
  const auto rises = board.rises(product::HostLine::run_led);
  ASSERT_THAT(rises, SizeIs(5)) << "2.5 Hz";
  EXPECT_EQ(rises[1] - rises[0], 400'000'000);
  board.bus.request(AlState::safe_operational);
  board.bus.request(AlState::operational);
  EXPECT_TRUE(board.high(product::HostLine::run_led));
}

TEST(Tmc8461Chip, LooksTheSameWhetherSomebodyLookedBeforeOrNot) {
  ChipBoard watched({.device_emulation = true});
  ChipBoard unseen({.device_emulation = true});
  for (ChipBoard* board : {&watched, &unseen}) {
    board->bus.request(AlState::pre_operational);
  }
  const auto look = [](ChipBoard& board) {
    std::vector<double> values;
    for (const product::Signal& signal : board.chip.signals()) {
      values.push_back(signal.read());
    }
    return values;
  };
  watched.bus.pass(170_ms);
  look(watched);
  watched.bus.pass(330_ms);
  unseen.bus.pass(500_ms);
  for (int i = 0; i < 40; ++i) {
    watched.bus.pass(50_ms);
    unseen.bus.pass(50_ms);
    EXPECT_EQ(look(watched), look(unseen)) << i;
  }
}

TEST(Tmc8461Chip, LinkLedsAreOnWithALinkAndFlickerWithFrames) {
  ChipBoard board;
  board.bus.pass(1000_ms);
  EXPECT_TRUE(board.high(product::HostLine::link_activity0));
  EXPECT_FALSE(board.high(product::HostLine::link_activity1)) << "nothing is connected there";
  board.watch({product::HostLine::link_activity0});
  for (int i = 0; i < 20; ++i) {
    board.bus_read(0x0000);
    board.bus.pass(20_ms);
  }
  EXPECT_GE(board.falls(product::HostLine::link_activity0).size(), 3U);
}

TEST(Tmc8461Chip, PdiWatchdogSupervisesTheControllerOnceThereIsOne) {
  ChipBoard board;
  board.bus.pass(1000_ms);
  EXPECT_EQ(board.bus_read(0x0110) & 2U, 2U) << "nobody was ever there";
  board.pdi({0, 0});
  board.bus.pass(90_ms);
  EXPECT_EQ(board.bus_read(0x0110) & 2U, 2U);
  board.bus.pass(20_ms);
  EXPECT_EQ(board.bus_read(0x0110) & 2U, 0U);
  EXPECT_EQ(board.bus_read(0x0443), 1U);
}

TEST(Tmc8461Chip, LatchInputsReachTheirUnit) {
  ChipBoard board;
  board.bus_write(0x09A8, {0x01});
  board.bus.pass(1_ms);
  board.chip.set_pin(product::HostPin::latch0, true);
  EXPECT_EQ(board.bus_read(0x09AE) & 0x05U, 0x05U);
}

TEST(Tmc8461Chip, WithoutPowerNothingAnswersAndItStartsAnew) {
  ChipBoard board({.device_emulation = true});
  board.watch({product::HostLine::power, product::HostLine::reset_out});
  board.bus.request(AlState::pre_operational);
  board.chip.set_power(false, board.bus.now());
  EXPECT_EQ(board.chip.levels(), 0U);
  EXPECT_THAT(board.pdi({0x00, 0x02, 0xFF}), ElementsAre(0, 0, 0));
  board.chip.controller().restore_power();
  board.chip.set_power(true, board.bus.now());
  EXPECT_THAT(board.falls(product::HostLine::power), SizeIs(1));
  EXPECT_THAT(board.rises(product::HostLine::power), SizeIs(1));
  EXPECT_THAT(board.rises(product::HostLine::reset_out), IsEmpty())
      << "that was no register's doing";
  EXPECT_EQ(board.bus_read(0x0130), 1U);
}

double signal_of(Tmc8461& chip, const std::string& name) {
  for (const product::Signal& signal : chip.signals()) {
    if (signal.name == name) {
      return signal.read();
    }
  }
  ADD_FAILURE() << "no signal " << name;
  return 0.0;
}

// A lamp and a fan at static levels: what a chip without supply lets go, and what goes on without
// it.
TEST(Tmc8461Chip, WithoutPowerItsPinsLetGoAndTheBoardGoesOn) {
  Tmc8461Configuration configuration{.device_emulation = true};
  configuration.board.peripherals = {
      board::part("lamp", board::kLed, {{"line", 0}}),
      board::part("fan", board::kBridgeMotor,
                  {{"a_high", 1}, {"a_low", 2}, {"b_high", 3}, {"b_low", 4}})};
  ChipBoard board(configuration);
  const auto bring_up = [&board] {
    for (const AlState state :
         {AlState::pre_operational, AlState::safe_operational, AlState::operational}) {
      ASSERT_EQ(board.bus.request(state), static_cast<unsigned>(state));
    }
    board.bus_write(0x0580, {2, 2, 1, 1, 2});  // static levels: high, high, low, low, high
  };
  const auto lamp = [&board] { return signal_of(board.chip, "lamp.brightness"); };
  const auto speed = [&board] { return signal_of(board.chip, "fan.speed"); };
  bring_up();
  board.bus.pass(1_s);
  ASSERT_EQ(lamp(), 1.0);
  const double running = speed();
  const double turned = signal_of(board.chip, "fan.position");
  ASSERT_GT(running, 10.0);

  board.chip.set_power(false, board.bus.now());
  board.bus.pass(10_ms);
  EXPECT_EQ(lamp(), 0.0);
  EXPECT_EQ(signal_of(board.chip, "mfcio00"), 0.5) << "nobody drives it";
  EXPECT_LT(speed(), running);
  EXPECT_GT(signal_of(board.chip, "fan.position"), turned) << "it runs on";
  board.bus.pass(100_s);
  EXPECT_NEAR(speed(), 0.0, 0.01);
  const double rest = signal_of(board.chip, "fan.position");

  board.chip.controller().restore_power();
  board.chip.set_power(true, board.bus.now());
  board.bus.pass(1_s);
  EXPECT_EQ(lamp(), 0.0) << "in Init, without its settings";
  EXPECT_EQ(signal_of(board.chip, "fan.position"), rest) << "it was not driven meanwhile";
  bring_up();
  board.bus.pass(1_s);
  EXPECT_EQ(lamp(), 1.0);
  EXPECT_NEAR(speed(), running, 0.1 * running);
}

TEST(Tmc8461Chip, UnwatchedItHasNothingToDo) {
  ChipBoard board;
  EXPECT_EQ(board.chip.next_line_change(), SimTime::never());
  board.watch({product::HostLine::interrupt});
  EXPECT_EQ(board.chip.next_line_change(), SimTime::never());
  board.chip.watch(0, nullptr);
  EXPECT_EQ(board.chip.next_line_change(), SimTime::never());
}

TEST(Tmc8461Chip, SignalsAndInputsAreItsPins) {
  ChipBoard board;
  bool found = false;
  for (const product::Signal& signal : board.chip.signals()) {
    if (signal.name == "prom_init") {
      found = true;
      EXPECT_EQ(signal.read(), 1.0);
    }
  }
  EXPECT_TRUE(found);
  for (const product::Input& input : board.chip.inputs()) {
    if (input.name == "nreset") {
      input.set(0.0);
    }
  }
  EXPECT_FALSE(board.high(product::HostLine::eeprom_loaded));
}

}  // namespace
}  // namespace stator::devices
