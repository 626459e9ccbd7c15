// Every service of LSS (CiA 305), from switching over configuration and storing to fastscan.
#include <gtest/gtest.h>

#include "sdo_client.hpp"

namespace stator::canopen {
namespace {

constexpr std::uint32_t kVendor = 0x286;
constexpr std::uint32_t kProduct = 0xA0;
constexpr std::uint32_t kRevision = 0x30000;
constexpr std::uint32_t kSerial = 0x12345678;

/// What the device does for LSS.
struct Memory {
  bool supports(std::uint32_t bit_rate) { return bit_rate != 10'000; }
  void activate(std::uint32_t bit_rate, base::SimTime now) {
    activated = bit_rate;
    activated_at = now;
  }
  bool store(std::optional<std::uint8_t> node_id, std::optional<std::uint32_t> bit_rate) {
    ++orders;
    stored_node_id = node_id.value_or(stored_node_id);
    stored_bit_rate = bit_rate.value_or(0);
    return works;
  }

  LssHooks hooks() {
    using base::Delegate;
    return {
        .supports = Delegate<bool(std::uint32_t)>::bind<&Memory::supports>(*this),
        .activate = Delegate<void(std::uint32_t, base::SimTime)>::bind<&Memory::activate>(*this),
        .store = Delegate<bool(std::optional<std::uint8_t>,
                               std::optional<std::uint32_t>)>::bind<&Memory::store>(*this)};
  }

  bool works = true;
  std::uint32_t activated = 0;
  base::SimTime activated_at;
  int orders = 0;
  std::uint8_t stored_node_id = 5;
  std::uint32_t stored_bit_rate = 0;
};

NodeConfiguration lss_configuration(std::uint8_t node_id) {
  NodeConfiguration configuration = bench_configuration();
  configuration.node_id = node_id;
  configuration.lss = LssConfiguration{.serial_number = kSerial};
  return configuration;
}

/// A node with LSS and the master's moves.
class LssBench : public NodeBench {
 public:
  explicit LssBench(std::uint8_t node_id = NodeBench::kNodeId)
      : NodeBench(lss_configuration(node_id)) {
    boot();
  }

  Texts command(unsigned specifier, std::uint32_t value = 0, unsigned b5 = 0, unsigned b6 = 0,
                unsigned b7 = 0) {
    receive(0x7E5, {specifier, value & 0xFF, (value >> 8) & 0xFF, (value >> 16) & 0xFF, value >> 24,
                    b5, b6, b7});
    return to_text(take());
  }
  void configuration_state() { EXPECT_EQ(command(4, 1), Texts{}); }
  void waiting_state() { EXPECT_EQ(command(4, 0), Texts{}); }
  Texts select(std::uint32_t vendor, std::uint32_t product, std::uint32_t revision,
               std::uint32_t serial) {
    Texts answers;
    const std::array<std::uint32_t, 4> parts{vendor, product, revision, serial};
    for (unsigned i = 0; i < parts.size(); ++i) {
      for (const std::string& answer : command(64 + i, parts[i])) {
        answers.push_back(answer);
      }
    }
    return answers;
  }
};

Texts answer(unsigned command, std::uint32_t value = 0) {
  return {to_text(can::data_frame(0x7E4, {command, value & 0xFF, (value >> 8) & 0xFF,
                                          (value >> 16) & 0xFF, value >> 24, 0, 0, 0}))};
}

TEST(LssSlave, IsThereOnlyWhereConfigured) {
  NodeBench bench;
  bench.boot();
  bench.receive(0x7E5, {4, 1, 0, 0, 0, 0, 0, 0});
  bench.receive(0x7E5, {94, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(to_text(bench.take()), Texts{});
}

TEST(LssSlave, Waiting_IgnoresConfigurationAndInquiries) {
  LssBench bench;
  for (const unsigned specifier : {17U, 19U, 21U, 23U, 90U, 91U, 92U, 93U, 94U}) {
    EXPECT_EQ(bench.command(specifier), Texts{});
  }
}

TEST(LssSlave, Inquiries_TellTheAddressAndTheNodeId) {
  LssBench bench;
  bench.configuration_state();
  EXPECT_EQ(bench.command(90), answer(90, kVendor));
  EXPECT_EQ(bench.command(91), answer(91, kProduct));
  EXPECT_EQ(bench.command(92), answer(92, kRevision));
  EXPECT_EQ(bench.command(93), answer(93, kSerial));
  EXPECT_EQ(bench.command(94), answer(94, 5));
  bench.waiting_state();
  EXPECT_EQ(bench.command(94), Texts{});
}

TEST(LssSlave, SwitchSelective_AnswersTheLastOfFourMatchingParts) {
  LssBench bench;
  EXPECT_EQ(bench.select(kVendor, kProduct, kRevision, kSerial), answer(68));
  EXPECT_EQ(bench.command(94), answer(94, 5));
}

TEST(LssSlave, SwitchSelective_LeavesOthersInWaiting) {
  LssBench bench;
  EXPECT_EQ(bench.select(kVendor + 1, kProduct, kRevision, kSerial), Texts{});
  EXPECT_EQ(bench.select(kVendor, kProduct + 1, kRevision, kSerial), Texts{});
  EXPECT_EQ(bench.select(kVendor, kProduct, kRevision + 1, kSerial), Texts{});
  EXPECT_EQ(bench.select(kVendor, kProduct, kRevision, kSerial + 1), Texts{});
  bench.command(64, kVendor);
  EXPECT_EQ(bench.command(67, kSerial), Texts{});
  EXPECT_EQ(bench.command(94), Texts{});
}

TEST(LssSlave, ConfiguredNodeId_ActsAfterResetCommunication) {
  LssBench bench;
  bench.configuration_state();
  EXPECT_EQ(bench.command(17, 33), answer(17, 0));
  EXPECT_EQ(bench.command(94), answer(94, 5));
  bench.waiting_state();
  EXPECT_EQ(bench.node.node_id(), 5);
  bench.nmt(130);
  bench.wait(1_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{"721 [00]"});
  EXPECT_EQ(bench.node.node_id(), 33);
}

TEST(LssSlave, ConfiguredNodeIdThatWasNotStored_IsForgottenWithoutSupply) {
  LssBench bench;
  bench.configuration_state();
  bench.command(17, 33);
  bench.node.power_off(bench.now);
  bench.node.power_on(bench.now);
  bench.wait(500_ms);
  EXPECT_EQ(bench.node.node_id(), 5);
}

TEST(LssSlave, ConfiguredNodeIdThatWasNotStored_LastsUntilResetNode) {
  LssBench bench;
  bench.configuration_state();
  bench.command(17, 33);
  for (int time = 1; time <= 2; ++time) {
    bench.nmt(130, bench.node.node_id());
    bench.wait(1_ms);
    EXPECT_EQ(bench.node.node_id(), 33) << "reset communication " << time;
  }
  bench.take();
  bench.nmt(129, 33);
  bench.wait(1_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{"705 [00]"}) << "reset node takes the one stored";
  EXPECT_EQ(bench.node.node_id(), 5);
}

TEST(LssSlave, NodeIdStoredByTheDeviceItself_ReplacesAConfiguredOne) {
  LssBench bench;
  struct Device {
    std::uint8_t reset(base::SimTime /*now*/) { return node_id; }
    std::uint8_t node_id = 5;
  } device;
  NodeHooks hooks;
  hooks.reset_communication =
      base::Delegate<std::uint8_t(base::SimTime)>::bind<&Device::reset>(device);
  bench.node.set_hooks(hooks);
  bench.configuration_state();
  bench.command(17, 33);
  device.node_id = 9;
  bench.node.stored_node_id_changed();
  bench.nmt(130);
  bench.wait(1_ms);
  EXPECT_EQ(bench.node.node_id(), 9);
}

TEST(LssSlave, StoringWithoutANodeId_KeepsTheNodeSilentUntilItIsGivenOne) {
  LssBench bench;
  Memory memory;
  bench.node.set_lss_hooks(memory.hooks());
  bench.configuration_state();
  EXPECT_EQ(bench.command(17, 255), answer(17, 0));
  EXPECT_EQ(bench.command(23), answer(23, 0));
  EXPECT_EQ(memory.stored_node_id, 255U);
  bench.nmt(130);
  bench.wait(1_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{});
  EXPECT_EQ(bench.command(76), answer(80)) << "it tells that it has none";
}

TEST(LssSlave, NodeIdOutOfRange_IsRefusedWithError1) {
  LssBench bench;
  bench.configuration_state();
  for (const unsigned node_id : {0U, 128U, 254U}) {
    EXPECT_EQ(bench.command(17, node_id), answer(17, 1));
  }
  EXPECT_TRUE(bench.events.tells("LSS configure node-ID refused: 128 came"));
  EXPECT_EQ(bench.command(17, 127), answer(17, 0));
  EXPECT_EQ(bench.command(17, 255), answer(17, 0));
}

TEST(LssSlave, BitTiming_IsTakenFromTheStandardTableAsFarAsTheDeviceSupportsIt) {
  LssBench bench;
  Memory memory;
  bench.node.set_lss_hooks(memory.hooks());
  bench.configuration_state();
  for (const unsigned index : {0U, 1U, 2U, 3U, 4U, 6U, 7U}) {
    EXPECT_EQ(bench.command(19, index << 8), answer(19, 0)) << index;
  }
  for (const unsigned index : {5U, 8U, 9U, 255U}) {  // reserved, 10 kbit/s, not in the table
    EXPECT_EQ(bench.command(19, index << 8), answer(19, 1)) << index;
  }
  EXPECT_EQ(bench.command(19, 0x0001), answer(19, 1));  // another table
}

TEST(LssSlave, ActivatedBitTiming_ActsAfterTheSwitchDelay) {
  LssBench bench;
  Memory memory;
  bench.node.set_lss_hooks(memory.hooks());
  bench.configuration_state();
  bench.command(19, 2 << 8);
  EXPECT_EQ(memory.activated, 0U);
  const base::SimTime start = bench.now;
  EXPECT_EQ(bench.command(21, 250), Texts{});
  bench.wait(249_ms);
  EXPECT_EQ(memory.activated, 0U);
  bench.wait(1_ms);
  EXPECT_EQ(memory.activated, 500'000U);
  EXPECT_EQ(memory.activated_at, start + 250_ms);
}

TEST(LssSlave, Store_KeepsNodeIdAndBitRate) {
  LssBench bench;
  Memory memory;
  bench.node.set_lss_hooks(memory.hooks());
  bench.configuration_state();
  EXPECT_EQ(bench.command(23), answer(23, 0));
  EXPECT_EQ(memory.orders, 1);
  EXPECT_EQ(memory.stored_node_id, 5U) << "nothing was configured: the one stored stays";
  bench.command(17, 33);
  bench.command(19, 3 << 8);
  EXPECT_EQ(bench.command(23), answer(23, 0));
  EXPECT_EQ(memory.stored_node_id, 33U);
  EXPECT_EQ(memory.stored_bit_rate, 250'000U);
  memory.works = false;
  EXPECT_EQ(bench.command(23), answer(23, 2));
}

TEST(LssSlave, Store_IsNotSupportedWithoutAMemory) {
  LssBench bench;
  bench.configuration_state();
  EXPECT_EQ(bench.command(23), answer(23, 1));
}

TEST(LssSlave, IdentifyRemoteSlave_AnswersWhenEveryRangeFits) {
  LssBench bench;
  const auto identify = [&](std::uint32_t low, std::uint32_t high) {
    bench.command(70, kVendor);
    bench.command(71, kProduct);
    bench.command(72, 0);
    bench.command(73, 0xFFFFFFFF);
    bench.command(74, low);
    return bench.command(75, high);
  };
  EXPECT_EQ(identify(kSerial, kSerial), answer(79));
  EXPECT_EQ(identify(0, 0xFFFFFFFF), answer(79));
  EXPECT_EQ(identify(kSerial + 1, 0xFFFFFFFF), Texts{});
  EXPECT_EQ(identify(0, kSerial - 1), Texts{});
  EXPECT_EQ(bench.command(75, 0xFFFFFFFF), Texts{});
}

TEST(LssSlave, IdentifyNonConfigured_IsAnsweredWithoutANodeIdOnly) {
  LssBench configured;
  EXPECT_EQ(configured.command(76), Texts{});
  LssBench bench(kUnconfiguredNodeId);
  EXPECT_EQ(bench.command(76), answer(80));
}

TEST(LssSlave, NodeWithoutNodeId_BootsWhenItWasGivenOneAndLeftAlone) {
  LssBench bench(kUnconfiguredNodeId);
  EXPECT_EQ(bench.node.state(), NmtState::initialisation);
  bench.nmt(1, 0);
  EXPECT_EQ(bench.node.state(), NmtState::initialisation);
  bench.configuration_state();
  EXPECT_EQ(bench.command(94), answer(94, 255));
  EXPECT_EQ(bench.command(17, 33), answer(17, 0));
  EXPECT_EQ(bench.command(4, 0), Texts{"721 [00]"});
  EXPECT_EQ(bench.node.state(), NmtState::pre_operational);
  EXPECT_EQ(bench.node.node_id(), 33);
}

/// Finds a slave as a master does it: bit by bit from the highest, part after part.
std::optional<std::array<std::uint32_t, 4>> scan(LssBench& bench) {
  if (bench.command(81, 0, 128, 0, 0) != answer(79)) {
    return std::nullopt;
  }
  std::array<std::uint32_t, 4> found{};
  for (unsigned part = 0; part < 4; ++part) {
    for (unsigned bit = 32; bit-- > 0;) {
      if (bench.command(81, found[part], bit, part, part) != answer(79)) {
        found[part] |= 1U << bit;
      }
    }
    const unsigned next = (part + 1) % 4;
    if (bench.command(81, found[part], 0, part, next) != answer(79)) {
      return std::nullopt;
    }
  }
  return found;
}

TEST(LssSlave, Fastscan_FindsTheAddressAndEndsInConfiguration) {
  LssBench bench(kUnconfiguredNodeId);
  EXPECT_EQ(scan(bench), (std::array{kVendor, kProduct, kRevision, kSerial}));
  EXPECT_EQ(bench.command(93), answer(93, kSerial));
}

TEST(LssSlave, Fastscan_FindsNobodyThatHasANodeIdOrIsInConfiguration) {
  LssBench configured;
  EXPECT_EQ(scan(configured), std::nullopt);
  LssBench bench(kUnconfiguredNodeId);
  bench.configuration_state();
  EXPECT_EQ(scan(bench), std::nullopt);
}

TEST(LssSlave, Fastscan_AnswersOnlyForThePartItIsAt) {
  LssBench bench(kUnconfiguredNodeId);
  bench.command(81, 0, 128, 0, 0);
  EXPECT_EQ(bench.command(81, kProduct, 0, 1, 2), Texts{});
  EXPECT_EQ(bench.command(81, kVendor, 0, 0, 1), answer(79));
  EXPECT_EQ(bench.command(81, kProduct, 0, 1, 2), answer(79));
  EXPECT_EQ(bench.command(81, 0, 40, 2, 2), Texts{});
  EXPECT_EQ(bench.command(81, 0, 0, 7, 0), Texts{});
}

TEST(LssSlave, WorksInStopped) {
  LssBench bench;
  bench.nmt(2);
  bench.configuration_state();
  EXPECT_EQ(bench.command(94), answer(94, 5));
}

TEST(LssSlave, State_OutlivesNmtStatesButNotAReset) {
  LssBench bench;
  bench.configuration_state();
  bench.nmt(1);
  bench.nmt(128);
  EXPECT_EQ(bench.command(94), answer(94, 5));
  bench.nmt(130);
  bench.wait(1_ms);
  bench.take();
  EXPECT_EQ(bench.command(94), Texts{});
}

TEST(LssSlave, FrameWithoutEightBytes_IsIgnoredAndExplained) {
  LssBench bench;
  bench.receive(0x7E5, {4, 1});
  bench.receive(0x7E5, {94, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(to_text(bench.take()), Texts{});
  EXPECT_TRUE(bench.events.tells("LSS message ignored: it has 2 data bytes, must have 8"));
}

TEST(LssSlave, SwitchSelective_BeginsWithTheVendorAfterPowerOn) {
  LssBench bench;
  EXPECT_EQ(bench.command(65, kProduct), Texts{});
  EXPECT_EQ(bench.command(66, kRevision), Texts{});
  EXPECT_EQ(bench.command(67, kSerial), Texts{});
}

TEST(LssSlave, SwitchSelective_IsForgottenByAReset) {
  LssBench bench;
  bench.command(64, kVendor);
  bench.command(65, kProduct);
  bench.nmt(130);
  bench.wait(1_ms);
  bench.take();
  EXPECT_EQ(bench.command(66, kRevision), Texts{});
  EXPECT_EQ(bench.command(67, kSerial), Texts{});
}

TEST(LssSlave, SwitchSelective_IsEndedBySwitchGlobal) {
  LssBench bench;
  bench.command(64, kVendor);
  bench.command(65, kProduct);
  bench.waiting_state();
  EXPECT_EQ(bench.command(66, kRevision), Texts{});
  EXPECT_EQ(bench.command(67, kSerial), Texts{});
  EXPECT_EQ(bench.command(94), Texts{}) << "still in Waiting";
}

TEST(LssSlave, SwitchSelective_NeedsAllFourPartsEachTime) {
  LssBench bench;
  EXPECT_EQ(bench.select(kVendor, kProduct, kRevision, kSerial), answer(68));
  EXPECT_EQ(bench.command(65, kProduct), Texts{});
  EXPECT_EQ(bench.command(66, kRevision), Texts{});
  EXPECT_EQ(bench.command(67, kSerial), Texts{});
}

TEST(LssSlave, Identify_BeginsWithTheVendorAfterPowerOn) {
  LssBench bench;
  bench.command(71, kProduct);
  bench.command(72, kRevision);
  bench.command(73, kRevision);
  bench.command(74, kSerial);
  EXPECT_EQ(bench.command(75, kSerial), Texts{});
}

TEST(LssSlave, Fastscan_LeavesAPartOnlyWhenItsLastBitIsFound) {
  LssBench bench(kUnconfiguredNodeId);
  bench.command(81, 0, 128, 0, 0);
  EXPECT_EQ(bench.command(81, kVendor, 31, 0, 1), answer(79));
  EXPECT_EQ(bench.command(81, kProduct, 0, 1, 2), Texts{}) << "31 bits are still unknown";
  EXPECT_EQ(bench.command(81, kVendor, 0, 0, 1), answer(79));
  EXPECT_EQ(bench.command(81, kProduct, 0, 1, 2), answer(79));
}

TEST(LssSlave, ActivateBitTiming_DoesNothingWhereNoneWasConfigured) {
  Memory memory;
  memory.activated = 1;
  LssBench bench;
  bench.node.set_lss_hooks(memory.hooks());
  bench.configuration_state();
  bench.command(21, 10);
  bench.wait(1_s);
  EXPECT_EQ(memory.activated, 1U);
}

TEST(LssSlave, ActivateBitTiming_OfADeviceWithOneBitRateIsHarmless) {
  LssBench bench;
  bench.node.set_lss_hooks({});
  bench.configuration_state();
  EXPECT_EQ(bench.command(19, 0x0200), answer(19, 0));
  bench.command(21, 10);
  bench.wait(1_s);
  EXPECT_EQ(bench.command(94), answer(94, 5));
}

TEST(LssSlave, IsSilentBetweenAResetAndTheBootUp) {
  // 1018h, which holds the address, is only being reset then.
  LssBench bench;
  bench.nmt(130);
  EXPECT_EQ(bench.select(kVendor, kProduct, kRevision, kSerial), Texts{});
  bench.wait(1_ms);
  bench.take();
  EXPECT_EQ(bench.select(kVendor, kProduct, kRevision, kSerial), answer(68));
}

}  // namespace
}  // namespace stator::canopen
