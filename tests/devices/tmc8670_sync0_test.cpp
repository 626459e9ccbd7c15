// The chip synchronised by distributed clocks.

#include <array>
#include <cmath>
#include <string>

#include "devices/tmc8670_chip.hpp"

namespace stator::devices {
namespace {

class Tmc8670WithSync0 : public Tmc8670Chip {
 protected:
  static tests::TestBus::Bytes bytes(std::uint64_t value, std::size_t length) {
    tests::TestBus::Bytes result(8);
    base::store_le(result, 0, value);
    result.resize(length);
    return result;
  }
  /// Pre-Operational with SYNC0 every `cycle` from 2 ms after the present on.
  void activate_sync0(std::uint32_t cycle) {
    bus_->bring_to(AlState::pre_operational);
    bus_->write(0x0420, bytes(0, 2));
    const std::uint64_t now = device_->controller().system_time(bus_->now());
    bus_->write(0x0990, bytes(now + 2'000'000, 8));
    bus_->write(0x09A0, bytes(cycle, 4));
    bus_->write(0x0980, bytes(0x0300, 2));  // AssignActivate of the mode DC_Sync0
  }
  void go_operational_with(std::uint32_t cycle) {
    activate_sync0(cycle);
    bus_->bring_to(AlState::safe_operational);
    bus_->pass(3_ms);
    ASSERT_EQ(bus_->request(AlState::operational), 0x08);
  }
  base::SimDuration until_sync0() { return device_->controller().next_sync_edge(0) - bus_->now(); }
  /// Outputs, then time up to `after` the next SYNC0.
  void cycle(std::uint16_t controlword, std::uint8_t mode, std::int32_t position,
             base::SimDuration after = 50_us) {
    base::store_le(bus_->outputs, 0, controlword);
    base::store_le(bus_->outputs, 2, mode);
    base::store_le(bus_->outputs, 3, position);
    bus_->exchange();
    bus_->pass(until_sync0() + after);
  }
  void follow_positions(int cycles, int step) {
    for (const int controlword : {6, 7, 15, 15, 15}) {
      cycle(static_cast<std::uint16_t>(controlword), 8, 0);
    }
    for (int k = 1; k <= cycles; ++k) {
      cycle(15, 8, step * k);
    }
    bus_->pass(100_ms);
  }
};

TEST_F(Tmc8670WithSync0, SetPointsAreTakenOverAtSync0ToTheNanosecond) {
  go_operational_with(1'000'000);
  cycle(6, 8, 0);
  base::store_le(bus_->outputs, 0, std::uint16_t{7});
  bus_->exchange();
  for (int k = 0; k < 20; ++k) {
    const std::uint16_t wanted = k % 2 == 0 ? 7 : 6;
    base::store_le(bus_->outputs, 0, wanted);
    bus_->exchange();
    bus_->pass(until_sync0() - 1_ns);
    const std::uint64_t before = device_->dictionary().find(0x6040, 0)->value();
    EXPECT_NE(before, wanted);
    bus_->pass(1_ns);
    EXPECT_EQ(device_->dictionary().find(0x6040, 0)->value(), wanted);
    EXPECT_EQ(statusword() & 0x006F, wanted == 7 ? 0x0023 : 0x0021);
    bus_->pass(100_us);
  }
}

TEST_F(Tmc8670WithSync0, CyclicPositionAtOneKilohertz) {
  go_operational_with(1'000'000);
  follow_positions(500, 500);
  EXPECT_NEAR(signal("axis0.shaft_position") * 65'536.0, 250'000.0, 100.0);
  EXPECT_EQ(device_->stack().state(), AlState::operational);
}

TEST_F(Tmc8670WithSync0, CyclicPositionAtFourKilohertz) {
  go_operational_with(250'000);
  follow_positions(1'000, 150);
  EXPECT_NEAR(signal("axis0.shaft_position") * 65'536.0, 150'000.0, 100.0);
  EXPECT_EQ(device_->stack().state(), AlState::operational);
}

TEST_F(Tmc8670WithSync0, TheSyncManagersShowModeAndCycle) {
  go_operational_with(1'000'000);
  EXPECT_EQ(read<std::uint16_t>(0x1C32, 1), 2);
  EXPECT_EQ(read<std::uint32_t>(0x1C32, 2), 1'000'000U);
  EXPECT_EQ(read<std::uint16_t>(0x1C33, 1), 2);
  EXPECT_EQ(read<std::uint32_t>(0x1C33, 2), 1'000'000U);
  const auto pulses = read<std::uint32_t>(0x20F0, 1);
  bus_->pass(100_ms);
  EXPECT_NEAR(read<std::uint32_t>(0x20F0, 1), pulses + 100, 2);
}

TEST_F(Tmc8670WithSync0, MissedOutputsAreForgivenUnlessALimitIsSet) {
  go_operational_with(1'000'000);
  cycle(6, 8, 0);
  bus_->pass(50_ms);
  EXPECT_EQ(device_->stack().state(), AlState::operational);
}

TEST_F(Tmc8670WithSync0, OutputsThatMissTheirSync0TooOftenEndOperational) {
  go_operational_with(1'000'000);
  write<std::uint16_t>(0x10F1, 4, 2);
  for (int k = 0; k < 10; ++k) {
    cycle(6, 8, 0);
  }
  EXPECT_EQ(device_->stack().state(), AlState::operational);
  bus_->pass(1_ms);
  EXPECT_EQ(device_->stack().state(), AlState::operational) << "one is forgiven";
  bus_->pass(1_ms);
  EXPECT_EQ(device_->stack().state(), AlState::safe_operational);
  bus_->pass(1_ms);
  EXPECT_EQ(device_->dictionary().find(0x20F0, 4)->value(), 1U);
  EXPECT_GE(device_->dictionary().find(0x20F0, 3)->value(), 2U);
}

TEST_F(Tmc8670WithSync0, CycleTimesTheFirmwareDoesNotDivideAreRefused) {
  activate_sync0(300'000);
  const auto sync_manager = [](std::uint16_t start, std::uint16_t length, std::uint8_t control) {
    return bytes(std::uint64_t{1} << 48U | std::uint64_t{control} << 32U |
                     std::uint64_t{length} << 16U | start,
                 8);
  };
  const ethercat::DeviceDescription& d = device_->description();
  bus_->write(0x0810, sync_manager(d.output_offset, 13, 0x64));
  bus_->write(0x0818, sync_manager(d.input_offset, 15, 0x20));
  EXPECT_EQ(bus_->request(AlState::safe_operational), 0x12);
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->read(0x0134, 2), 0), 0x36);
}

TEST_F(Tmc8670WithSync0, WhoAsksForSync0HasToActivateIt) {
  bus_->bring_to(AlState::pre_operational);
  write<std::uint16_t>(0x1C32, 2, 1);
  bus_->bring_to(AlState::safe_operational);
  EXPECT_EQ(bus_->request(AlState::operational), 0x14);
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->read(0x0134, 2), 0), 0x30);
}

TEST_F(Tmc8670WithSync0, WhoAsksForItOfTheInputsHasToActivateItToo) {
  bus_->bring_to(AlState::pre_operational);
  write<std::uint16_t>(0x1C33, 2, 1);
  bus_->bring_to(AlState::safe_operational);
  EXPECT_EQ(bus_->request(AlState::operational), 0x14);
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->read(0x0134, 2), 0), 0x30);
  EXPECT_EQ(told_.count("1C33h:01 was set to 2"), 1);
}

TEST_F(Tmc8670WithSync0, WhatAMasterAskedForHoldsUntilInit) {
  bus_->bring_to(AlState::pre_operational);
  write<std::uint16_t>(0x1C32, 2, 1);
  bus_->bring_to(AlState::safe_operational);
  EXPECT_EQ(bus_->request(AlState::operational), 0x14);
  bus_->write(0x0120, {std::byte{0x12}, std::byte{0}});
  EXPECT_EQ(read<std::uint16_t>(0x1C32, 1), 2);
  EXPECT_EQ(bus_->request(AlState::safe_operational), 0x04);
  EXPECT_EQ(bus_->request(AlState::operational), 0x14) << "it is still the same master";
  bus_->write(0x0120, {std::byte{0x11}, std::byte{0}});
  bus_->bring_to(AlState::operational);
  EXPECT_EQ(read<std::uint16_t>(0x1C32, 1), 1);
}

/// How a master runs the chip, from Init on.
struct Tmc8670Master {
  const char* name;
  bool sync0;
  int output_type;  ///< written to 1C32h:01; -1: left alone
  int input_type;   ///< written to 1C33h:01
};

class Tmc8670Masters : public Tmc8670WithSync0 {
 protected:
  static constexpr std::array kMasters{
      Tmc8670Master{"DC, no writes", true, -1, -1},
      Tmc8670Master{"DC, 2 in both", true, 2, 2},
      Tmc8670Master{"DC, 1 in both", true, 1, 1},
      Tmc8670Master{"free run, no writes", false, -1, -1},
      Tmc8670Master{"free run, 0 in both", false, 0, 0},
      Tmc8670Master{"SM-synchronous, 1 in both", false, 1, 1},
      Tmc8670Master{"SM-synchronous, 1 in 1C32h", false, 1, -1},
  };

  /// Init to Operational and back, what the objects show on the way.
  void run(const Tmc8670Master& master, const std::string& after) {
    SCOPED_TRACE(std::string(master.name) + " after " + after);
    bus_->write(0x0120, {std::byte{0x11}, std::byte{0}});
    bus_->write(0x0980, bytes(0, 2));
    bus_->bring_to(AlState::pre_operational);
    EXPECT_EQ(read<std::uint16_t>(0x1C32, 1), 1) << "nothing is left of the one before";
    EXPECT_EQ(read<std::uint16_t>(0x1C33, 1), 1);
    if (master.output_type >= 0) {
      write<std::uint16_t>(0x1C32, static_cast<std::uint16_t>(master.output_type), 1);
    }
    if (master.input_type >= 0) {
      write<std::uint16_t>(0x1C33, static_cast<std::uint16_t>(master.input_type), 1);
    }
    if (master.sync0) {
      const std::uint64_t now = device_->controller().system_time(bus_->now());
      bus_->write(0x0990, bytes(now + 1'000'000, 8));
      bus_->write(0x09A0, bytes(1'000'000, 4));
      bus_->write(0x0980, bytes(0x0300, 2));
    }
    bus_->bring_to(AlState::safe_operational);
    bus_->pass(3_ms);
    bus_->exchange();
    EXPECT_EQ(bus_->request(AlState::operational), 0x08);
    EXPECT_EQ(device_->stack().synchronous(), master.sync0);
    bus_->pass_cyclically(3_ms);
    EXPECT_EQ(read<std::uint16_t>(0x1C32, 1), shown(master, master.output_type));
    EXPECT_EQ(read<std::uint16_t>(0x1C33, 1), shown(master, master.input_type));
    EXPECT_EQ(read<std::uint32_t>(0x1C32, 2), master.sync0 ? 1'000'000U : 0U);
  }
  static int shown(const Tmc8670Master& master, int written) {
    return master.sync0 ? 2 : written >= 0 ? written : 1;
  }
};

TEST_F(Tmc8670Masters, EveryOneFindsTheChipAsAfterPowerOnWhoeverWasThereBefore) {
  for (const Tmc8670Master& first : kMasters) {
    for (const Tmc8670Master& second : kMasters) {
      run(first, "another");
      run(second, first.name);
      run(second, second.name);
    }
  }
}

TEST_F(Tmc8670WithSync0, ACycleChangedInSafeOperationalIsShownAndKept) {
  activate_sync0(1'000'000);
  bus_->bring_to(AlState::safe_operational);
  bus_->pass(5_ms);
  bus_->write(0x0981, bytes(0, 1));
  bus_->write(0x09A0, bytes(2'000'000, 4));
  bus_->write(0x0990, bytes(device_->controller().system_time(bus_->now()) + 2'000'000, 8));
  bus_->write(0x0981, bytes(3, 1));
  bus_->request(AlState::operational);
  bus_->pass(10_ms);
  EXPECT_EQ(device_->stack().state(), AlState::operational);
  EXPECT_EQ(read<std::uint32_t>(0x1C32, 2), 2'000'000U);
  EXPECT_EQ(read<std::uint32_t>(0x1C33, 2), 2'000'000U);
  bus_->pass(100_ms);
  EXPECT_EQ(device_->stack().state(), AlState::operational);
}

TEST_F(Tmc8670WithSync0, SwitchingSync0OffInOperationalStopsTheDrive) {
  go_operational_with(1'000'000);
  bus_->write(0x0981, {std::byte{0}});
  bus_->pass(5_ms);
  EXPECT_EQ(device_->stack().state(), AlState::safe_operational);
  EXPECT_EQ(device_->stack().status_code(), ethercat::AlStatusCode::fatal_sync_error);
}

TEST_F(Tmc8670WithSync0, AnAbsurdCycleTimeInOperationalDoesNotStopTime) {
  go_operational_with(1'000'000);
  bus_->write(0x09A0, bytes(1, 4));
  bus_->pass(20_ms);
  EXPECT_GT(device_->controller().sync_pulse_count(0), 15'000'000U);
  EXPECT_EQ(device_->stack().state(), AlState::operational);
}

TEST_F(Tmc8670WithSync0, TwoRunsAreTheSameToTheLastBit) {
  std::array<double, 2> positions{};
  for (double& position : positions) {
    renew();
    go_operational_with(1'000'000);
    follow_positions(200, 700);
    position = signal("axis0.shaft_position");
  }
  EXPECT_EQ(positions[0], positions[1]);
}

}  // namespace
}  // namespace stator::devices
