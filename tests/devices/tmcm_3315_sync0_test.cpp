// The TMCM-3315 synchronised by SYNC0, and masters that switch SYNC0 on, off and wrongly.
#include "devices/tmcm_3315_module.hpp"

namespace stator::devices {
namespace {

class Tmcm3315WithSync0 : public Tmcm3315Module {
 protected:
  /// Safe-Operational with a cycle of 1 ms from 2 ms after the present on.
  void activate_sync0() {
    const auto bytes = [](std::uint64_t value, std::size_t length) {
      tests::TestBus::Bytes result(8);
      base::store_le(result, 0, value);
      result.resize(length);
      return result;
    };
    bus_->bring_to(AlState::pre_operational);
    bus_->write(0x0420, bytes(0, 2));
    const std::uint64_t now = device_->controller().system_time(bus_->now());
    bus_->write(0x0990, bytes(now + 2'000'000, 8));
    bus_->write(0x09A0, bytes(1'000'000, 8));
    bus_->write(0x0980, bytes(0x0300, 2));  // AssignActivate of the mode DC_Sync0
    bus_->bring_to(AlState::safe_operational);
  }
  void go_operational() {
    activate_sync0();
    bus_->pass(3_ms);
    ASSERT_EQ(bus_->request(AlState::operational), 0x08);
  }
  base::SimDuration until_sync0() { return device_->controller().next_sync_edge(0) - bus_->now(); }
  std::uint64_t controlword() { return device_->dictionary().find(0x6040, 0)->value(); }
};

TEST_F(Tmcm3315WithSync0, OutputsAreTakenOverAndInputsGivenAtSync0) {
  go_operational();
  bus_->pass(until_sync0() + 200_us);
  base::store_le(bus_->outputs, 0, std::uint16_t{6});
  bus_->exchange();
  const base::SimDuration rest = until_sync0();
  bus_->pass(rest - 1_ns);
  EXPECT_EQ(controlword(), 0U);
  bus_->pass(1_ns);
  EXPECT_EQ(controlword(), 6U);
  bus_->exchange();
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->inputs, 0) & 0x006F, 0x0021) << "Ready to switch on";
}

TEST_F(Tmcm3315WithSync0, CyclicPositionMovesTheShaftInStepWithSync0) {
  activate_sync0();
  bus_->pass(3_ms);
  write<std::int8_t>(0x6060, 8);
  ASSERT_EQ(bus_->request(AlState::operational), 0x08);
  for (const int controlword : {6, 7, 15}) {
    base::store_le(bus_->outputs, 0, static_cast<std::uint16_t>(controlword));
    bus_->exchange();
    bus_->pass(1_ms);
  }
  for (int k = 1; k <= 1000; ++k) {
    base::store_le(bus_->outputs, 2, std::int32_t{20 * k});
    bus_->exchange();
    bus_->pass(until_sync0() + 100_us);
  }
  bus_->pass(20_ms);
  EXPECT_NEAR(shaft_microsteps(), 20'000.0, 10.0);
  EXPECT_EQ(device_->stack().state(), AlState::operational);
}

TEST_F(Tmcm3315WithSync0, MastersWithAndWithoutSync0ComeInAnyOrder) {
  for (const bool sync0 : {false, true, true, false, false, true}) {
    bus_->write(0x0120, {std::byte{0x11}, std::byte{0}});
    bus_->write(0x0980, tests::TestBus::Bytes(2));
    if (sync0) {
      go_operational();
    } else {
      bus_->write(0x0420, tests::TestBus::Bytes(2));
      bus_->bring_to(AlState::operational);
    }
    EXPECT_EQ(device_->stack().state(), AlState::operational);
    EXPECT_EQ(device_->stack().synchronous(), sync0);
  }
}

TEST_F(Tmcm3315WithSync0, AnAbsurdCycleTimeInOperationalDoesNotStopTime) {
  go_operational();
  bus_->write(0x09A0, {std::byte{1}, std::byte{0}, std::byte{0}, std::byte{0}});
  bus_->pass(100_ms);
  EXPECT_GT(device_->controller().sync_pulse_count(0), 90'000'000U);
  EXPECT_EQ(device_->stack().state(), AlState::operational);
}

TEST_F(Tmcm3315WithSync0, SwitchingSync0OffInOperationalStopsTheModule) {
  go_operational();
  bus_->write(0x0981, {std::byte{0}});
  bus_->pass(5_ms);
  EXPECT_EQ(device_->stack().state(), AlState::safe_operational);
  EXPECT_EQ(device_->stack().status_code(), ethercat::AlStatusCode::fatal_sync_error);
}

}  // namespace
}  // namespace stator::devices
