// Errors, error states and faults of a bus.

#include <memory>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/can/bus.hpp"
#include "stator/can/frame_length.hpp"

namespace stator::can {
namespace {

using namespace base::literals;
using ::testing::ElementsAre;

constexpr std::uint32_t kRate = 500'000;

class Events final : public base::EventSink {
 public:
  void on_event(const base::Event& event) override { ids.push_back(event.rule->id); }
  std::vector<std::string_view> ids;
};

class BusFaults : public ::testing::Test {
 protected:
  BusFaults() { start({.bit_rate = kRate, .ports_acknowledge = false}); }

  void start(const BusSettings& settings) {
    bus = std::make_unique<Bus>(settings);
    const NodeSettings node{.bit_rate = kRate, .reporter = base::EventReporter(&events, 0)};
    a = bus->add(drive, node);
    b = bus->add(other, node);
  }
  void run_for(base::SimDuration duration) {
    bus->advance(now);
    now += duration;
    do {
      bus->advance(now);
    } while (bus->next_deadline() <= now);
  }
  std::vector<unsigned> received() {
    std::vector<unsigned> all;
    while (const auto frame = other.take()) {
      all.push_back(frame->identifier);
    }
    return all;
  }

  base::SimTime now;
  Events events;
  Controller drive;
  Controller other;
  Controller third;
  std::unique_ptr<Bus> bus;
  std::size_t a = 0;
  std::size_t b = 0;
};

TEST_F(BusFaults, ALoneNodeGetsNoAcknowledgeAndBecomesErrorPassiveButNeverBusOff) {
  bus->set_connected(b, false);
  drive.send(data_frame(0x701, {0}));
  run_for(1_s);
  EXPECT_EQ(drive.error_state(), ErrorState::error_passive);
  EXPECT_EQ(bus->errors(a).transmit(), 128U);
  EXPECT_GT(bus->statistics(a).not_acknowledged, 1000U);
  EXPECT_THAT(events.ids, ElementsAre("can-error-passive"));
  bus->set_connected(b, true);
  run_for(1_ms);
  EXPECT_THAT(received(), ElementsAre(0x701)) << "sent again and again until somebody is there";
  EXPECT_EQ(drive.error_state(), ErrorState::error_active) << "127 after one success";
}

TEST_F(BusFaults, APortAcknowledgesUnlessToldOtherwise) {
  for (const bool acknowledge : {true, false}) {
    Controller lone;
    Port port;
    Bus own({.bit_rate = kRate, .ports_acknowledge = acknowledge});
    const std::size_t member = own.add(lone, {.bit_rate = kRate});
    own.add(port);
    lone.send(data_frame(0x701, {0}));
    own.advance(base::SimTime());
    own.advance(base::SimTime(1_ms));
    EXPECT_EQ(own.errors(member).transmit(), acknowledge ? 0U : 8U);
    EXPECT_EQ(port.take().has_value(), acknowledge);
  }
}

TEST_F(BusFaults, Corrupt_CostsAnErrorFrameAndTheFrameIsSentAgain) {
  bus->inject({.kind = FrameFaultKind::corrupt, .frames = 2});
  const Frame frame = data_frame(0x181, {1});
  drive.send(frame);
  run_for(10_ms);
  EXPECT_THAT(received(), ElementsAre(0x181));
  EXPECT_EQ(bus->statistics().error_frames, 2U);
  EXPECT_EQ(bus->errors(a).transmit(), 15U) << "8 and 8, less one";
  EXPECT_EQ(bus->errors(b).receive(), 1U) << "1 and 1, less one";
}

TEST_F(BusFaults, Corrupt_IsHeardByPortsThatAskForIt_AlsoOfTheirOwnFrames) {
  for (const BusSettings& settings : {BusSettings{.bit_rate = kRate}, BusSettings{}}) {
    start(settings);
    Port curious;
    Port deaf;
    curious.set_hears_errors(true);
    bus->add(curious);
    bus->add(deaf);
    bus->inject({.kind = FrameFaultKind::corrupt, .frames = 2});
    curious.put(data_frame(0x100, {}));
    drive.send(data_frame(0x181, {1}));
    run_for(10_ms);
    std::vector<std::pair<unsigned, bool>> heard;
    while (const auto entry = curious.take()) {
      heard.emplace_back(entry->frame.identifier, entry->destroyed);
    }
    EXPECT_THAT(heard, ElementsAre(std::pair(0x100U, true), std::pair(0x100U, true),
                                   std::pair(0x181U, false)));
    EXPECT_EQ(deaf.waiting(), 2U) << "the frames only";
    bus.reset();
  }
}

TEST_F(BusFaults, Corrupt_AnErrorFrameOf14BitsTakesThePlaceOfTheEndOfFrame) {
  std::vector<base::SimTime> ends;
  struct Tap {
    std::vector<base::SimTime>& ends;
    void on(const TraceEntry& entry) { ends.push_back(entry.time); }
  } tap{ends};
  bus->set_trace(base::Delegate<void(const TraceEntry&)>::bind<&Tap::on>(tap));
  bus->inject({.kind = FrameFaultKind::corrupt});
  const Frame frame = data_frame(0x181, {1});
  drive.send(frame);
  run_for(10_ms);
  ASSERT_EQ(ends.size(), 2U);
  EXPECT_EQ(ends[1].since_power_on(),
            2_us * (2 * frame_length_in_bits(frame) - 7 + kErrorFrameBits + kIntermissionBits));
}

TEST_F(BusFaults, ThirtyTwoFailuresInARowAreBusOffAndTheNodeRecoversWithCountersOfZero) {
  bus->inject({.kind = FrameFaultKind::corrupt, .frames = 32});
  drive.send(data_frame(0x181, {1}));
  drive.send(data_frame(0x182, {1}));
  run_for(6_ms);
  EXPECT_EQ(drive.error_state(), ErrorState::bus_off);
  EXPECT_FALSE(drive.send(data_frame(0x183, {}))) << "nothing can be sent meanwhile";
  EXPECT_EQ(bus->statistics(a).bus_offs, 1U);
  run_for(128_us * 11 * 2 + 6_ms);
  EXPECT_EQ(drive.error_state(), ErrorState::error_active);
  EXPECT_EQ(bus->errors(a).transmit(), 0U);
  EXPECT_TRUE(received().empty()) << "what waited is forgotten";
  EXPECT_THAT(events.ids, ElementsAre("can-error-passive", "can-bus-off", "can-recovered"));
}

TEST_F(BusFaults, BusOff_EndsAfterTheProductsOwnTime) {
  bus = std::make_unique<Bus>(BusSettings{.bit_rate = kRate});
  a = bus->add(drive, {.bit_rate = kRate, .recovery = 1_s});
  run_for(1_ms);
  bus->force_bus_off(a, now);
  EXPECT_EQ(drive.error_state(), ErrorState::bus_off);
  run_for(0_ms);
  EXPECT_EQ(bus->next_deadline(), now + 1_s);
  run_for(999_ms);
  EXPECT_EQ(drive.error_state(), ErrorState::bus_off);
  run_for(1_ms);
  EXPECT_EQ(drive.error_state(), ErrorState::error_active);
}

TEST_F(BusFaults, ErrorStatesReachTheNodesFirmware) {
  bus->force_error_passive(a, now);
  std::vector<std::size_t> reached;
  bus->take_reached([&](std::size_t member) { reached.push_back(member); });
  EXPECT_THAT(reached, ElementsAre(a));
  EXPECT_EQ(drive.error_state(), ErrorState::error_passive);
  drive.send(data_frame(0x181, {}));
  run_for(1_ms);
  EXPECT_EQ(drive.error_state(), ErrorState::error_active);
}

TEST_F(BusFaults, Drop_IsNotNoticedByTheSender) {
  bus->inject({.kind = FrameFaultKind::drop});
  drive.send(data_frame(0x181, {}));
  drive.send(data_frame(0x182, {}));
  run_for(10_ms);
  EXPECT_THAT(received(), ElementsAre(0x182));
  EXPECT_EQ(bus->statistics(a).sent, 2U);
  EXPECT_EQ(bus->statistics().frames_dropped, 1U);
  EXPECT_EQ(bus->statistics().error_frames, 0U);
}

TEST_F(BusFaults, Duplicate_ComesTwice) {
  bus->inject({.kind = FrameFaultKind::duplicate});
  drive.send(data_frame(0x181, {}));
  drive.send(data_frame(0x182, {}));
  run_for(10_ms);
  EXPECT_THAT(received(), ElementsAre(0x181, 0x181, 0x182));
}

TEST_F(BusFaults, Delay_HoldsTheSenderBackAndLetsOthersPass) {
  bus->inject({.kind = FrameFaultKind::delay, .sender = a, .delay = 5_ms});
  bus->add(third, {.bit_rate = kRate});
  drive.send(data_frame(0x081, {}));
  third.send(data_frame(0x701, {}));
  run_for(4_ms);
  EXPECT_THAT(received(), ElementsAre(0x701));
  run_for(2_ms);
  EXPECT_THAT(received(), ElementsAre(0x081));
}

TEST_F(BusFaults, AFaultHitsOnlyWhatItNames) {
  bus->inject({.kind = FrameFaultKind::drop, .frames = 1, .sender = a, .identifier = 0x182});
  other.send(data_frame(0x182, {}));
  drive.send(data_frame(0x181, {}));
  run_for(1_ms);
  drive.send(data_frame(0x182, {}));
  run_for(1_ms);
  drive.send(data_frame(0x182, {}));
  run_for(1_ms);
  EXPECT_THAT(received(), ElementsAre(0x181, 0x182));
  EXPECT_EQ(drive.take()->identifier, 0x182U);
}

TEST_F(BusFaults, ANodeWithAnotherBitRateHearsNothingAndDisturbsUntilItIsErrorPassive) {
  const std::size_t w =
      bus->add(third, {.bit_rate = 125'000, .reporter = base::EventReporter(&events, 1)});
  EXPECT_THAT(events.ids, ElementsAre("can-bit-rate-differs"));
  drive.send(data_frame(0x181, {}));
  run_for(50_ms);
  EXPECT_THAT(received(), ElementsAre(0x181)) << "in the end";
  EXPECT_FALSE(third.take());
  EXPECT_EQ(third.error_state(), ErrorState::error_passive);
  EXPECT_EQ(bus->statistics().error_frames, 15U) << "128 / 9";
  third.send(data_frame(0x001, {}));
  run_for(50_ms);
  EXPECT_EQ(bus->statistics(w).sent, 0U);
  EXPECT_EQ(bus->statistics(w).bus_offs, 1U) << "its own frames are noise to all others";
  bus->set_bit_rate(w, kRate);
  run_for(50_ms);
  drive.send(data_frame(0x182, {}));
  run_for(1_ms);
  EXPECT_EQ(third.take()->identifier, 0x182U);
}

TEST_F(BusFaults, ADisconnectedNodeHearsNothingAndItsFrameIsCutOff) {
  drive.send(data_frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8}));
  run_for(10_us);
  bus->set_connected(a, false);
  other.send(data_frame(0x701, {}));
  run_for(1_ms);
  EXPECT_TRUE(received().empty());
  EXPECT_FALSE(drive.take());
  bus->set_connected(a, true);
  run_for(1_ms);
  EXPECT_THAT(received(), ElementsAre(0x181)) << "tried again when it is back";
  EXPECT_EQ(drive.take()->identifier, 0x701U);
}

TEST_F(BusFaults, ANodeWithoutPowerBeginsAnew) {
  bus->force_error_passive(a, now);
  drive.send(data_frame(0x181, {}));
  bus->set_power(a, false);
  run_for(1_ms);
  EXPECT_TRUE(received().empty());
  bus->set_power(a, true);
  run_for(1_ms);
  EXPECT_TRUE(received().empty()) << "its buffers are empty";
  EXPECT_EQ(bus->errors(a).transmit(), 0U);
  EXPECT_EQ(drive.error_state(), ErrorState::error_active);
}

}  // namespace
}  // namespace stator::can
