// A segment of slaves: source address of returned frames, round trip time, number of slaves.
#include "stator/ethercat/segment/segment.hpp"

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using base::SimTime;
using testing::bytes;
using testing::number;
using testing::TestBus;
using testing::zeros;

TEST(Segment, SourceMac_GetsTheLocallyAdministeredBitAndNothingElse) {
  TestBus bus(3);
  for (const std::uint8_t first : std::array<std::uint8_t, 4>{0x00, 0x01, 0x02, 0x54}) {
    std::array<std::byte, kMaximumFrameLength> buffer{};
    FrameBuilder builder(buffer, {first, 0x11, 0x22, 0x33, 0x44, 0x55});
    builder.append(Command::brd, 0, 0, std::size_t{1});
    const std::span<std::byte> frame = builder.finish();
    ASSERT_TRUE(bus.segment().process(frame, SimTime()));
    EXPECT_EQ(
        testing::Bytes(frame.begin(), frame.begin() + 12),
        bytes({0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, first | 0x02U, 0x11, 0x22, 0x33, 0x44, 0x55}));
  }
}

TEST(Segment, RoundTrip_AddsLineTimeForwardingAndCables) {
  TestBus bus(0);
  bus.add({}, SimDuration(50));
  bus.add({}, SimDuration(100));
  // 60 bytes and 12 around them at 80 ns; both cables twice, the first slave twice, the last twice.
  EXPECT_EQ(bus.segment().round_trip(60), SimDuration(72 * 80 + 300 + 4 * 300 - 300));
}

TEST(Segment, WithoutSlaves_NothingAnswers) {
  TestBus bus(0);
  EXPECT_FALSE(bus.broadcast_read(0x0000, 1).returned);
}

TEST(Segment, HundredSlaves_AllCount) {
  TestBus bus(100);
  EXPECT_EQ(bus.broadcast_read(0x0130, 2).working_counter, 100U);
  EXPECT_EQ(bus.read(99, 0x0000, 1).working_counter, 1U);
}

}  // namespace
}  // namespace stator::ethercat
