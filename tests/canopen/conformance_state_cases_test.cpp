// Cases of the CiA conformance test, groups 9 and 10: NMT states and transitions. Numbers are those
// of the test tool.

#include <gtest/gtest.h>

#include "canopen/conformance_device.hpp"

namespace stator::canopen::test {
namespace {

using namespace base::literals;
using dictionary::Entry;

constexpr std::uint32_t kErrorControl = 0x700 + kNodeId;

TEST(ConformanceCase, Case9_01_AfterRandomWrites_ResetBringsEveryDefaultBack) {
  ConformanceDevice fresh;
  ConformanceDevice device;
  std::uint32_t random = 12345;
  for (const Entry& entry : device.dictionary.entries()) {
    if (entry.index() < 0x2000 && entry.writable()) {
      random = random * 1664525U + 1013904223U;
      device.download(entry.index(), entry.subindex(), random);
    }
  }
  device.reset_node();
  for (const Entry& entry : device.dictionary.entries()) {
    EXPECT_EQ(entry.value(), fresh.value(entry.index(), entry.subindex()))
        << std::hex << entry.index() << ":" << int{entry.subindex()};
  }
}

/// What works in a state (CiA 301 table 37).
struct Services {
  const char* number;
  NmtCommand command;
  unsigned heartbeat;  ///< the state it tells
  bool sdo;
  bool sync;
  bool pdo;
};
constexpr Services kStates[] = {
    {"02", NmtCommand::enter_pre_operational, 127, true, true, false},
    {"03", NmtCommand::start, 5, true, true, true},
    {"04", NmtCommand::stop, 4, false, false, false},
};

TEST(ConformanceCase, Case9_02_04_EveryState_HasTheServicesOfTheStandard) {
  for (const Services& state : kStates) {
    ConformanceDevice device;
    EXPECT_EQ(device.download(0x1017, 0, 100), 0U);
    EXPECT_EQ(device.download(0x1006, 0, 10'000), 0U);
    EXPECT_EQ(device.download(0x1005, 0, 0x40000080), 0U);
    device.nmt(state.command);
    EXPECT_EQ(device.exchange({0x40, 0x00, 0x10, 0})[0], state.sdo ? 0x43 : 0x00) << state.number;
    device.take_sent();
    device.wait(1_s);
    const std::vector<can::Frame> sent = device.take_sent();
    const auto count = [&sent](const can::Frame& wanted) {
      return std::ranges::count(sent, wanted);
    };
    EXPECT_EQ(count(can::data_frame(kErrorControl, {state.heartbeat})), 10) << state.number;
    EXPECT_EQ(std::ranges::count(sent, 0x80U, &can::Frame::identifier), state.sync ? 100 : 0)
        << state.number;
    EXPECT_EQ(std::ranges::count(sent, 0x385U, &can::Frame::identifier), state.pdo ? 100 : 0)
        << state.number;
  }
}

TEST(ConformanceCase, Case10_EveryTransition_LeadsWhereTheStandardSays) {
  constexpr std::array kCommands{NmtCommand::enter_pre_operational, NmtCommand::start,
                                 NmtCommand::stop, NmtCommand::reset_node,
                                 NmtCommand::reset_communication};
  for (const Services& from : kStates) {
    for (const NmtCommand command : kCommands) {
      for (const std::uint8_t addressed : {kNodeId, std::uint8_t{0}}) {
        ConformanceDevice device;
        device.nmt(from.command);
        device.take_sent();
        device.nmt(command, addressed);
        device.wait(100_ms);
        const bool resets =
            command == NmtCommand::reset_node || command == NmtCommand::reset_communication;
        EXPECT_EQ(device.take_count(kErrorControl), resets ? 1U : 0U) << "boot-up";
        const NmtState expected = resets
                                      ? NmtState::pre_operational
                                      : find_transition(static_cast<std::uint8_t>(command))->target;
        EXPECT_EQ(device.node.state(), expected);
      }
    }
  }
}

TEST(ConformanceCase, Case10_CommandsToOtherNodes_ChangeNothing) {
  ConformanceDevice device;
  for (unsigned node = 1; node <= 255; ++node) {
    if (node != kNodeId) {
      device.nmt(NmtCommand::start, static_cast<std::uint8_t>(node));
    }
  }
  EXPECT_EQ(device.node.state(), NmtState::pre_operational);
}

}  // namespace
}  // namespace stator::canopen::test
