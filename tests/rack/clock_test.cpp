#include "stator/rack/world/clock.hpp"

#include <array>
#include <initializer_list>
#include <utility>

#include <gtest/gtest.h>

namespace stator::rack {
namespace {

using namespace base::literals;
using ethercat::Command;

/// A frame with one datagram of 4 bytes per command and address.
class TestFrame {
 public:
  TestFrame(std::initializer_list<std::pair<Command, std::uint32_t>> datagrams) {
    ethercat::FrameBuilder builder(buffer_, {2, 0, 0, 0, 0, 1});
    for (const auto& [command, address] : datagrams) {
      builder.append(command, 0, address, 4);
    }
    frame_ = builder.finish();
  }

  [[nodiscard]] std::span<std::byte> bytes() const { return frame_; }

 private:
  std::array<std::byte, ethercat::kMaximumFrameLength> buffer_{};
  std::span<std::byte> frame_;
};

base::SimDuration elapsed(LockstepClock& clock, const TestFrame& frame) {
  const base::SimTime before = clock.now();
  return clock.on_frame(frame.bytes()) - before;
}

TEST(LockstepClock, StandsStillWithoutFrames) {
  const LockstepClock clock(1_ms, 50_us);
  EXPECT_EQ(clock.now(), base::SimTime());
}

TEST(LockstepClock, OneProcessDataExchangeIsOneCycle) {
  LockstepClock clock(1_ms, 50_us);
  const TestFrame frame{{Command::lrw, 0}};
  EXPECT_EQ(elapsed(clock, frame), 1_ms);
  EXPECT_EQ(elapsed(clock, frame), 1_ms);
}

TEST(LockstepClock, EveryOtherFrameIsOneSmallStep) {
  LockstepClock clock(1_ms, 50_us);
  EXPECT_EQ(elapsed(clock, TestFrame{{Command::brd, 0x01300000}}), 50_us);
  EXPECT_EQ(elapsed(clock, TestFrame{{Command::fpwr, 0x10001001}, {Command::frmw, 0}}), 50_us);
}

TEST(LockstepClock, SeveralLogicalFramesOfOneCycleAreOneCycle) {
  LockstepClock clock(1_ms, 50_us);
  const TestFrame first{{Command::lrw, 0}};
  const TestFrame second{{Command::lrw, 1200}};
  EXPECT_EQ(elapsed(clock, first), 1_ms);
  EXPECT_EQ(elapsed(clock, second), 50_us);
  EXPECT_EQ(elapsed(clock, first), 1_ms);
}

TEST(LockstepClock, ReadAndWriteInSeparateFramesAreOneCycle) {
  LockstepClock clock(1_ms, 50_us);
  const TestFrame write{{Command::lwr, 0}};
  const TestFrame read{{Command::lrd, 0}};
  EXPECT_EQ(elapsed(clock, write), 1_ms);
  EXPECT_EQ(elapsed(clock, read), 50_us);
  EXPECT_EQ(elapsed(clock, write), 1_ms);
}

TEST(LockstepClock, LearnsTheMappingOfARestartedMaster) {
  LockstepClock clock(1_ms, 50_us);
  EXPECT_EQ(elapsed(clock, TestFrame{{Command::lrw, 0}}), 1_ms);
  const TestFrame other{{Command::lrw, 0x10000}};
  for (int i = 0; i < LockstepClock::kForgetAfter; ++i) {
    EXPECT_EQ(elapsed(clock, other), 50_us);
  }
  EXPECT_EQ(elapsed(clock, other), 1_ms);
  EXPECT_EQ(elapsed(clock, other), 1_ms);
}

TEST(LockstepClock, FramesThatAreNoEtherCatAreOneSmallStep) {
  LockstepClock clock(1_ms, 50_us);
  std::array<std::byte, 5> noise{};
  const base::SimTime before = clock.now();
  EXPECT_EQ(clock.on_frame(noise) - before, 50_us);
}

TEST(RealClock, NeverGoesBack) {
  const RealClock clock;
  base::SimTime last = clock.now();
  for (int i = 0; i < 1000; ++i) {
    const base::SimTime now = clock.now();
    EXPECT_GE(now, last);
    last = now;
  }
}

}  // namespace
}  // namespace stator::rack
