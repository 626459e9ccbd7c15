#include <gtest/gtest.h>

#include "error_recorder.hpp"
#include "sdo_client.hpp"

namespace stator::canopen {
namespace {

/// A node that watches node 10 by 1016h:01 with 100 ms.
class HeartbeatConsumption : public testing::Test {
 protected:
  HeartbeatConsumption() {
    errors.connect(bench.node);
    bench.set(0x1016, 1, 0x000A0064);
    bench.boot();
    bench.nmt(1);
  }
  void heartbeat(unsigned node, unsigned state = 5) { bench.receive(0x700 + node, {state}); }

  NodeBench bench;
  ErrorRecorder errors;
};

TEST_F(HeartbeatConsumption, BeginsWithTheFirstHeartbeatNotBefore) {
  bench.wait(10_s);
  EXPECT_EQ(errors.log, Texts{});
  heartbeat(10);
  bench.wait(base::SimDuration(99'999'999));
  EXPECT_EQ(errors.log, Texts{});
  bench.wait(base::SimDuration(1));
  EXPECT_EQ(errors.log, (Texts{"raise 8130 1 register 10", "reaction"}));
  EXPECT_TRUE(bench.events.tells("heartbeat of node 10 missing for 100 ms"));
}

TEST_F(HeartbeatConsumption, HeartbeatsInTime_AreNoEvent) {
  for (int i = 0; i < 50; ++i) {
    heartbeat(10, i == 0 ? 0 : 127);  // the boot-up message is a heartbeat, too
    bench.wait(99_ms);
  }
  EXPECT_EQ(errors.log, Texts{});
}

TEST_F(HeartbeatConsumption, MissingHeartbeat_IsReportedOnceAndClearedWhenItIsBack) {
  heartbeat(10);
  bench.wait(10_s);
  EXPECT_EQ(errors.log.size(), 2U);
  errors.log.clear();
  heartbeat(10);
  EXPECT_EQ(errors.log, Texts{"clear 8130 1"});
  bench.wait(100_ms);
  EXPECT_EQ(errors.log.size(), 3U);
}

TEST_F(HeartbeatConsumption, OtherNodesRequestsAndMalformedFrames_DoNotCount) {
  heartbeat(10);
  bench.wait(90_ms);
  heartbeat(11);
  bench.receive(can::remote_frame(0x70A));
  bench.receive(0x70A, {5, 5});
  bench.receive(0x70A, {});
  bench.wait(10_ms);
  EXPECT_EQ(errors.log.size(), 2U);
}

TEST_F(HeartbeatConsumption, EachEntry_WatchesOnItsOwn) {
  ask(bench, {0x23, 0x16, 0x10, 2, 0x32, 0x00, 0x0B, 0});
  heartbeat(10);
  heartbeat(11);
  bench.wait(50_ms);
  EXPECT_EQ(errors.log, (Texts{"raise 8130 2 register 10", "reaction"}));
  bench.wait(50_ms);
  EXPECT_EQ(errors.log.size(), 4U);
  EXPECT_EQ(errors.log[2], "raise 8130 1 register 10");
}

TEST_F(HeartbeatConsumption, WritingTheEntry_WaitsForTheFirstHeartbeatAgain) {
  heartbeat(10);
  ask(bench, {0x23, 0x16, 0x10, 1, 0x64, 0x00, 0x0A, 0});
  bench.wait(10_s);
  EXPECT_EQ(errors.log, Texts{});
}

TEST_F(HeartbeatConsumption, WritingTheEntryOfAMissingNode_ClearsTheError) {
  heartbeat(10);
  bench.wait(100_ms);
  errors.log.clear();
  ask(bench, {0x23, 0x16, 0x10, 1, 0, 0, 0, 0});
  EXPECT_EQ(errors.log, Texts{"clear 8130 1"});
}

TEST_F(HeartbeatConsumption, EntryWithoutTimeOrNode_IsNotUsed) {
  for (const std::uint32_t value : {0x000A0000U, 0x00000064U, 0x00800064U}) {
    ask(bench, {0x23, 0x16, 0x10, 1, value & 0xFF, (value >> 8) & 0xFF, (value >> 16) & 0xFF, 0});
    heartbeat(10);
    heartbeat(0);
    bench.wait(1_s);
    EXPECT_EQ(errors.log, Texts{});
  }
}

TEST_F(HeartbeatConsumption, SecondEntryForTheSameNode_IsRefused) {
  EXPECT_EQ(ask(bench, {0x23, 0x16, 0x10, 2, 0x32, 0x00, 0x0A, 0}),
            aborted(0x1016, 2, kIncompatible));
  EXPECT_TRUE(bench.events.tells("node 10 is watched by sub-index 1 already"));
  // The same entry may be written again, and one that is not used does not count.
  EXPECT_EQ(ask(bench, {0x23, 0x16, 0x10, 1, 0x32, 0x00, 0x0A, 0}),
            Texts{"585 [60 16 10 01 00 00 00 00]"});
  EXPECT_EQ(ask(bench, {0x23, 0x16, 0x10, 2, 0x00, 0x00, 0x0A, 0}),
            Texts{"585 [60 16 10 02 00 00 00 00]"});
}

TEST_F(HeartbeatConsumption, ReservedBits_MustBeZero) {
  EXPECT_EQ(ask(bench, {0x23, 0x16, 0x10, 1, 0x64, 0x00, 0x0A, 1}),
            aborted(0x1016, 1, kOutOfRange));
}

TEST_F(HeartbeatConsumption, GoesOnInStopped) {
  heartbeat(10);
  bench.nmt(2);
  bench.wait(90_ms);
  heartbeat(10);
  bench.wait(90_ms);
  EXPECT_EQ(errors.log, Texts{});
  bench.wait(10_ms);
  EXPECT_EQ(errors.log.size(), 2U);
}

TEST_F(HeartbeatConsumption, ResetCommunication_WaitsForTheFirstHeartbeatAgain) {
  heartbeat(10);
  bench.nmt(130);
  bench.wait(10_s);
  EXPECT_EQ(errors.log, Texts{});
}

}  // namespace
}  // namespace stator::canopen
