// That each kind of event is read from a recording as it was written.
#include "stator/replay/event_coding.hpp"

#include <gtest/gtest.h>

namespace stator::replay {
namespace {

using namespace base::literals;

template <typename Event>
Event passed(const Event& event) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  write_event(writer, event);
  ByteReader reader(bytes);
  const auto read = read_event(reader);
  EXPECT_TRUE(read.has_value());
  EXPECT_TRUE(reader.at_end());
  const Event* got = read ? std::get_if<Event>(&*read) : nullptr;
  EXPECT_NE(got, nullptr);
  return got != nullptr ? *got : Event{};
}

constexpr rack::DeviceAddress kServo{1, 2, rack::NetworkKind::bus};

TEST(EventCoding, GivesBackEveryKindOfEvent) {
  const auto cable = passed(rack::CableEvent{kServo, 3, true});
  EXPECT_EQ(cable.device, kServo);
  EXPECT_EQ(cable.port, 3U);
  EXPECT_TRUE(cable.intact);

  EXPECT_TRUE(passed(rack::PowerEvent{kServo, true}).on);

  const auto input = passed(rack::InputEvent{kServo, "axis0.load_torque", -0.1, false});
  EXPECT_EQ(input.input, "axis0.load_torque");
  EXPECT_EQ(input.value, -0.1);
  EXPECT_FALSE(input.logged);

  EXPECT_EQ(passed(rack::ErrorStateEvent{kServo, can::ErrorState::bus_off}).state,
            can::ErrorState::bus_off);

  rack::FrameFaultEvent can_fault{.bus = 4, .device = 5};
  can_fault.fault = {.kind = can::FrameFaultKind::delay,
                     .frames = 6,
                     .identifier = 0x601,
                     .delay = 7_ms,
                     .probability = 0.5,
                     .seed = 3};
  const auto fault = passed(can_fault);
  EXPECT_EQ(fault.bus, 4U);
  EXPECT_EQ(fault.device, 5U);
  EXPECT_EQ(fault.fault.kind, can::FrameFaultKind::delay);
  EXPECT_EQ(fault.fault.frames, 6U);
  EXPECT_EQ(fault.fault.identifier, 0x601U);
  EXPECT_EQ(fault.fault.delay, 7_ms);
  EXPECT_EQ(fault.fault.probability, 0.5);
  EXPECT_EQ(fault.fault.seed, 3U);
  EXPECT_FALSE(passed(rack::FrameFaultEvent{}).fault.identifier);

  rack::SegmentFaultEvent segment_fault{.segment = 1};
  segment_fault.fault = {.kind = ethercat::FrameFaultKind::corrupt,
                         .port = {2, 1},
                         .leaving = true,
                         .frames = 3,
                         .delay = 9_ms,
                         .probability = 0.25,
                         .seed = 7};
  const auto frames = passed(segment_fault);
  EXPECT_EQ(frames.segment, 1U);
  EXPECT_EQ(frames.fault.kind, ethercat::FrameFaultKind::corrupt);
  EXPECT_EQ(frames.fault.port, (ethercat::SlavePort{2, 1}));
  EXPECT_TRUE(frames.fault.leaving);
  EXPECT_EQ(frames.fault.frames, 3U);
  EXPECT_EQ(frames.fault.delay, 9_ms);
  EXPECT_EQ(frames.fault.probability, 0.25);
  EXPECT_EQ(frames.fault.seed, 7U);
}

TEST(EventCoding, RefusesAnUnknownOrShortEvent) {
  const std::vector<std::byte> unknown{std::byte{99}};
  ByteReader first(unknown);
  EXPECT_FALSE(read_event(first));
  const std::vector<std::byte> cut{std::byte{2}, std::byte{0}};
  ByteReader second(cut);
  EXPECT_FALSE(read_event(second));
}

}  // namespace
}  // namespace stator::replay
