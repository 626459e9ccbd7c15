// Arbitration, frame times, error states and delivery on a CAN bus with a bit rate, and on an
// unlimited one.
#include "stator/can/bus.hpp"

#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/can/frame_length.hpp"

namespace stator::can {
namespace {

using namespace base::literals;
using ::testing::ElementsAre;

constexpr std::uint32_t kRate = 1'000'000;
constexpr BusSettings kUnlimited;

/// A bus with nodes and ports, and a tap that keeps what was on the wire.
class Bench {
 public:
  explicit Bench(const BusSettings& settings = {.bit_rate = kRate}) : bus(settings) {
    bus.set_trace(base::Delegate<void(const TraceEntry&)>::bind<&Bench::on_trace>(*this));
  }

  Controller& add_node(const NodeSettings& settings = {}) {
    nodes.push_back(std::make_unique<Controller>());
    numbers.push_back(bus.add(*nodes.back(), settings));
    return *nodes.back();
  }
  Port& add_port() {
    ports.push_back(std::make_unique<Port>());
    bus.add(*ports.back());
    return *ports.back();
  }
  void run_until(base::SimTime end) {
    do {
      bus.advance(end);
    } while (bus.next_deadline() <= end);
  }
  void run_for(base::SimDuration duration) {
    bus.advance(now);
    run_until(now += duration);
  }

  [[nodiscard]] std::vector<std::uint32_t> identifiers() const {
    std::vector<std::uint32_t> all;
    for (const TraceEntry& entry : trace) {
      if (entry.kind == TraceEntry::Kind::frame) {
        all.push_back(entry.frame.identifier);
      }
    }
    return all;
  }

  base::SimTime now;
  std::vector<TraceEntry> trace;
  std::vector<std::unique_ptr<Controller>> nodes;
  std::vector<std::size_t> numbers;
  std::vector<std::unique_ptr<Port>> ports;
  Bus bus;

 private:
  void on_trace(const TraceEntry& entry) { trace.push_back(entry); }
};

std::vector<std::uint32_t> taken(Controller& node) {
  std::vector<std::uint32_t> all;
  while (const auto frame = node.take()) {
    all.push_back(frame->identifier);
  }
  return all;
}

TEST(CanBus, AFrameReachesAllButItsSenderAtTheEndOfItsLastBit) {
  Bench bench;
  Controller& sender = bench.add_node();
  Controller& listener = bench.add_node();
  Port& port = bench.add_port();
  const Frame frame = data_frame(0x181, {1, 2, 3});
  bench.run_for(1_ms);
  sender.send(frame);
  bench.run_until(base::SimTime(1_ms));
  const base::SimTime end = base::SimTime(1_ms + 1_us * frame_length_in_bits(frame));
  EXPECT_EQ(bench.bus.next_deadline(), end);
  bench.run_until(end - 1_ns);
  EXPECT_FALSE(listener.take());
  bench.run_until(end);
  EXPECT_EQ(listener.take(), frame);
  EXPECT_EQ(port.front()->time, end);
  EXPECT_EQ(port.take()->frame, frame);
  EXPECT_FALSE(sender.take()) << "no echo";
}

TEST(CanBus, FramesPendingAtOnceGoByTheirIdentifier) {
  Bench bench;
  Controller& a = bench.add_node();
  Controller& b = bench.add_node();
  Port& port = bench.add_port();
  a.send(data_frame(0x281, {1}));
  a.send(data_frame(0x081, {2}));
  b.send(data_frame(0x182, {3}));
  port.put(data_frame(0x000, {4}));
  bench.run_for(10_ms);
  EXPECT_THAT(bench.identifiers(), ElementsAre(0x000, 0x182, 0x281, 0x081))
      << "a controller sends in the order of its firmware";
}

TEST(CanBus, AFrameThatComesWhileTheWireIsBusyWaitsForTheIntermission) {
  Bench bench;
  Controller& a = bench.add_node();
  Controller& b = bench.add_node();
  const Frame first = data_frame(0x700, {1});
  const Frame second = data_frame(0x001, {2});
  a.send(first);
  bench.run_for(5_us);
  b.send(second);
  bench.run_for(1_ms);
  ASSERT_EQ(bench.trace.size(), 2U);
  EXPECT_EQ(bench.trace[0].frame, first);
  EXPECT_EQ(bench.trace[1].time - bench.trace[0].time,
            1_us * (frame_length_in_bits(second) + kIntermissionBits));
}

TEST(CanBus, TheSameBitsFromTwoNodesAreOneFrame) {
  Bench bench;
  Controller& a = bench.add_node();
  Controller& b = bench.add_node();
  Controller& listener = bench.add_node();
  a.send(data_frame(0x701, {0}));
  b.send(data_frame(0x701, {0}));
  bench.run_for(1_ms);
  EXPECT_THAT(taken(listener), ElementsAre(0x701));
  EXPECT_TRUE(bench.bus.idle());
  EXPECT_EQ(bench.bus.statistics().error_frames, 0U);
}

TEST(CanBus, DifferentDataUnderOneIdentifierDestroyEachOtherUntilBusOff) {
  Bench bench;
  Controller& a = bench.add_node({.recovery = 1_s});
  Controller& b = bench.add_node({.recovery = 1_s});
  Controller& listener = bench.add_node();
  a.send(data_frame(0x581, {1}));
  b.send(data_frame(0x581, {2}));
  bench.run_for(100_ms);
  EXPECT_EQ(a.error_state(), ErrorState::bus_off);
  EXPECT_EQ(b.error_state(), ErrorState::bus_off);
  EXPECT_EQ(bench.bus.statistics().error_frames, 32U);
  EXPECT_TRUE(taken(listener).empty());
}

TEST(CanBus, PortsWithTheSameIdentifierAreServedInTurn) {
  Bench bench(kUnlimited);
  Controller& node = bench.add_node();
  Port& a = bench.add_port();
  Port& b = bench.add_port();
  for (unsigned i = 0; i < 3; ++i) {
    a.put(data_frame(0x601, {0xA0 + i}));
    b.put(data_frame(0x601, {0xB0 + i}));
  }
  bench.run_for(1_ms);
  std::vector<unsigned> first_bytes;
  while (const auto frame = node.take()) {
    first_bytes.push_back(std::to_integer<unsigned>(frame->data[0]));
  }
  EXPECT_THAT(first_bytes, ElementsAre(0xA0, 0xB0, 0xA1, 0xB1, 0xA2, 0xB2));
  EXPECT_EQ(bench.bus.statistics().error_frames, 0U);
}

TEST(CanBus, Unlimited_FramesTakeNoTimeAndEachIsDeliveredOnItsOwn) {
  Bench bench(kUnlimited);
  Controller& node = bench.add_node({.bit_rate = 125'000});
  Port& port = bench.add_port();
  port.put(data_frame(0x601, {1}));
  port.put(data_frame(0x602, {2}));
  bench.bus.advance(base::SimTime(5_us));
  EXPECT_THAT(taken(node), ElementsAre(0x601)) << "the node may answer before the next one";
  EXPECT_EQ(bench.bus.next_deadline(), base::SimTime(5_us));
  bench.bus.advance(base::SimTime(5_us));
  EXPECT_THAT(taken(node), ElementsAre(0x602));
  EXPECT_EQ(bench.bus.next_deadline(), base::SimTime::never());
}

TEST(CanBus, Unlimited_ABurstOfHundredThousandFramesLosesNone) {
  Bench bench(kUnlimited);
  Port& sender = bench.add_port();
  Port& receiver = bench.add_port();
  constexpr unsigned kFrames = 100'000;
  unsigned put = 0;
  unsigned received = 0;
  while (received < kFrames) {
    while (put < kFrames && sender.room() > 0) {
      sender.put(data_frame(0x100 + put % 16, {put & 0xFFU, put >> 8U & 0xFFU, put >> 16U}));
      ++put;
    }
    bench.run_for(1_us);
    if (receiver.full() || put == kFrames) {  // a client that seldom looks
      while (const auto entry = receiver.take()) {
        EXPECT_EQ(std::to_integer<unsigned>(entry->frame.data[0]), received & 0xFFU);
        ++received;
      }
    }
  }
  EXPECT_EQ(receiver.lost(), 0U);
  EXPECT_EQ(bench.bus.statistics().frames, kFrames);
}

TEST(CanBus, Unlimited_ALossyPortIsNotWaitedFor) {
  Bench bench(kUnlimited);
  Port& sender = bench.add_port();
  Port& deaf = bench.add_port();
  deaf.set_lossy(true);
  constexpr unsigned kFrames = Port::kReceiveBuffer + 10;
  for (unsigned i = 0; i < kFrames; ++i) {
    ASSERT_TRUE(sender.put(data_frame(0x100, {})));
    bench.run_for(1_us);
  }
  EXPECT_EQ(deaf.lost(), 10U);
}

TEST(CanBus, Unlimited_NodesThatAnswerForEverDoNotStopTime) {
  Bench bench(kUnlimited);
  Controller& a = bench.add_node();
  Controller& b = bench.add_node();
  a.send(data_frame(0x100, {}));
  unsigned answers = 0;
  while (bench.bus.next_deadline() <= base::SimTime(1_ms) ||
         bench.bus.next_deadline() == base::SimTime()) {
    bench.bus.advance(base::SimTime(1_ms));
    for (Controller* node : {&a, &b}) {
      while (const auto frame = node->take()) {
        node->send(*frame);
        ++answers;
      }
    }
    ASSERT_LT(answers, 100'000U) << "time stands still";
  }
  EXPECT_GT(answers, Bus::kMaximumAtOneInstant / 2);
}

TEST(CanBus, AcceptanceFilter_KeepsFramesFromNodesThatDoNotWantThem) {
  Bench bench;
  Controller& sender = bench.add_node();
  Controller& choosy = bench.add_node();
  choosy.filter().accept_none();
  choosy.filter().accept(0x601);
  sender.send(data_frame(0x601, {}));
  sender.send(data_frame(0x602, {}));
  Frame extended = data_frame(0x601, {});
  extended.extended = true;
  sender.send(extended);
  sender.send(remote_frame(0x603));
  bench.run_for(1_ms);
  EXPECT_THAT(taken(choosy), ElementsAre(0x601, 0x603)) << "remote frames always pass";
  std::vector<std::size_t> reached;
  bench.bus.take_reached([&](std::size_t member) { reached.push_back(member); });
  EXPECT_THAT(reached, ElementsAre(bench.numbers[1]));
  choosy.filter().accept(0x602);
  choosy.filter().reject(0x601);
  sender.send(data_frame(0x601, {}));
  sender.send(data_frame(0x602, {}));
  bench.run_for(1_ms);
  EXPECT_THAT(taken(choosy), ElementsAre(0x602)) << "changes count at once";
}

TEST(CanBus, Load_IsTheShareOfTheLastSecondInWhichTheWireWasBusy) {
  Bench bench;
  Controller& a = bench.add_node();
  bench.add_node();
  const Frame frame = data_frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8});
  for (int i = 0; i < 1000; ++i) {
    a.send(frame);
    bench.run_for(1_ms);
  }
  EXPECT_NEAR(bench.bus.load(bench.now), 1e-3 * frame_length_in_bits(frame), 2e-4);
  EXPECT_EQ(bench.bus.load(bench.now + 2_s), 0.0);
  EXPECT_EQ(bench.bus.statistics().busy, 1_us * (1000 * frame_length_in_bits(frame)));
}

TEST(CanBus, AFrameThatTheFirmwareTakesBackWhileItIsSentIsNotCountedTwice) {
  Bench bench;
  Controller& a = bench.add_node();
  Controller& listener = bench.add_node();
  a.send(data_frame(0x181, {1}));
  bench.run_for(5_us);
  a.clear();
  a.send(data_frame(0x701, {0}));
  bench.run_for(1_ms);
  EXPECT_THAT(taken(listener), ElementsAre(0x181, 0x701));
}

}  // namespace
}  // namespace stator::can
