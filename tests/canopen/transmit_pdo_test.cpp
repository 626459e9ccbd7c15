// When transmit PDOs of each transmission type are sent: events, inhibit time, event timer, SYNC,
// remote frames.
#include <gtest/gtest.h>

#include "canopen/service_bench.hpp"

namespace stator::canopen {
namespace {

using namespace base::literals;
using test::kTmcc160Pdos;
using test::ServiceBench;

constexpr std::uint32_t kRangeExceeded = 0x06090030;
constexpr std::uint32_t kDeviceState = 0x08000022;
/// Subindices of 18xxh that can be written.
constexpr std::array<std::uint8_t, 5> kWritable{1, 2, 3, 5, 6};

/// A bench in Operational that has sent what that asks for; transmit PDO 1 maps 2011h.
struct RunningBench : ServiceBench {
  explicit RunningBench(const PdoRules& pdo_rules = {}) : ServiceBench(pdo_rules) {
    operational();
    take_sent();
  }
  /// Sets the value of 2011h as the application does, and tells.
  void change(std::uint64_t value) {
    set(0x2011, 0, value);
    pdos.values_may_have_changed(now);
  }
  void set_parameter(std::uint8_t subindex, std::uint32_t parameter) {
    const std::uint64_t cob_id = value(0x1800, 1);
    write(0x1800, 1, cob_id | kCobIdInvalid);
    EXPECT_EQ(write(0x1800, subindex, parameter), 0U);
    write(0x1800, 1, cob_id);
    wait(0_ns);
    take_sent();
  }
};

TEST(TransmitPdo, EveryValidEventDrivenOne_IsSentOnEnteringOperational) {
  ServiceBench bench;
  bench.set(0x2011, 0, 0x1234);
  EXPECT_TRUE(bench.take_sent().empty());
  bench.operational();
  EXPECT_EQ(bench.take_sent(), (std::vector{can::data_frame(0x185, {0x34, 0x12}),
                                            can::data_frame(0x285, {0, 0, 0, 0, 0})}));
  bench.enter(NmtState::pre_operational);
  bench.operational();
  EXPECT_EQ(bench.take_sent().size(), 2U) << "each time";
}

TEST(TransmitPdo, ChangeOfAMappedValue_IsSentOnce) {
  RunningBench bench;
  bench.change(1);
  EXPECT_EQ(bench.take_sent(), std::vector{can::data_frame(0x185, {1, 0})});
  bench.change(1);
  bench.wait(1_s);
  EXPECT_TRUE(bench.take_sent().empty());
}

TEST(TransmitPdo, OutsideOperational_NothingIsSent) {
  for (const NmtState state : {NmtState::pre_operational, NmtState::stopped}) {
    RunningBench bench;
    bench.write(0x1800, 5, 10);
    bench.enter(state);
    bench.change(1);
    bench.send_sync();
    bench.receive(can::remote_frame(0x185));
    bench.pdos.request(0, bench.now);
    bench.wait(1_s);
    EXPECT_TRUE(bench.take_sent().empty()) << to_text(state).view();
  }
}

TEST(TransmitPdo, InhibitTime_DelaysAndMergesEvents) {
  RunningBench bench;
  bench.set_parameter(3, 50);  // 5 ms
  bench.wait(5_ms);
  bench.change(1);
  EXPECT_EQ(bench.take_sent().size(), 1U);
  bench.wait(1_ms);
  bench.change(2);
  bench.wait(1_ms);
  bench.change(3);
  bench.wait(2999_us);
  EXPECT_TRUE(bench.take_sent().empty());
  bench.wait(1_us);
  EXPECT_EQ(bench.take_sent(), std::vector{can::data_frame(0x185, {3, 0})});
}

TEST(TransmitPdo, InhibitTime_HasTheUnitOfTheProduct) {
  RunningBench bench(kTmcc160Pdos);
  bench.write(0x1800, 1, 0xC0000185);
  EXPECT_EQ(bench.write(0x1800, 3, 50), 0U);
  bench.write(0x1800, 1, 0x40000185);
  bench.wait(50_ms);
  bench.take_sent();
  bench.change(1);
  bench.change(2);
  EXPECT_EQ(bench.take_sent().size(), 1U);
  bench.wait(49'999_us);
  EXPECT_TRUE(bench.take_sent().empty());
  bench.wait(1_us);
  EXPECT_EQ(bench.take_sent().size(), 1U);
}

TEST(TransmitPdo, InhibitTimeAndSyncStart_ChangeOnlyWhileThePdoIsInvalid) {
  ServiceBench bench;
  EXPECT_EQ(bench.write(0x1800, 3, 50), kDeviceState);
  EXPECT_EQ(bench.write(0x1800, 6, 5), kDeviceState);
  EXPECT_EQ(bench.write(0x1800, 3, 0), 0U) << "the value it has";
  EXPECT_EQ(bench.write(0x1800, 5, 50), 0U) << "the event timer changes at any time";
  bench.write(0x1800, 1, 0x80000185);
  EXPECT_EQ(bench.write(0x1800, 3, 50), 0U);
  EXPECT_EQ(bench.write(0x1800, 6, 5), 0U);
}

TEST(TransmitPdo, WritesOfTheSameValues_SendNothingAndShiftNothing) {
  RunningBench bench;
  bench.set_parameter(3, 100);  // 10 ms
  bench.set_parameter(5, 50);
  bench.wait(20_ms);
  bench.change(1);
  EXPECT_EQ(bench.take_count(0x185), 1U);
  bench.wait(5_ms);
  for (const std::uint8_t subindex : kWritable) {
    EXPECT_EQ(bench.write(0x1800, subindex, bench.value(0x1800, subindex)), 0U);
    bench.wait(0_ns);
    EXPECT_TRUE(bench.take_sent().empty()) << int{subindex};
  }
  bench.wait(44'999_us);
  EXPECT_TRUE(bench.take_sent().empty());
  bench.wait(1_us);
  EXPECT_EQ(bench.take_count(0x185), 1U) << "the event timer, 50 ms after the change";
}

TEST(TransmitPdo, InhibitTime_HoldsWhateverIsReconfigured) {
  RunningBench bench;
  bench.set_parameter(3, 100);  // 10 ms
  bench.wait(10_ms);
  bench.change(1);
  bench.take_sent();
  bench.wait(1_ms);
  const auto expect_later = [&bench](const char* what) {
    bench.wait(7_ms);
    EXPECT_EQ(bench.take_count(0x185), 0U) << what;
    bench.wait(2_ms);
    EXPECT_EQ(bench.take_count(0x185), 1U) << what;
    bench.wait(1_ms);
  };
  bench.write(0x1800, 2, 254);
  expect_later("another type is an event");
  bench.write(0x1800, 1, 0x80000185);
  bench.wait(0_ns);
  bench.write(0x1800, 1, 0x185);
  expect_later("switched off and on again");
  bench.enter(NmtState::pre_operational);
  bench.operational();
  expect_later("Operational again");
  bench.write(0x1800, 1, 0x80000185);
  bench.wait(0_ns);
  bench.write(0x1800, 3, 150);
  bench.write(0x1800, 1, 0x185);
  bench.wait(13_ms);
  EXPECT_EQ(bench.take_count(0x185), 0U) << "a longer time counts from the last transmission too";
  bench.wait(1_ms);
  EXPECT_EQ(bench.take_count(0x185), 1U);
}

TEST(TransmitPdo, InhibitTime_EndsWithTheResetOfTheNode) {
  RunningBench bench;
  bench.set_parameter(3, 100);
  bench.change(1);
  bench.take_sent();
  bench.start();
  bench.operational();
  EXPECT_EQ(bench.take_count(0x185), 1U);
}

TEST(TransmitPdo, NewEventTimer_CountsFromTheWriteAndIsNoEvent) {
  RunningBench bench;
  bench.wait(1_s);
  bench.write(0x1800, 5, 100);
  bench.wait(99_ms);
  EXPECT_EQ(bench.take_count(0x185), 0U);
  bench.wait(1_ms);
  EXPECT_EQ(bench.take_count(0x185), 1U);
  bench.write(0x1800, 5, 0);
  bench.wait(1_s);
  EXPECT_EQ(bench.take_count(0x185), 0U);
}

TEST(TransmitPdo, WritesOfTheSameValues_LetTheSyncsCountOn) {
  RunningBench bench;
  bench.set_parameter(2, 3);
  bench.send_sync();
  bench.send_sync();
  for (const std::uint8_t subindex : kWritable) {
    EXPECT_EQ(bench.write(0x1800, subindex, bench.value(0x1800, subindex)), 0U);
  }
  bench.take_sent();
  bench.send_sync();
  EXPECT_EQ(bench.take_count(0x185), 1U);
}

TEST(TransmitPdo, WritesToOnePdo_LeaveTheOthersAlone) {
  RunningBench bench;
  bench.set_parameter(2, 2);
  bench.send_sync();
  bench.take_sent();
  bench.reconfigure(0x1801, {0x20110010}, 1);
  bench.reconfigure(0x1400, {0x20020010}, 1);
  EXPECT_EQ(bench.take_count(0x185), 0U);
  bench.send_sync();
  EXPECT_EQ(bench.take_count(0x185), 1U) << "the second of two";
}

TEST(TransmitPdo, EventTimer_IsTheLongestTimeBetweenTransmissions) {
  RunningBench bench;
  bench.set_parameter(5, 250);
  bench.wait(1_s);
  EXPECT_EQ(bench.take_count(0x185), 4U);
  bench.wait(100_ms);
  bench.change(1);
  EXPECT_EQ(bench.take_count(0x185), 1U);
  bench.wait(249_ms);
  EXPECT_EQ(bench.take_count(0x185), 0U) << "it begins anew with each transmission";
  bench.wait(1_ms);
  EXPECT_EQ(bench.take_count(0x185), 1U);
}

TEST(TransmitPdo, TypeOne_IsSentWithEachSync) {
  RunningBench bench;
  bench.set(0x2011, 0, 3);
  bench.set(0x2012, 0, 4);
  bench.send_sync();
  EXPECT_EQ(bench.take_sent().front(), can::data_frame(0x385, {3, 0, 4, 0, 0, 0}));
  bench.send_sync();
  EXPECT_EQ(bench.take_count(0x385), 1U);
}

TEST(TransmitPdo, TypeN_IsSentWithEachNthSync) {
  RunningBench bench;
  bench.set_parameter(2, 3);
  for (int sync = 1; sync <= 9; ++sync) {
    bench.send_sync();
    EXPECT_EQ(bench.take_count(0x185), sync % 3 == 0 ? 1U : 0U) << sync;
  }
}

TEST(TransmitPdo, TypeZero_AnswersAnEventAtTheNextSync) {
  RunningBench bench;
  bench.send_sync();
  EXPECT_EQ(bench.take_count(0x485), 1U) << "the start is an event";
  bench.send_sync();
  EXPECT_EQ(bench.take_count(0x485), 0U);
  bench.set(0x2010, 0, 1);
  bench.pdos.values_may_have_changed(bench.now);
  EXPECT_EQ(bench.take_count(0x485), 0U);
  bench.send_sync();
  EXPECT_EQ(bench.take_count(0x485), 1U);
}

TEST(TransmitPdo, TypeZero_TakesAReconfigurationForAnEvent) {
  RunningBench bench;
  bench.send_sync();
  bench.reconfigure(0x1803, {0x20120020}, 0);
  bench.take_sent();
  bench.send_sync();
  EXPECT_EQ(bench.take_count(0x485), 1U);
}

TEST(TransmitPdo, SyncStartValue_IsWaitedFor) {
  RunningBench bench;
  bench.write(0x1019, 0, 10);
  bench.set_parameter(6, 4);
  bench.set_parameter(2, 2);
  for (unsigned counter = 1; counter <= 10; ++counter) {
    bench.receive(can::data_frame(0x80, {counter}));
    const bool due = counter >= 4 && counter % 2 == 0;
    EXPECT_EQ(bench.take_count(0x185), due ? 1U : 0U) << counter;
  }
}

TEST(TransmitPdo, RemoteFrame_IsAnsweredWhereBit30AllowsIt) {
  RunningBench bench;
  EXPECT_TRUE(bench.receive(can::remote_frame(0x185)));
  EXPECT_EQ(bench.take_count(0x185), 1U);
  EXPECT_FALSE(bench.receive(can::remote_frame(0x485))) << "bit 30 is set";
  EXPECT_EQ(bench.take_count(0x485), 0U);
}

TEST(TransmitPdo, Type253_IsSentOnRequestOnly) {
  RunningBench bench;
  bench.set_parameter(2, 253);
  bench.change(7);
  bench.send_sync();
  EXPECT_EQ(bench.take_count(0x185), 0U);
  bench.receive(can::remote_frame(0x185));
  EXPECT_EQ(bench.take_sent(), std::vector{can::data_frame(0x185, {7, 0})});
}

TEST(TransmitPdo, Type252_AnswersWithWhatWasSampledAtTheSync) {
  RunningBench bench;
  bench.set_parameter(2, 252);
  bench.set(0x2011, 0, 1);
  bench.send_sync();
  bench.set(0x2011, 0, 2);
  bench.take_sent();
  bench.receive(can::remote_frame(0x185));
  EXPECT_EQ(bench.take_sent(), std::vector{can::data_frame(0x185, {1, 0})});
}

TEST(TransmitPdo, TransmissionTypes_AreThoseOfTheProduct) {
  ServiceBench standard;
  ServiceBench product(kTmcc160Pdos);
  for (unsigned type = 0; type <= 255; ++type) {
    const bool of_standard = type <= 240 || type >= 252;
    const bool of_product = type <= 1 || type >= 254;
    EXPECT_EQ(standard.write(0x1800, 2, type), of_standard ? 0 : kRangeExceeded) << type;
    EXPECT_EQ(product.write(0x1800, 2, type), of_product ? 0 : kRangeExceeded) << type;
  }
}

TEST(TransmitPdo, InhibitTimeOfSynchronousPdos_PassesASyncOverWhereTheProductSaysSo) {
  for (const bool respected : {false, true}) {
    PdoRules rules;
    rules.inhibit_synchronous = respected;
    RunningBench bench(rules);
    bench.set_parameter(2, 1);
    bench.set_parameter(3, 100);  // 10 ms
    bench.wait(10_ms);
    std::size_t sent = 0;
    for (int sync = 0; sync < 4; ++sync) {
      bench.send_sync();
      sent += bench.take_count(0x185);
      bench.wait(6_ms);
    }
    EXPECT_EQ(sent, respected ? 2U : 4U);
  }
}

TEST(TransmitPdo, RequestOfTheApplication_IsAnEvent) {
  RunningBench bench;
  bench.pdos.request(0, bench.now);
  EXPECT_EQ(bench.take_count(0x185), 1U);
  bench.pdos.request(3, bench.now);
  bench.send_sync();
  EXPECT_EQ(bench.take_count(0x485), 1U);
}

TEST(TransmitPdo, SampledAtASync_BelongsToTheMomentBeforeReceivedValuesTakeEffect) {
  ServiceBench bench;
  bench.operational();
  bench.take_sent();
  bench.receive(0x405, {9, 0, 0, 0, 0, 0});
  struct Echo {
    ServiceBench& bench;
    void copy(base::SimTime /*now*/) { bench.set(0x2011, 0, bench.value(0x2002)); }
  } echo{bench};
  bench.pdos.set_process_data_hook(PdoService::ProcessDataHook::bind<&Echo::copy>(echo));
  bench.send_sync();
  EXPECT_EQ(bench.take_sent().front(), can::data_frame(0x385, {0, 0, 0, 0, 0, 0}));
  bench.send_sync();
  EXPECT_EQ(bench.take_sent().front(), can::data_frame(0x385, {9, 0, 0, 0, 0, 0}));
}

TEST(TransmitPdo, FullTransmitBuffer_IsCounted) {
  RunningBench bench;
  bench.transmitter.full = true;
  bench.change(1);
  EXPECT_EQ(bench.pdos.transmit_pdos()[0].lost(), 1U);
  EXPECT_EQ(bench.pdos.transmit_pdos()[0].sent(), 1U) << "that of the start";
}

}  // namespace
}  // namespace stator::canopen
