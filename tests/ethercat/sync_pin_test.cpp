// The pins of the SYNC unit, what the EEPROM makes of them, and the events mapped to the host.

#include <array>

#include <gtest/gtest.h>

#include "ethercat/controllers.hpp"
#include "ethercat/dc_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using testing::DcBoard;
using testing::DcBus;
using testing::host_read;
using testing::number;

constexpr std::uint32_t kMillisecond = 1'000'000;
constexpr std::uint16_t kSyncActivation = 0x0981;
constexpr unsigned kDebugPulse = 0x80;
constexpr unsigned kOutputBit[] = {0x02, 0x04};

struct Levels {
  PinLevel idle;
  PinLevel pulse;
};

// Of each half of 0x0151: bits 1:0 the driver, bit 2 the direction. Pins of outputs and of latch
// inputs are separate, so 0 in bit 2 does no more than release the output.
constexpr std::array<Levels, 8> kLevels{{
    {PinLevel::released, PinLevel::released},
    {PinLevel::released, PinLevel::released},
    {PinLevel::released, PinLevel::released},
    {PinLevel::released, PinLevel::released},
    {PinLevel::high, PinLevel::low},       // push-pull, active low
    {PinLevel::released, PinLevel::low},   // open drain
    {PinLevel::low, PinLevel::high},       // push-pull, active high
    {PinLevel::released, PinLevel::high},  // open source
}};

const SlaveControllerConfiguration& chip_of(std::string_view device) {
  return testing::controller_of(device);
}

TEST(SyncUnit, Pin_FollowsDriverPolarityAndDirection) {
  for (const std::string_view device : {"tmc8461", "tmc8670"}) {
    for (unsigned configuration = 0; configuration < 64; ++configuration) {
      const std::array<unsigned, 2> half{configuration & 7, configuration >> 3};
      const auto register_value = static_cast<std::uint8_t>(half[0] | half[1] << 4);
      DcBus bus({.sync_latch = register_value}, chip_of(device));
      for (unsigned pulsed = 0; pulsed < 2; ++pulsed) {
        const unsigned other = 1 - pulsed;
        SCOPED_TRACE(::testing::Message() << device << " 0151h = " << int{register_value}
                                          << ", pulse on SYNC" << pulsed);
        EXPECT_EQ(bus.slave().sync_pin(pulsed), kLevels[half[pulsed]].idle);
        bus.set(kSyncActivation, kDebugPulse | kOutputBit[pulsed], 1);
        EXPECT_EQ(bus.slave().sync_pin(pulsed), kLevels[half[pulsed]].pulse);
        EXPECT_EQ(bus.slave().sync_pin(other), kLevels[half[other]].idle) << "the other output";
        bus.wait(SimDuration(20'000));  // longer than the pulse of 10 us
        EXPECT_EQ(bus.slave().sync_pin(pulsed), kLevels[half[pulsed]].idle);
      }
    }
  }
}

TEST(SyncUnit, Pin_BeforeTheEepromIsLoadedIsThatOfTheResetValue) {
  SlaveController tmc8461(chip_of("tmc8461"));
  EXPECT_EQ(tmc8461.sync_pin(0), PinLevel::low) << "66h: push-pull, active high";
  EXPECT_EQ(tmc8461.sync_pin(1), PinLevel::low);
}

TEST(SyncUnit, LatchInput_WorksWhicheverWayTheOutputIsSet) {
  for (const std::uint8_t sync_latch : {std::uint8_t{0x00}, std::uint8_t{0x44}}) {
    DcBus bus({.sync_latch = sync_latch}, chip_of("tmc8670"));
    bus.set(0x0920, 0x1'0000'0000, 8);
    bus.wait(SimDuration(123'456));
    bus.slave().set_latch_input(0, true);
    const std::uint64_t time = bus.system_time();
    EXPECT_EQ(bus.get(0x09B0, 8), time) << "0151h = " << int{sync_latch};
  }
}

TEST(SyncEvents, BitsThreeAndSevenMapEachOutputToItsOwnAlEvent) {
  struct Case {
    std::uint8_t sync_latch;
    std::uint32_t events;
  };
  for (const std::string_view device : {"tmc8461", "tmc8670"}) {
    for (const Case& c : {Case{0x66, 0}, Case{0x6E, 0x04}, Case{0xE6, 0x08}, Case{0xEE, 0x0C}}) {
      DcBus bus({.sync_latch = c.sync_latch, .pulse_length = 0}, chip_of(device));
      const std::uint64_t start = bus.system_time() + kMillisecond;
      bus.start_sync(start, kMillisecond, 0, 7);
      bus.wait_until(start);
      EXPECT_EQ(number(host_read(bus.slave(), 0x0220, 4)) & 0x0C, c.events)
          << device << " 0151h = " << int{c.sync_latch};
      EXPECT_TRUE(bus.slave().sync_output(0)) << "mapped or not, the pin shows the pulse";
      EXPECT_TRUE(bus.slave().sync_output(1));
    }
  }
}

}  // namespace
}  // namespace stator::ethercat
