// Cases of the CiA conformance test, groups 4 to 8: object dictionary, emergencies, SYNC, error
// control, stored parameters and restricted CAN-IDs. Numbers are those of the test tool.

#include <gtest/gtest.h>

#include "canopen/conformance_device.hpp"

namespace stator::canopen::test {
namespace {

using namespace base::literals;
using dictionary::Entry;

// Group 4: object dictionary.

TEST(ConformanceCase, Case4_01_07_EveryObject_IsAccessedAsItsAccessTypeSays) {
  ConformanceDevice device;
  for (const Entry& entry : device.dictionary.entries()) {
    const bool empty_history = entry.index() == 0x1003 && entry.subindex() != 0;
    const std::uint32_t expected = empty_history      ? 0x08000024U
                                   : entry.readable() ? 0U
                                                      : 0x06010001U;
    EXPECT_EQ(device.upload(entry.index(), entry.subindex()).abort, expected)
        << std::hex << entry.index() << ":" << int{entry.subindex()};
  }
}

TEST(ConformanceCase, Case4_02_08_EveryObject_HasItsDefaultAfterReset) {
  ConformanceDevice device;
  for (const Entry& entry : device.dictionary.entries()) {
    const bool empty_history = entry.index() == 0x1003 && entry.subindex() != 0;
    if (!entry.readable() || dictionary::is_string(entry.type()) || empty_history) {
      continue;
    }
    const dictionary::EntryDeclaration& declared = entry.declaration();
    const auto expected =
        declared.default_value.number.bits + (declared.node_id_relative ? kNodeId : 0U);
    const std::size_t bits = 8 * entry.size();
    const std::uint64_t mask = bits >= 64 ? ~0ULL : (1ULL << bits) - 1;
    EXPECT_EQ(device.upload_number(entry.index(), entry.subindex()), expected & mask)
        << std::hex << entry.index() << ":" << int{entry.subindex()};
  }
}

TEST(ConformanceCase, Case4_03_WriteToEveryReadOnlyObject_IsRefused) {
  ConformanceDevice device;
  for (const Entry& entry : device.dictionary.entries()) {
    if (!entry.writable() && !dictionary::is_string(entry.type())) {
      EXPECT_EQ(device.download(entry.index(), entry.subindex(), 0), 0x06010002U)
          << std::hex << entry.index() << ":" << int{entry.subindex()};
    }
  }
}

TEST(ConformanceCase, Case4_06_Limits_AreThoseDeclared) {
  ConformanceDevice device;
  for (const Entry& entry : device.dictionary.entries()) {
    const auto& range = entry.declaration().range;
    if (!range || !entry.writable()) {
      continue;
    }
    const auto minimum = static_cast<std::uint32_t>(range->minimum.bits);
    const auto maximum = static_cast<std::uint32_t>(range->maximum.bits);
    EXPECT_EQ(device.download(entry.index(), entry.subindex(), minimum), 0U);
    EXPECT_EQ(device.download(entry.index(), entry.subindex(), maximum), 0U);
    EXPECT_EQ(device.download(entry.index(), entry.subindex(), maximum + 1), 0x06090031U);
    if (minimum != 0) {
      EXPECT_EQ(device.download(entry.index(), entry.subindex(), minimum - 1), 0x06090032U);
    }
  }
}

// Group 5: emergencies.

TEST(ConformanceCase, Case5_ShortPdo_RaisesAnEmergencyThatRegisterAndHistoryShow) {
  ConformanceDevice device;
  EXPECT_EQ(device.upload_number(0x1014, 0), 0x80U + kNodeId) << "01";
  EXPECT_EQ(device.upload_number(0x1001, 0), 0U) << "02";
  EXPECT_EQ(device.upload(0x1003, 1).abort, 0x08000024U) << "03";
  device.operational();
  device.take_sent();
  device.send(can::data_frame(0x205, {}));
  const std::vector<can::Frame> sent = device.take_sent();
  EXPECT_EQ(sent, std::vector{emergency_frame(0x8210, 0x11)}) << "04";
  EXPECT_EQ(device.upload_number(0x1001, 0), 0x11U) << "05";
  ASSERT_EQ(sent.size(), 1U);
  const std::uint32_t newest = device.upload_number(0x1003, 1);
  EXPECT_EQ(newest & 0xFFFF, base::load_le<std::uint16_t>(sent.front().data)) << "06";
  EXPECT_EQ(newest >> 16U, base::load_le<std::uint16_t>(sent.front().data, 3)) << "06";
}

// Group 6: SYNC.

/// Becomes producer with 10 ms; a counter overflow of 0 means none.
void produce_sync(ConformanceDevice& device, std::uint8_t overflow) {
  EXPECT_EQ(device.download(0x1019, 0, overflow), 0U);
  EXPECT_EQ(device.download(0x1006, 0, 10'000), 0U);
  EXPECT_EQ(device.download(0x1005, 0, 0x40000080), 0U);
  device.take_sent();
}

std::vector<int> counters(ConformanceDevice& device, base::SimDuration duration) {
  device.wait(duration);
  std::vector<int> result;
  for (const can::Frame& frame : device.take_sent()) {
    if (frame.identifier == 0x80) {
      result.push_back(frame.length == 0 ? 0 : std::to_integer<int>(frame.data[0]));
    }
  }
  return result;
}

TEST(ConformanceCase, Case6_01_02_04_06_Producer_SendsEmptySyncsUntilThePeriodIsZero) {
  ConformanceDevice device;
  EXPECT_EQ(device.upload_number(0x1005, 0), 0x80U) << "01";
  produce_sync(device, 0);
  EXPECT_EQ(counters(device, 10_s), std::vector<int>(1000, 0)) << "02, 06";
  EXPECT_EQ(device.download(0x1006, 0, 0), 0U);
  EXPECT_TRUE(counters(device, 1_s).empty()) << "04";
}

TEST(ConformanceCase, Case6_03_CyclicPdo_FollowsEveryNthSync) {
  ConformanceDevice device;
  device.configure_pdo(0x1800, 5, {0x20110010});
  device.operational();
  for (int i = 0; i < 50; ++i) {
    device.sync();
  }
  EXPECT_EQ(device.take_count(0x185), 10U);
}

TEST(ConformanceCase, Case6_05_CounterOverflowOne_IsRefused) {
  ConformanceDevice device;
  EXPECT_EQ(device.download(0x1019, 0, 1), 0x06090030U);
}

TEST(ConformanceCase, Case6_07_08_Counter_RunsToItsOverflowAndBeginsWithOneAfterReset) {
  ConformanceDevice device;
  produce_sync(device, 5);
  EXPECT_EQ(counters(device, 70_ms), (std::vector{1, 2, 3, 4, 5, 1, 2})) << "07";
  EXPECT_EQ(device.download(0x1010, 1, kSaveSignature), 0U);
  device.take_sent();
  device.nmt(NmtCommand::reset_node);
  device.wait(1_ms);
  EXPECT_EQ(counters(device, 30_ms), (std::vector{1, 2, 3})) << "08";
}

TEST(ConformanceCase, Case6_09_CounterOverflow_StaysWhileThePeriodIsNotZero) {
  ConformanceDevice device;
  EXPECT_EQ(device.download(0x1006, 0, 10'000), 0U);
  EXPECT_EQ(device.download(0x1019, 0, 5), 0x08000022U);
}

TEST(ConformanceCase, Case6_10_SavedPeriodZero_StaysSilentAfterReset) {
  ConformanceDevice device;
  produce_sync(device, 0);
  EXPECT_EQ(device.download(0x1006, 0, 0), 0U);
  EXPECT_EQ(device.download(0x1010, 1, kSaveSignature), 0U);
  device.nmt(NmtCommand::reset_node);
  EXPECT_TRUE(counters(device, 1_s).empty());
  EXPECT_EQ(device.upload_number(0x1005, 0), 0x40000080U);
}

// Group 7: error control.

constexpr std::uint32_t kErrorControl = 0x700 + kNodeId;

TEST(ConformanceCase, Case7_Guarding_IsAnsweredWithToggleAndItsEndReported) {
  ConformanceDevice device;
  EXPECT_EQ(device.upload_number(0x100C, 0), 0U) << "01";
  EXPECT_EQ(device.upload_number(0x100D, 0), 0U) << "01";
  EXPECT_EQ(device.download(0x100C, 0, 100), 0U) << "05";
  EXPECT_EQ(device.download(0x100D, 0, 3), 0U) << "05";
  device.take_sent();
  for (const unsigned answer : {0x7FU, 0xFFU, 0x7FU}) {
    device.send(can::remote_frame(kErrorControl));
    EXPECT_EQ(device.take_sent(), std::vector{can::data_frame(kErrorControl, {answer})})
        << "02, 03";
  }
  for (unsigned node = 1; node <= 127; ++node) {
    if (node != kNodeId) {
      device.send(can::remote_frame(0x700 + node));
    }
  }
  EXPECT_TRUE(device.take_sent().empty()) << "04";
  device.wait(300_ms);
  EXPECT_EQ(device.take_sent(), std::vector{emergency_frame(0x8130, 0x11)}) << "06";
}

TEST(ConformanceCase, Case7_Heartbeat_IsSentAsOftenAsWrittenAndDisabled) {
  ConformanceDevice device;
  EXPECT_EQ(device.download(0x1017, 0, 10), 0U);
  device.take_sent();
  device.wait(1_s);
  EXPECT_EQ(device.take_count(kErrorControl), 100U);
  EXPECT_EQ(device.download(0x1017, 0, 0), 0U);
  device.take_sent();
  device.wait(1_s);
  EXPECT_EQ(device.take_count(kErrorControl), 0U);
}

TEST(ConformanceCase, Case7_04_OneNodeInTwoConsumerEntries_IsRefused) {
  ConformanceDevice device;
  EXPECT_EQ(device.download(0x1016, 1, 0x000A0064), 0U);
  EXPECT_EQ(device.download(0x1016, 2, 0x000A00C8), 0x06040043U);
}

TEST(ConformanceCase, Case7_05_07_EveryConsumerEntry_IsWatchedFromTheFirstHeartbeatOn) {
  for (std::uint8_t subindex = 1; subindex <= 4; ++subindex) {
    ConformanceDevice device;
    EXPECT_EQ(device.download(0x1016, subindex, 0x000A0064), 0U);
    device.operational();
    device.wait(1_s);
    device.take_sent();
    EXPECT_EQ(device.node.state(), NmtState::operational) << "06: before the first one";
    for (int i = 0; i < 10; ++i) {
      device.send(can::data_frame(0x70A, {5}));
      device.wait(99_ms);
    }
    EXPECT_EQ(device.take_count(0x85), 0U) << "05";
    device.wait(2_ms);
    EXPECT_EQ(device.take_sent(), std::vector{emergency_frame(0x8130, 0x11)}) << "06, 07";
    EXPECT_EQ(device.node.state(), NmtState::pre_operational) << "07";
    device.send(can::data_frame(0x70A, {5}));
    EXPECT_EQ(device.take_sent(), std::vector{emergency_frame(0x0000, 0x00)}) << "07";
  }
}

TEST(ConformanceCase, Case7_HeartbeatProducer_AnswersNoGuarding) {
  ConformanceDevice device;
  EXPECT_EQ(device.download(0x1017, 0, 1000), 0U);
  device.wait(1_ms);
  device.take_sent();
  device.send(can::remote_frame(kErrorControl));
  EXPECT_EQ(device.take_count(kErrorControl), 0U);
}

// Group 8: stored parameters, configuration date, restricted CAN-IDs.

TEST(ConformanceCase, Case8_01_08_WrongSignatures_AreRefusedAndChangeNothing) {
  ConformanceDevice device;
  constexpr std::uint32_t kWrong = 0x6E6F7277;
  EXPECT_EQ(device.download(0x2020, 0, 7), 0U);
  for (std::uint8_t subindex = 1; subindex <= 2; ++subindex) {
    EXPECT_EQ(device.download(0x1010, subindex, kWrong), 0x08000020U);
    EXPECT_EQ(device.download(0x1010, subindex, 0x73617665), 0x08000020U) << "wrong order";
    EXPECT_EQ(device.download(0x1011, subindex, kWrong), 0x08000020U);
    EXPECT_EQ(device.download(0x1011, subindex, 0x6C6F6164), 0x08000020U) << "wrong order";
  }
  EXPECT_EQ(device.upload_number(0x2020, 0), 7U);
  device.reset_node();
  EXPECT_EQ(device.upload_number(0x2020, 0), 1000U);
}

TEST(ConformanceCase, Case8_09_ConfigurationDate_IsKeptBySaveAndZeroedByAnyChange) {
  ConformanceDevice device;
  EXPECT_EQ(device.download(0x1020, 1, 10'000), 0U);
  EXPECT_EQ(device.download(0x1020, 2, 20'000), 0U);
  EXPECT_EQ(device.download(0x1010, 1, kSaveSignature), 0U);
  device.reset_node();
  EXPECT_EQ(device.upload_number(0x1020, 1), 10'000U);
  EXPECT_EQ(device.upload_number(0x1020, 2), 20'000U);
  EXPECT_EQ(device.download(0x2020, 0, 7), 0U);
  EXPECT_EQ(device.upload_number(0x1020, 1), 0U);
  EXPECT_EQ(device.upload_number(0x1020, 2), 0U);
}

TEST(ConformanceCase, Case8_10_RestrictedCanIds_AreRefusedEverywhere) {
  ConformanceDevice device;
  unsigned tried = 0;
  for (std::uint32_t can_id = 0; can_id <= 0x7FF; ++can_id) {
    const bool restricted = can_id <= 0x07F || (can_id >= 0x101 && can_id <= 0x180) ||
                            (can_id >= 0x581 && can_id <= 0x5FF) ||
                            (can_id >= 0x601 && can_id <= 0x67F) ||
                            (can_id >= 0x6E0 && can_id <= 0x6FF) || can_id >= 0x701;
    if (!restricted) {
      continue;
    }
    ++tried;
    EXPECT_EQ(device.download(0x1005, 0, can_id), 0x06090030U) << can_id;
    EXPECT_EQ(device.download(0x1012, 0, can_id), 0x06090030U) << can_id;
    EXPECT_EQ(device.download(0x1014, 0, can_id), 0x06090030U) << can_id;
    EXPECT_EQ(device.download(0x1400, 1, can_id), 0x06090030U) << can_id;
    EXPECT_EQ(device.download(0x1800, 1, can_id), 0x06090030U) << can_id;
  }
  EXPECT_EQ(tried, 797U);
}

}  // namespace
}  // namespace stator::canopen::test
