// A TMCC160 on a CAN bus of a rack.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/bench/local_can_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ::testing::ElementsAre;

const can::Frame kReadDeviceType = can::data_frame(0x601, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});

class Tmcc160Bus : public ::testing::Test {
 protected:
  Tmcc160Bus()
      : configuration_(single_device_rack("tmcc160", devices::products())),
        rack_(configuration_, log_),
        port_(rack_, 0, 1_ms, 50_us) {}

  void wait_until(base::SimDuration moment) { port_.wait(base::SimTime(moment) - port_.now()); }
  [[nodiscard]] std::vector<can::TimedFrame> received() {
    std::vector<can::TimedFrame> frames;
    while (const auto frame = port_.receive()) {
      frames.push_back(*frame);
    }
    return frames;
  }

  EventLog log_;
  RackConfiguration configuration_;
  Rack rack_;
  bench::LocalCanPort port_;
};

TEST_F(Tmcc160Bus, ReportsItsBootUpHalfASecondAfterPowerOnAndAnswers) {
  wait_until(1_s);
  const auto boot_up = received();
  ASSERT_EQ(boot_up.size(), 1U);
  EXPECT_EQ(boot_up[0].frame, can::data_frame(0x701, {0}));
  EXPECT_GE(boot_up[0].time, base::SimTime(500_ms));
  EXPECT_LE(boot_up[0].time, base::SimTime(502_ms));
  port_.send(kReadDeviceType);
  const auto answer = received();
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(answer[0].frame.identifier, 0x581U);
  EXPECT_LE(answer[0].time, port_.now());
}

TEST_F(Tmcc160Bus, FramesWith29BitIdentifiersAreNotForIt) {
  wait_until(1_s);
  static_cast<void>(received());
  can::Frame extended = kReadDeviceType;
  extended.extended = true;
  port_.send(extended);
  extended.identifier <<= 18U;
  port_.send(extended);
  port_.wait(100_ms);
  EXPECT_TRUE(received().empty());
  port_.send(kReadDeviceType);
  EXPECT_EQ(received().size(), 1U);
}

TEST_F(Tmcc160Bus, AfterBusOffOfOneSecondItReports8140) {
  wait_until(1_s);
  static_cast<void>(received());
  rack_.apply(ErrorStateEvent{{0, 0, NetworkKind::bus}, can::ErrorState::bus_off}, port_.now());
  wait_until(1'999_ms);
  EXPECT_TRUE(received().empty());
  wait_until(2'050_ms);
  const auto frames = received();
  ASSERT_EQ(frames.size(), 2U) << "and 0000h, since the error is gone";
  EXPECT_EQ(frames[0].frame.identifier, 0x081U);
  EXPECT_EQ(frames[0].frame.data[0], std::byte{0x40});
  EXPECT_EQ(frames[0].frame.data[1], std::byte{0x81});
  EXPECT_THAT(std::span(frames[0].frame.data).subspan(3),
              ElementsAre(std::byte{0}, std::byte{255}, std::byte{0}, std::byte{0}, std::byte{0}));
}

TEST_F(Tmcc160Bus, AtErrorPassiveItReports8120Once) {
  wait_until(1_s);
  static_cast<void>(received());
  rack_.apply(ErrorStateEvent{{0, 0, NetworkKind::bus}, can::ErrorState::error_passive},
              port_.now());
  wait_until(2_s);
  const auto frames = received();
  ASSERT_EQ(frames.size(), 2U) << "and 0000h, since the error is gone";
  EXPECT_EQ(frames[0].frame.identifier, 0x081U);
  EXPECT_EQ(frames[0].frame.data[0], std::byte{0x20});
  EXPECT_EQ(frames[0].frame.data[1], std::byte{0x81});
}

}  // namespace
}  // namespace stator::rack
