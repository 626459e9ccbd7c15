#include <gtest/gtest.h>

#include "error_recorder.hpp"
#include "sdo_client.hpp"

namespace stator::canopen {
namespace {

/// When frames with `identifier` were sent, in ms since `start`.
std::vector<std::int64_t> times_of(const NodeBench& bench, std::uint32_t identifier,
                                   base::SimTime start) {
  std::vector<std::int64_t> times;
  for (std::size_t i = 0; i < bench.transmitter.sent.size(); ++i) {
    if (bench.transmitter.sent[i].identifier == identifier) {
      times.push_back((bench.transmitter.times[i] - start).nanoseconds() / 1'000'000);
    }
  }
  return times;
}

using Times = std::vector<std::int64_t>;

TEST(HeartbeatProducer, WrittenTime_ActsAtOnceAndRepeats) {
  NodeBench bench;
  bench.boot();
  const base::SimTime start = bench.now;
  bench.receive(kRequest, {0x2B, 0x17, 0x10, 0, 100, 0, 0, 0});
  bench.wait(350_ms);
  EXPECT_EQ(times_of(bench, 0x705, start), (Times{0, 100, 200, 300}));
}

TEST(HeartbeatProducer, NewTime_BeginsAnewAndZeroEndsIt) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x2B, 0x17, 0x10, 0, 100, 0, 0, 0});
  bench.wait(150_ms);
  bench.take();
  bench.transmitter.times.clear();
  const base::SimTime start = bench.now;
  bench.receive(kRequest, {0x2B, 0x17, 0x10, 0, 20, 0, 0, 0});
  bench.wait(50_ms);
  EXPECT_EQ(times_of(bench, 0x705, start), (Times{0, 20, 40}));
  ask(bench, {0x2B, 0x17, 0x10, 0, 0, 0, 0, 0});
  bench.wait(1_s);
  EXPECT_EQ(to_text(bench.take()), Texts{});
  EXPECT_EQ(bench.node.next_deadline(), base::SimTime::never());
}

TEST(HeartbeatProducer, TimeThereFromTheBeginning_CountsFromTheBootUp) {
  NodeBench bench;
  bench.set(0x1017, 0, 100);
  bench.node.power_on(bench.now);
  bench.wait(750_ms);
  EXPECT_EQ(times_of(bench, 0x705, base::SimTime()), (Times{500, 600, 700}));
}

TEST(HeartbeatProducer, ReportsTheNmtState) {
  NodeBench bench;
  bench.set(0x1017, 0, 10);
  bench.boot();
  bench.wait(10_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{"705 [7F]"});
  bench.nmt(1);
  bench.wait(10_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{"705 [05]"});
  bench.nmt(2);
  bench.wait(10_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{"705 [04]"});
}

TEST(HeartbeatProducer, LateAdvance_KeepsTheRhythmAndMakesUpForNothing) {
  NodeBench bench;
  bench.set(0x1017, 0, 10);
  bench.boot();
  const base::SimTime start = bench.now;
  bench.node.advance(start + 13_ms);
  EXPECT_EQ(bench.node.next_deadline(), start + 20_ms);
  bench.node.advance(start + 55_ms);
  EXPECT_EQ(bench.take().size(), 2U);
}

TEST(NodeGuarding, AnswerTogglesFromZeroAndCarriesTheState) {
  NodeBench bench;
  bench.boot();
  const auto guard = [&](std::uint8_t length) {
    bench.receive(can::remote_frame(0x705, length));
    return to_text(bench.take());
  };
  EXPECT_EQ(guard(1), Texts{"705 [7F]"});
  EXPECT_EQ(guard(0), Texts{"705 [FF]"});  // whatever length is asked for
  bench.nmt(1);
  EXPECT_EQ(guard(8), Texts{"705 [05]"});
  bench.nmt(2);
  EXPECT_EQ(guard(1), Texts{"705 [84]"});
}

TEST(NodeGuarding, ToggleBeginsAnewWithResetCommunication) {
  NodeBench bench;
  bench.boot();
  bench.receive(can::remote_frame(0x705));
  bench.nmt(130);
  bench.wait(1_ms);
  bench.take();
  bench.receive(can::remote_frame(0x705));
  EXPECT_EQ(to_text(bench.take()), Texts{"705 [7F]"});
}

TEST(NodeGuarding, RequestForAnotherNode_IsNotAnswered) {
  NodeBench bench;
  bench.boot();
  bench.receive(can::remote_frame(0x706));
  EXPECT_EQ(to_text(bench.take()), Texts{});
}

TEST(NodeGuarding, Heartbeat_HasPriorityAndTheRefusalExplainsItself) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x2B, 0x17, 0x10, 0, 0xE8, 0x03, 0, 0});
  bench.receive(can::remote_frame(0x705));
  EXPECT_EQ(to_text(bench.take()), Texts{});
  EXPECT_TRUE(
      bench.events.tells("guarding request for node 5 not answered: it produces a "
                         "heartbeat (1017h = 1000 ms), which has priority"));
  ask(bench, {0x2B, 0x17, 0x10, 0, 0, 0, 0, 0});
  bench.receive(can::remote_frame(0x705));
  EXPECT_EQ(to_text(bench.take()), Texts{"705 [7F]"});
}

/// A node whose life time is 3 * 20 ms.
class LifeGuarding : public testing::Test {
 protected:
  LifeGuarding() {
    errors.connect(bench.node);
    bench.set(0x100C, 0, 20);
    bench.set(0x100D, 0, 3);
    bench.boot();
  }
  void guard() { bench.receive(can::remote_frame(0x705)); }

  NodeBench bench;
  ErrorRecorder errors;
};

TEST_F(LifeGuarding, BeginsWithTheFirstRequest) {
  bench.wait(10_s);
  EXPECT_EQ(errors.log, Texts{});
}

TEST_F(LifeGuarding, MissingRequest_IsAnErrorAfterTheLifeTime) {
  guard();
  bench.wait(base::SimDuration(59'999'999));
  EXPECT_EQ(errors.log, Texts{});
  bench.wait(base::SimDuration(1));
  EXPECT_EQ(errors.log, (Texts{"raise 8130 0 register 10", "reaction"}));
  bench.wait(10_s);
  EXPECT_EQ(errors.log.size(), 2U);
  EXPECT_TRUE(bench.events.tells("no guarding request for node 5 came within 60 ms"));
}

TEST_F(LifeGuarding, RequestsInTime_KeepItQuiet) {
  for (int i = 0; i < 20; ++i) {
    guard();
    bench.wait(59_ms);
  }
  EXPECT_EQ(errors.log, Texts{});
}

TEST_F(LifeGuarding, NextRequest_ClearsTheErrorAndGuardsAgain) {
  guard();
  bench.wait(60_ms);
  errors.log.clear();
  guard();
  EXPECT_EQ(errors.log, Texts{"clear 8130 0"});
  bench.wait(60_ms);
  EXPECT_EQ(errors.log.size(), 3U);
}

TEST_F(LifeGuarding, IsOffWhileOneFactorIsZero_ButRequestsAreAnswered) {
  guard();
  bench.take();
  ask(bench, {0x2F, 0x0D, 0x10, 0, 0, 0, 0, 0});
  bench.wait(10_s);
  EXPECT_EQ(errors.log, Texts{});
  guard();
  EXPECT_EQ(bench.take().size(), 1U);
}

TEST_F(LifeGuarding, NewLifeTime_CountsFromItsWriting) {
  guard();
  bench.wait(50_ms);
  ask(bench, {0x2B, 0x0C, 0x10, 0, 30, 0, 0, 0});
  bench.wait(89_ms);
  EXPECT_EQ(errors.log, Texts{});
  bench.wait(1_ms);
  EXPECT_EQ(errors.log.size(), 2U);
}

TEST_F(LifeGuarding, EndsWhenTheNodeProducesAHeartbeat) {
  guard();
  bench.wait(60_ms);
  errors.log.clear();
  ask(bench, {0x2B, 0x17, 0x10, 0, 100, 0, 0, 0});
  EXPECT_EQ(errors.log, Texts{"clear 8130 0"});
  bench.wait(10_s);
  EXPECT_EQ(errors.log.size(), 1U);
}

TEST_F(LifeGuarding, Emergency_CarriesTheProductsInformation) {
  NodeConfiguration configuration = bench_configuration();
  configuration.life_guard_information = {0, 255, 0, 0, 0};
  NodeBench product(configuration);
  ErrorRecorder recorder;
  recorder.connect(product.node);
  product.set(0x100C, 0, 20);
  product.set(0x100D, 0, 3);
  product.boot();
  product.receive(can::remote_frame(0x705));
  product.wait(60_ms);
  EXPECT_EQ(recorder.information, (std::array<std::uint8_t, 5>{0, 255, 0, 0, 0}));
}

}  // namespace
}  // namespace stator::canopen
