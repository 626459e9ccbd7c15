// The NMT state machine in every state and command (CiA 301 §7.3.2.2), and when a node calls its
// services and hooks.
#include <gtest/gtest.h>

#include "node_bench.hpp"

namespace stator::canopen {
namespace {

const Texts kBootUp{"705 [00]"};

TEST(NmtSlave, PowerOn_IsInInitialisationForTheBootTimeAndSilent) {
  NodeBench bench;
  bench.node.power_on(bench.now);
  EXPECT_EQ(bench.node.next_deadline(), base::SimTime(500_ms));
  bench.wait(base::SimDuration(499'999'999));
  EXPECT_EQ(bench.node.state(), NmtState::initialisation);
  EXPECT_EQ(to_text(bench.take()), Texts{});
}

TEST(NmtSlave, BootUp_IsOneZeroByteAndLeadsToPreOperational) {
  NodeBench bench;
  bench.node.power_on(bench.now);
  bench.wait(500_ms);
  EXPECT_EQ(to_text(bench.take()), kBootUp);
  EXPECT_EQ(bench.node.state(), NmtState::pre_operational);
}

TEST(NmtSlave, BootTime_IsConfigurable) {
  NodeConfiguration configuration = bench_configuration();
  configuration.boot_time = 20_ms;
  NodeBench bench(configuration);
  bench.node.power_on(bench.now);
  bench.wait(20_ms);
  EXPECT_EQ(bench.node.state(), NmtState::pre_operational);
}

TEST(NmtSlave, Initialisation_IgnoresCommandsAndRequests) {
  NodeBench bench;
  bench.node.power_on(bench.now);
  bench.wait(100_ms);
  bench.nmt(1);
  bench.receive(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  bench.receive(can::remote_frame(0x705));
  EXPECT_EQ(bench.node.state(), NmtState::initialisation);
  EXPECT_EQ(to_text(bench.take()), Texts{});
}

/// Case 10 of the conformance test: each transition from each state, seen by the heartbeat.
TEST(NmtSlave, EveryCommand_LeadsFromEveryStateWhereTheStandardSays) {
  struct Command {
    unsigned specifier;
    NmtState target;
  };
  constexpr std::array<Command, 3> kCommands{
      {{1, NmtState::operational}, {2, NmtState::stopped}, {128, NmtState::pre_operational}}};
  for (const Command& from : kCommands) {
    for (const Command& to : kCommands) {
      NodeBench bench;
      bench.set(0x1017, 0, 100);
      bench.boot();
      bench.nmt(from.specifier);
      ASSERT_EQ(bench.node.state(), from.target);
      bench.nmt(to.specifier);
      EXPECT_EQ(bench.node.state(), to.target);
      bench.wait(100_ms);
      const std::vector<can::Frame> sent = bench.take();
      ASSERT_EQ(sent.size(), 1U);
      EXPECT_EQ(sent[0], can::data_frame(0x705, {static_cast<unsigned>(to.target)}));
    }
    for (const unsigned reset : {129U, 130U}) {
      NodeBench bench;
      bench.boot();
      bench.nmt(from.specifier);
      bench.nmt(reset);
      EXPECT_EQ(bench.node.state(), NmtState::initialisation);
      bench.wait(1_ms);
      EXPECT_EQ(to_text(bench.take()), kBootUp);
      EXPECT_EQ(bench.node.state(), NmtState::pre_operational);
    }
  }
}

TEST(NmtSlave, Command_ToAllNodesIsForThisOneToo) {
  NodeBench bench;
  bench.boot().nmt(1, 0);
  EXPECT_EQ(bench.node.state(), NmtState::operational);
}

TEST(NmtSlave, Command_ToAnotherNodeIsNot) {
  NodeBench bench;
  bench.boot().nmt(1, 6);
  EXPECT_EQ(bench.node.state(), NmtState::pre_operational);
}

TEST(NmtSlave, CommandOfWrongLength_IsIgnoredCountedAndExplained) {
  NodeBench bench;
  bench.boot();
  bench.receive(0x000, {1});
  bench.receive(0x000, {1, 5, 0});
  bench.receive(0x000, {});
  EXPECT_EQ(bench.node.state(), NmtState::pre_operational);
  EXPECT_EQ(bench.node.statistics().malformed_nmt, 3U);
  EXPECT_TRUE(bench.events.tells("NMT message ignored: it has 3 bytes, must have 2"));
}

TEST(NmtSlave, UnknownCommand_IsIgnoredCountedAndExplained) {
  NodeBench bench;
  bench.boot();
  for (const unsigned command : {0U, 3U, 80U, 96U, 127U, 131U, 255U}) {
    bench.nmt(command);
    EXPECT_EQ(bench.node.state(), NmtState::pre_operational);
  }
  EXPECT_EQ(bench.node.statistics().unknown_nmt_command, 7U);
  EXPECT_TRUE(bench.events.tells("NMT message ignored: 80 is no command"));
}

TEST(NmtSlave, RemoteAndExtendedFrames_AreNoCommands) {
  NodeBench bench;
  bench.boot();
  bench.receive(can::remote_frame(0x000, 2));
  can::Frame extended = can::data_frame(0x000, {1, 5});
  extended.extended = true;
  bench.receive(extended);
  EXPECT_EQ(bench.node.state(), NmtState::pre_operational);
}

TEST(NmtSlave, Stopped_ObeysNmtAndErrorControlOnly) {
  NodeBench bench;
  bench.set(0x1017, 0, 10);
  bench.boot().nmt(2);
  bench.receive(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(to_text(bench.take()), Texts{});
  bench.wait(10_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{"705 [04]"});
  bench.set(0x1017, 0, 0);
  bench.receive(can::remote_frame(0x705));
  EXPECT_EQ(to_text(bench.take()), Texts{"705 [04]"});
  bench.nmt(128);
  bench.receive(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(to_text(bench.take()), Texts{"585 [43 00 10 00 92 01 02 00]"});
}

TEST(NmtSlave, EachChange_IsTold) {
  NodeBench bench;
  bench.boot().nmt(1);
  EXPECT_TRUE(bench.events.tells("NMT state of node 5: Pre-operational"));
  EXPECT_TRUE(bench.events.tells("NMT state of node 5: Operational"));
}

TEST(NmtSlave, PowerOff_EndsEverythingUntilPowerOn) {
  NodeBench bench;
  bench.set(0x1017, 0, 10);
  bench.boot().nmt(1);
  bench.node.power_off(bench.now);
  EXPECT_EQ(bench.node.next_deadline(), base::SimTime::never());
  bench.nmt(128);
  bench.wait(1_s);
  EXPECT_EQ(bench.node.state(), NmtState::initialisation);
  EXPECT_EQ(to_text(bench.take()), Texts{});
  bench.node.power_on(bench.now);
  bench.wait(500_ms);
  EXPECT_EQ(to_text(bench.take()), kBootUp);
}

TEST(NmtSlave, Enter_ChangesTheStateForTheDeviceButNotInInitialisation) {
  NodeBench bench;
  bench.node.power_on(bench.now);
  bench.node.enter(NmtState::operational, bench.now);
  EXPECT_EQ(bench.node.state(), NmtState::initialisation);
  bench.wait(1_s);
  bench.node.enter(NmtState::operational, bench.now);
  EXPECT_EQ(bench.node.state(), NmtState::operational);
  bench.node.enter(NmtState::initialisation, bench.now);
  EXPECT_EQ(bench.node.state(), NmtState::operational);
}

/// Writes down in which order the node calls.
struct Device {
  Texts calls;
  std::uint8_t node_id = 5;

  void reset_application(base::SimTime) { calls.emplace_back("application"); }
  std::uint8_t reset_communication(base::SimTime) {
    calls.emplace_back("communication");
    return node_id;
  }
  void assign_node_id(std::uint8_t id, base::SimTime) {
    calls.push_back("node-ID " + std::to_string(id));
  }
  void state_changed(NmtState state, base::SimTime) { calls.emplace_back(to_text(state)); }

  NodeHooks hooks() {
    using base::Delegate;
    return {
        .reset_application = Delegate<void(base::SimTime)>::bind<&Device::reset_application>(*this),
        .reset_communication =
            Delegate<std::uint8_t(base::SimTime)>::bind<&Device::reset_communication>(*this),
        .assign_node_id =
            Delegate<void(std::uint8_t, base::SimTime)>::bind<&Device::assign_node_id>(*this),
        .state_changed =
            Delegate<void(NmtState, base::SimTime)>::bind<&Device::state_changed>(*this)};
  }
};

TEST(NmtSlave, PowerOnAndResetNode_ResetApplicationThenCommunication) {
  NodeBench bench;
  Device device;
  bench.node.set_hooks(device.hooks());
  bench.boot();
  EXPECT_EQ(device.calls, (Texts{"application", "communication", "node-ID 5", "Pre-operational"}));
  device.calls.clear();
  bench.nmt(129);
  bench.wait(1_ms);
  EXPECT_EQ(device.calls, (Texts{"Initialisation", "application", "communication", "node-ID 5",
                                 "Pre-operational"}));
}

TEST(NmtSlave, ResetCommunication_LeavesTheApplicationAlone) {
  NodeBench bench;
  Device device;
  bench.node.set_hooks(device.hooks());
  bench.boot();
  device.calls.clear();
  bench.nmt(130);
  bench.wait(1_ms);
  EXPECT_EQ(device.calls,
            (Texts{"Initialisation", "communication", "node-ID 5", "Pre-operational"}));
}

TEST(NmtSlave, NodeId_ChangesWithResetCommunication) {
  NodeBench bench;
  Device device;
  bench.node.set_hooks(device.hooks());
  bench.boot();
  device.node_id = 9;
  bench.nmt(1);
  EXPECT_EQ(bench.node.node_id(), 5);
  bench.nmt(130);
  bench.wait(1_ms);
  EXPECT_EQ(bench.node.node_id(), 9);
  EXPECT_EQ(to_text(bench.take()), Texts{"709 [00]"});
  bench.nmt(1, 5);
  EXPECT_EQ(bench.node.state(), NmtState::pre_operational);
  bench.receive(0x609, {0x40, 0x00, 0x12, 1, 0, 0, 0, 0});
  EXPECT_EQ(to_text(bench.take()), Texts{"589 [43 00 12 01 09 06 00 00]"});
}

TEST(NmtSlave, ForbiddenNodeId_KeepsTheNodeSilentAndSaysSo) {
  for (const unsigned node_id : {0U, 128U, 254U, 255U}) {
    NodeConfiguration configuration = bench_configuration();
    configuration.node_id = static_cast<std::uint8_t>(node_id);
    NodeBench bench(configuration);
    bench.node.power_on(bench.now);
    bench.wait(2_s);
    EXPECT_EQ(bench.node.state(), NmtState::initialisation);
    EXPECT_EQ(bench.node.node_id(), kUnconfiguredNodeId);
    EXPECT_EQ(to_text(bench.take()), Texts{});
    EXPECT_TRUE(bench.events.tells("the node has no node-ID and stays silent"));
  }
}

/// A service as another part of a device adds it.
class Probe final : public Service {
 public:
  void start(base::SimTime) override { calls.emplace_back("start"); }
  void on_state(NmtState state, base::SimTime) override { calls.emplace_back(to_text(state)); }
  bool receive(const can::Frame& frame, base::SimTime) override {
    ++asked;
    if (frame.identifier != listens_to) {
      return false;
    }
    calls.emplace_back("frame");
    return true;
  }
  void advance(base::SimTime) override {
    calls.emplace_back("advance");
    deadline = base::SimTime::never();
  }
  [[nodiscard]] base::SimTime next_deadline() const override { return deadline; }
  void set_deadline(base::SimTime time) {
    deadline = time;
    deadline_changed();
  }

  Texts calls;
  std::uint32_t listens_to = 0x205;
  int asked = 0;
  base::SimTime deadline = base::SimTime::never();
};

TEST(NodeService, StartsBeforeTheBootUpAndHearsEveryState) {
  NodeBench bench;
  Probe probe;
  bench.node.add(probe);
  bench.boot();
  bench.nmt(1);
  bench.nmt(2);
  bench.nmt(130);
  EXPECT_EQ(probe.calls,
            (Texts{"start", "Pre-operational", "Operational", "Stopped", "Initialisation"}));
}

TEST(NodeService, GetsFramesInPreOperationalAndOperationalOnly) {
  NodeBench bench;
  Probe probe;
  bench.node.add(probe);
  bench.boot();
  const auto frames_taken = [&] {
    probe.calls.clear();
    bench.receive(0x205, {1});
    return probe.calls.size();
  };
  EXPECT_EQ(frames_taken(), 1U);
  bench.nmt(1);
  EXPECT_EQ(frames_taken(), 1U);
  bench.nmt(2);
  EXPECT_EQ(frames_taken(), 0U);
}

TEST(NodeService, IsAskedOnceAboutAnIdentifierNobodyTakes) {
  NodeBench bench;
  Probe probe;
  bench.node.add(probe);
  bench.boot();
  for (int i = 0; i < 3; ++i) {
    bench.receive(0x181, {1, 2});
  }
  EXPECT_EQ(probe.asked, 1);
  EXPECT_EQ(bench.node.statistics().ignored, 3U);
  EXPECT_EQ(bench.node.statistics().received, 3U);
}

TEST(NodeService, IsAskedAgainWhenStateOrCommunicationObjectsHaveChanged) {
  NodeBench bench;
  Probe probe;
  bench.node.add(probe);
  bench.boot();
  bench.receive(0x181, {1});
  bench.nmt(1);
  bench.receive(0x181, {1});
  EXPECT_EQ(probe.asked, 2);
  bench.receive(0x605, {0x2F, 0x00, 0x20, 0, 4, 0, 0, 0});
  bench.receive(0x181, {1});
  EXPECT_EQ(probe.asked, 3);
  bench.node.communication_objects_changed();
  bench.receive(0x181, {1});
  EXPECT_EQ(probe.asked, 4);
}

TEST(NodeService, IsAdvancedAtItsDeadlineAlsoIfItSetThatOnItsOwn) {
  NodeBench bench;
  Probe probe;
  bench.node.add(probe);
  bench.boot();
  EXPECT_EQ(bench.node.next_deadline(), base::SimTime::never());
  probe.set_deadline(bench.now + 3_ms);
  EXPECT_EQ(bench.node.next_deadline(), bench.now + 3_ms);
  probe.calls.clear();
  bench.wait(2_ms);
  EXPECT_EQ(probe.calls, Texts{});
  bench.wait(1_ms);
  EXPECT_EQ(probe.calls, Texts{"advance"});
}

/// Takes every frame with identifier 123h.
struct Listener final : Service {
  void start(base::SimTime /*now*/) override {}
  bool receive(const can::Frame& frame, base::SimTime /*now*/) override {
    frames += frame.identifier == 0x123 ? 1 : 0;
    return frame.identifier == 0x123;
  }
  int frames = 0;
};

TEST(NmtSlave, ServicesOfTheDeviceHearNothingInStopped) {
  // CiA 301 §7.3.2.2.4: NMT, error control and LSS are all that is left.
  Listener listener;
  NodeBench bench;
  bench.node.add(listener);
  bench.boot();
  bench.receive(0x123, {1});
  EXPECT_EQ(listener.frames, 1);
  bench.nmt(2);
  bench.receive(0x123, {1});
  EXPECT_EQ(listener.frames, 1);
  bench.nmt(1);
  bench.receive(0x123, {1});
  EXPECT_EQ(listener.frames, 2);
}

TEST(NmtSlave, CommandsDuringInitialisationCountAsIgnored) {
  NodeBench bench;
  bench.boot();
  bench.nmt(130);
  const std::uint64_t before = bench.node.statistics().ignored;
  bench.nmt(1);
  EXPECT_EQ(bench.node.statistics().ignored, before + 1);
}

TEST(NmtSlave, AWrongIdentityIsTheOneIn1018hAlsoAfterAReset) {
  NodeConfiguration configuration = bench_configuration();
  configuration.quirks.wrong_product = 0xBAD;
  NodeBench bench(configuration);
  bench.boot();
  bench.dictionary.reset_values();
  EXPECT_EQ(bench.value(0x1018, 1), 0x286U) << "only what was asked for is wrong";
  EXPECT_EQ(bench.value(0x1018, 2), 0xBADU);
  EXPECT_EQ(bench.value(0x1018, 3), 0x30000U);
}

}  // namespace
}  // namespace stator::canopen
