// When receive PDOs take effect, and what becomes of frames that are too short, too long, late or
// not acceptable.
#include <tuple>

#include <gtest/gtest.h>

#include "canopen/service_bench.hpp"

namespace stator::canopen {
namespace {

using namespace base::literals;
using test::emergency_frame;
using test::kTmcc160Emergencies;
using test::kTmcc160Pdos;
using test::ServiceBench;

constexpr std::uint32_t kRangeExceeded = 0x06090030;

TEST(ReceivePdo, EventDrivenOne_IsAppliedAtOnceAndTogether) {
  ServiceBench bench;
  bench.operational();
  EXPECT_TRUE(bench.receive(0x305, {0x11, 0x44, 0x33, 0x22, 0x11}));
  EXPECT_EQ(bench.value(0x2001), 0x11U);
  EXPECT_EQ(bench.value(0x2003), 0x11223344U);
  EXPECT_EQ(bench.process_data_calls, 1) << "once for all objects of the frame";
}

TEST(ReceivePdo, OutsideOperational_NothingIsTaken) {
  ServiceBench bench;
  EXPECT_FALSE(bench.receive(0x205, {1, 0}));
  bench.enter(NmtState::stopped);
  EXPECT_FALSE(bench.receive(0x205, {1, 0}));
  EXPECT_EQ(bench.value(0x2002), 0U);
}

TEST(ReceivePdo, InvalidOne_IsNotTaken) {
  ServiceBench bench;
  bench.operational();
  bench.write(0x1400, 1, 0x80000205);
  EXPECT_FALSE(bench.receive(0x205, {1, 0}));
  bench.write(0x1400, 1, 0x205);
  EXPECT_TRUE(bench.receive(0x205, {1, 0}));
  EXPECT_EQ(bench.value(0x2002), 1U);
}

TEST(ReceivePdo, RemoteFrame_IsNoData) {
  ServiceBench bench;
  bench.operational();
  EXPECT_FALSE(bench.receive(can::remote_frame(0x205, 2)));
}

TEST(ReceivePdo, SynchronousOne_IsAppliedAtTheNextSync) {
  ServiceBench bench;
  bench.operational();
  bench.receive(0x405, {0xCD, 0xAB, 1, 0, 0, 0});
  bench.receive(0x405, {0xCE, 0xAB, 2, 0, 0, 0});
  EXPECT_EQ(bench.value(0x2002), 0U);
  EXPECT_EQ(bench.process_data_calls, 0);
  bench.send_sync();
  EXPECT_EQ(bench.value(0x2002), 0xABCEU) << "the newest one";
  EXPECT_EQ(bench.value(0x2003), 2U);
  EXPECT_EQ(bench.process_data_calls, 1);
  bench.set(0x2003, 0, 9);
  bench.send_sync();
  EXPECT_EQ(bench.value(0x2003), 9U) << "applied once only";
}

TEST(ReceivePdo, TypeZero_WaitsForTheSyncToo) {
  ServiceBench bench(kTmcc160Pdos);
  bench.write(0x1400, 1, 0xC0000205);
  EXPECT_EQ(bench.write(0x1400, 2, 0), 0U);
  bench.write(0x1400, 1, 0x40000205);
  bench.operational();
  bench.receive(0x205, {7, 0});
  EXPECT_EQ(bench.value(0x2002), 0U);
  bench.send_sync();
  EXPECT_EQ(bench.value(0x2002), 7U);
}

TEST(ReceivePdo, WhatWaitsForASync_IsForgottenOutsideOperational) {
  ServiceBench bench;
  bench.operational();
  bench.receive(0x405, {1, 0, 1, 0, 0, 0});
  bench.enter(NmtState::pre_operational);
  bench.send_sync();
  bench.operational();
  bench.send_sync();
  EXPECT_EQ(bench.value(0x2002), 0U);
}

TEST(ReceivePdo, WhatWaitsForASync_OutlivesWritesThatLeaveThePdoTheSame) {
  for (const auto& [index, subindex, value] :
       {std::tuple<std::uint16_t, std::uint8_t, std::uint32_t>{0x1402, 2, 1},
        {0x1402, 2, 0},
        {0x1402, 2, 240},
        {0x1402, 2, 255},
        {0x1402, 1, 0x405},
        {0x1402, 5, 20},
        {0x1400, 2, 0},
        {0x1400, 1, 0x80000205}}) {
    ServiceBench bench;
    bench.operational();
    bench.receive(0x405, {7, 0, 1, 0, 0, 0});
    EXPECT_EQ(bench.write(index, subindex, value), 0U);
    bench.send_sync();
    EXPECT_EQ(bench.value(0x2002), 7U)
        << std::hex << index << ':' << int{subindex} << " = " << value;
  }
}

TEST(ReceivePdo, WhatWaitsForASync_IsForgottenWhenThePdoBecomesAnother) {
  ServiceBench bench;
  bench.operational();
  bench.receive(0x405, {7, 0, 1, 0, 0, 0});
  bench.reconfigure(0x1402, {0x20020010}, 1);
  bench.send_sync();
  EXPECT_EQ(bench.value(0x2002), 0U);
}

TEST(ReceivePdo, WhatWaitsForASync_GivesWayToANewerFrameThatTakesEffectAtOnce) {
  ServiceBench bench;
  bench.operational();
  bench.receive(0x405, {7, 0, 1, 0, 0, 0});
  bench.write(0x1402, 2, 255);
  bench.receive(0x405, {8, 0, 1, 0, 0, 0});
  EXPECT_EQ(bench.value(0x2002), 8U);
  bench.send_sync();
  EXPECT_EQ(bench.value(0x2002), 8U);
}

TEST(ReceivePdo, ErrorsOutliveWritesThatLeaveThePdoTheSame) {
  ServiceBench bench;
  bench.operational();
  bench.receive(0x205, {9});
  bench.take_sent();
  bench.write(0x1400, 2, 255);
  bench.wait(0_ns);
  EXPECT_TRUE(bench.take_sent().empty());
  EXPECT_EQ(bench.value(0x1001), 0x11U);
}

TEST(ReceivePdo, TransmissionTypes_AreThoseOfTheProduct) {
  ServiceBench standard;
  ServiceBench product(kTmcc160Pdos);
  for (unsigned type = 0; type <= 255; ++type) {
    const bool of_standard = type <= 240 || type >= 254;
    const bool of_product = type == 0 || type >= 254;
    EXPECT_EQ(standard.write(0x1400, 2, type), of_standard ? 0 : kRangeExceeded) << type;
    EXPECT_EQ(product.write(0x1400, 2, type), of_product ? 0 : kRangeExceeded) << type;
  }
}

TEST(ReceivePdo, TooShort_IsNotTakenAndReportedOnce) {
  ServiceBench bench;
  bench.operational();
  bench.take_sent();
  bench.receive(0x205, {9});
  bench.receive(0x205, {9});
  EXPECT_EQ(bench.value(0x2002), 0U);
  EXPECT_EQ(bench.process_data_calls, 0);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x8210, 0x11)});
  EXPECT_EQ(bench.value(0x1001), 0x11U);
  EXPECT_EQ(bench.pdos.statistics().length_errors, 2U);
  bench.receive(0x205, {9, 0});
  EXPECT_EQ(bench.value(0x2002), 9U);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x0000, 0x00)});
  bench.receive(0x205, {});
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x8210, 0x11)}) << "armed again";
}

TEST(ReceivePdo, TooLong_IsTakenAndReportedAsTheStandardSays) {
  ServiceBench bench;
  bench.operational();
  bench.take_sent();
  bench.receive(0x205, {9, 0, 1});
  EXPECT_EQ(bench.value(0x2002), 9U);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x8220, 0x11)});
}

TEST(ReceivePdo, TooLong_IsNotTakenWhereTheProductSaysSo) {
  ServiceBench bench(kTmcc160Pdos, {kTmcc160Emergencies});
  bench.operational();
  bench.take_sent();
  bench.receive(0x205, {9, 0, 1});
  EXPECT_EQ(bench.value(0x2002), 0U);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x8220, 0x11, {0, 255})});
  bench.receive(0x205, {9});
  EXPECT_EQ(bench.take_sent(),
            (std::vector{emergency_frame(0x0000, 0x00), emergency_frame(0x8210, 0x11, {0, 255})}));
}

TEST(ReceivePdo, TooLong_IsTakenSilentlyWhereTheProductSaysSo) {
  PdoRules rules;
  rules.long_pdo = LongPdo::process;
  ServiceBench bench(rules);
  bench.operational();
  bench.take_sent();
  bench.receive(0x205, {9, 0, 1});
  EXPECT_EQ(bench.value(0x2002), 9U);
  EXPECT_TRUE(bench.take_sent().empty());
}

TEST(ReceivePdo, RefusedValue_KeepsTheOldOneAndIsReportedOnceUntilOneIsTaken) {
  ServiceBench bench({}, {kTmcc160Emergencies});
  bench.reconfigure(0x1400, {0x20050008, 0x20010008}, 255);
  bench.operational();
  bench.take_sent();
  bench.receive(0x205, {50, 1});
  EXPECT_TRUE(bench.take_sent().empty());
  bench.receive(0x205, {101, 2});
  bench.receive(0x205, {102, 3});
  EXPECT_EQ(bench.value(0x2005), 50U);
  EXPECT_EQ(bench.value(0x2001), 3U) << "the other objects of the frame are taken";
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x6320, 0x21, {0, 255})});
  bench.receive(0x205, {100, 3});
  EXPECT_EQ(bench.value(0x2005), 100U);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x0000, 0x00)});
  bench.receive(0x205, {200, 3});
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x6320, 0x21, {0, 255})});
}

TEST(ReceivePdo, ValueRefusedBeforeAReset_IsToldNoMoreAndItsNextOneIs) {
  ServiceBench bench({}, {kTmcc160Emergencies});
  bench.reconfigure(0x1400, {0x20050008, 0x20010008}, 255);
  bench.operational();
  bench.receive(0x205, {101, 2});
  bench.take_sent();
  bench.enter(NmtState::initialisation);
  bench.start();
  EXPECT_EQ(bench.take_sent(), std::vector<can::Frame>{});
  EXPECT_EQ(bench.value(0x1001), 0x00U);
  bench.operational();
  bench.take_sent();
  bench.receive(0x205, {101, 2});
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x6320, 0x21, {0, 255})});
}

TEST(ReceivePdo, TwoWithOneCanId_AreBothServed) {
  ServiceBench bench;
  bench.write(0x1403, 1, 0x80000505);
  bench.write(0x1603, 1, 0x20010008);
  bench.write(0x1603, 0, 1);
  bench.write(0x1403, 1, 0x205);
  bench.operational();
  bench.receive(0x205, {3, 0});
  EXPECT_EQ(bench.value(0x2002), 3U);
  EXPECT_EQ(bench.value(0x2001), 3U);
}

TEST(ReceivePdo, WithoutMapping_TakesNothingAndReportsNothing) {
  ServiceBench bench;
  bench.operational();
  bench.take_sent();
  EXPECT_TRUE(bench.receive(0x505, {1, 2, 3}));
  EXPECT_TRUE(bench.take_sent().empty());
}

TEST(ReceivePdo, EventTimer_ReportsAFrameThatDoesNotCome) {
  ServiceBench bench;
  EXPECT_EQ(bench.write(0x1400, 5, 20), 0U);
  bench.operational();
  bench.take_sent();
  bench.wait(100_ms);
  EXPECT_TRUE(bench.take_sent().empty()) << "supervised from the first frame on";
  bench.receive(0x205, {1, 0});
  bench.wait(19_ms);
  bench.receive(0x205, {2, 0});
  bench.wait(19_ms);
  EXPECT_TRUE(bench.take_sent().empty());
  bench.wait(1_ms);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x8250, 0x11)});
  bench.wait(100_ms);
  EXPECT_TRUE(bench.take_sent().empty());
  bench.receive(0x205, {2, 0});
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x0000, 0x00)});
}

TEST(ReceivePdo, EventTimer_CountsFromTheLastFrameWhateverIsWritten) {
  ServiceBench bench;
  bench.write(0x1400, 5, 20);
  bench.operational();
  bench.receive(0x205, {1, 0});
  bench.take_sent();
  bench.wait(15_ms);
  bench.write(0x1400, 5, 20);
  bench.wait(5_ms);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x8250, 0x11)}) << "the same value";
  bench.receive(0x205, {1, 0});
  bench.wait(15_ms);
  bench.take_sent();
  bench.write(0x1400, 5, 30);
  bench.wait(14_ms);
  EXPECT_TRUE(bench.take_sent().empty());
  bench.wait(1_ms);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x8250, 0x11)}) << "a longer one";
  bench.write(0x1400, 5, 0);
  bench.wait(0_ns);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x0000, 0x00)})
      << "nothing is expected any more";
}

TEST(ReceivePdo, SynchronousOneAfterTheWindow_BelongsToNoSync) {
  ServiceBench bench;
  bench.write(0x1007, 0, 1000);
  bench.operational();
  bench.send_sync();
  bench.wait(999_us);
  bench.receive(0x405, {1, 0, 0, 0, 0, 0});
  bench.wait(2_us);
  bench.receive(0x405, {2, 0, 0, 0, 0, 0});
  bench.send_sync();
  EXPECT_EQ(bench.value(0x2002), 1U);
  EXPECT_EQ(bench.pdos.statistics().outside_window, 1U);
}

}  // namespace
}  // namespace stator::canopen
