// The master's process image, and cycles that are lost or come back with a wrong working counter.
#include "stator/master/process_data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/simulated_segment.hpp"
#include "stator/master/master.hpp"

namespace stator::master {
namespace {

using ethercat::AlState;
using test::SimulatedSegment;
using namespace base::literals;

SlaveProcessData process_data(std::size_t outputs, std::size_t inputs) {
  SlaveProcessData data;
  data.outputs.bytes = outputs;
  data.inputs.bytes = inputs;
  return data;
}

TEST(ImageLayout, OutputsAndInputsOfASlaveAreNeighboursInOneFrame) {
  const std::vector slaves{process_data(6, 8), process_data(0, 2), process_data(4, 0),
                           process_data(0, 0)};
  const auto layout = lay_out_image(slaves);
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->size, 20U);
  EXPECT_EQ(layout->parts[0].inputs, 6U);
  EXPECT_EQ(layout->parts[1].inputs, 14U);
  EXPECT_EQ(layout->parts[2].outputs, 16U);
  ASSERT_EQ(layout->frames.size(), 1U);
  EXPECT_EQ(layout->frames[0].working_counter, 2 + 1 + 1 + 2);
}

TEST(ImageLayout, AFrameThatIsFullIsFollowedByAnotherWithItsOwnWorkingCounter) {
  const std::vector slaves(50, process_data(30, 30));
  const auto layout = lay_out_image(slaves);
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->size, 3000U);
  ASSERT_EQ(layout->frames.size(), 3U);
  std::size_t covered = 0;
  unsigned working_counters = 0;
  for (const ImageLayout::Frame& frame : layout->frames) {
    EXPECT_EQ(frame.start, covered);
    EXPECT_LE(frame.length + ethercat::kDatagramOverhead * 2 + 8 + ethercat::kFirstDatagramOffset,
              ethercat::kMaximumFrameLength);
    covered += frame.length;
    working_counters += frame.working_counter;
  }
  EXPECT_EQ(covered, 3000U);
  EXPECT_EQ(working_counters, 150U);
}

TEST(ImageLayout, ASlaveTooLargeForAFrameIsRefused) {
  const std::vector slaves{process_data(1, 1), process_data(1000, 1000)};
  const auto layout = lay_out_image(slaves);
  ASSERT_FALSE(layout);
  EXPECT_EQ(layout.error().code, ErrorCode::configuration);
  EXPECT_THAT(layout.error().text, testing::HasSubstr("slave 1 maps 2000 bytes"));
}

class ProcessDataTest : public testing::Test {
 protected:
  void go_operational() {
    ASSERT_TRUE(master.scan());
    const auto configured = master.configure_process_data();
    ASSERT_TRUE(configured) << configured.error().text;
    const auto operational = master.go_operational();
    ASSERT_TRUE(operational) << operational.error().text;
  }

  SimulatedSegment segment{2};
  Master master{segment};
};

TEST_F(ProcessDataTest, TheImageFollowsTheMappingOfTheSlaves) {
  go_operational();
  ASSERT_EQ(master.outputs(1).size(), 6U);
  ASSERT_EQ(master.inputs(1).size(), 6U);
  ASSERT_EQ(master.output_entries(1).size(), 2U);
  EXPECT_EQ(master.output_entries(1)[1].index, 0x607A);
  EXPECT_EQ(master.output_entries(1)[1].bit_offset, 16U);
  EXPECT_EQ(master.output_entries(1)[1].bit_length, 32U);
  EXPECT_EQ(master.input_entries(1)[0].index, 0x6041);
  EXPECT_TRUE(master.outputs(2).empty());
}

TEST_F(ProcessDataTest, AllSlavesReachOperationalAndStayThere) {
  go_operational();
  for (int cycle = 0; cycle < 500; ++cycle) {
    ASSERT_TRUE(master.run_cycle());
  }
  EXPECT_EQ(master.al_status(0)->state, AlState::operational);
  EXPECT_EQ(master.al_status(1)->state, AlState::operational);
  EXPECT_EQ(master.cycle_statistics().lost, 0U);
  EXPECT_EQ(master.cycle_statistics().working_counter_errors, 0U);
}

TEST_F(ProcessDataTest, OutputsReachTheRightSlaveAndInputsComeBack) {
  go_operational();
  base::store_le<std::int32_t>(master.outputs(1), 2, -123456);
  segment.slave(0).drives[0].set_position(111);
  segment.slave(1).drives[0].set_position(222);
  for (int cycle = 0; cycle < 3; ++cycle) {
    ASSERT_TRUE(master.run_cycle());
  }
  EXPECT_EQ(segment.slave(0).dictionary.find(0x607A, 0)->signed_value(), 0);
  EXPECT_EQ(segment.slave(1).dictionary.find(0x607A, 0)->signed_value(), -123456);
  EXPECT_EQ(base::load_le<std::int32_t>(master.inputs(0), 2), 111);
  EXPECT_EQ(base::load_le<std::int32_t>(master.inputs(1), 2), 222);
}

TEST_F(ProcessDataTest, ObjectsCanBeReadWhileProcessDataRun) {
  go_operational();
  const auto cycles = master.cycle_statistics().cycles;
  for (int round = 0; round < 50; ++round) {
    ASSERT_EQ(*master.upload_number<std::uint32_t>(0, {0x1018, 2}), 4711U);
    ASSERT_TRUE(master.run_cycle());
  }
  EXPECT_GT(master.cycle_statistics().cycles, cycles);
  EXPECT_EQ(master.al_status(0)->state, AlState::operational);
}

TEST_F(ProcessDataTest, SingleLostCyclesAreCountedAndTolerated) {
  go_operational();
  segment.lose_answers = 2;
  for (int cycle = 0; cycle < 5; ++cycle) {
    ASSERT_TRUE(master.run_cycle());
  }
  EXPECT_EQ(master.cycle_statistics().lost, 2U);
}

TEST_F(ProcessDataTest, SilenceIsCountedAndToleratedForAsLongAsTheWatchdogsOfTheSlavesStandIt) {
  go_operational();
  segment.lose_answers = 9;
  for (int cycle = 0; cycle < 20; ++cycle) {
    ASSERT_TRUE(master.run_cycle());
  }
  const CycleStatistics& cycles = master.cycle_statistics();
  EXPECT_EQ(cycles.lost, 9U);
  EXPECT_GE(cycles.longest_silence, 90_ms);
  EXPECT_LT(cycles.longest_silence, 91_ms) << "the rest is the time of the frames themselves";
  segment.lose_answers = 2;
  for (int cycle = 0; cycle < 5; ++cycle) {
    ASSERT_TRUE(master.run_cycle());
  }
  EXPECT_EQ(master.cycle_statistics().lost, 11U);
  EXPECT_LT(master.cycle_statistics().longest_silence, 91_ms) << "it was another silence";
  EXPECT_EQ(master.al_status(0)->state, AlState::operational);
}

TEST_F(ProcessDataTest, LongerSilenceIsAnErrorThatSaysHowLongItWas) {
  go_operational();
  segment.lose_requests = 1000;
  const base::SimTime begin = segment.now();
  Result<void> cycle;
  while (cycle && segment.now() - begin < 1_s) {
    cycle = master.run_cycle();
  }
  ASSERT_FALSE(cycle);
  EXPECT_EQ(cycle.error().code, ErrorCode::timeout);
  EXPECT_GE(segment.now() - begin, master.options().patience);
  EXPECT_LT(segment.now() - begin, master.options().patience + 12_ms);
  EXPECT_THAT(cycle.error().text,
              testing::HasSubstr("process data: no frame came back for 100 ms, sent 10 time(s)"));
  EXPECT_THAT(cycle.error().text, testing::HasSubstr("the link is down"));
}

TEST_F(ProcessDataTest, AnswersThatAlwaysComeTooLateAreToldFromNone) {
  go_operational();
  segment.delay_answers = 1000;
  Result<void> cycle;
  for (int i = 0; cycle && i < 100; ++i) {
    cycle = master.run_cycle();
  }
  ASSERT_FALSE(cycle);
  EXPECT_EQ(cycle.error().code, ErrorCode::timeout);
  EXPECT_THAT(cycle.error().text, testing::HasSubstr("but 9 came too late"));
  EXPECT_THAT(cycle.error().text, testing::HasSubstr("too busy"));
}

TEST_F(ProcessDataTest, WithoutPatienceAFewLostCyclesInARowAreAnError) {
  Master impatient{segment, {.patience = {}}};
  ASSERT_TRUE(impatient.scan());
  ASSERT_TRUE(impatient.configure_process_data());
  ASSERT_TRUE(impatient.go_operational());
  segment.lose_requests = 100;
  Result<void> cycle;
  int cycles = 0;
  for (; cycle && cycles < 10; ++cycles) {
    cycle = impatient.run_cycle();
  }
  ASSERT_FALSE(cycle);
  EXPECT_EQ(cycle.error().code, ErrorCode::timeout);
  EXPECT_EQ(cycles, impatient.options().tolerated_lost_cycles + 1);
}

TEST_F(ProcessDataTest, ASlaveThatDropsOutShowsInTheWorkingCounterAndLeavesTheInputsAlone) {
  go_operational();
  segment.slave(0).drives[0].set_position(5);
  ASSERT_TRUE(master.run_cycle());
  ASSERT_TRUE(master.run_cycle());
  ASSERT_EQ(base::load_le<std::int32_t>(master.inputs(0), 2), 5);
  segment.slave(0).drives[0].set_position(99);
  segment.segment().set_link(1, false);
  segment.wait(2_ms);
  const auto exchanged = master.exchange_process_data();
  ASSERT_FALSE(exchanged);
  EXPECT_EQ(exchanged.error().code, ErrorCode::working_counter);
  EXPECT_THAT(exchanged.error().text, testing::HasSubstr("working counter 3 instead of 6"));
  EXPECT_EQ(base::load_le<std::int32_t>(master.inputs(0), 2), 5);
}

TEST_F(ProcessDataTest, WithoutConfigurationOperationalIsRefused) {
  ASSERT_TRUE(master.scan());
  const auto operational = master.go_operational();
  ASSERT_FALSE(operational);
  EXPECT_EQ(operational.error().code, ErrorCode::argument);
  EXPECT_FALSE(master.operational());
}

TEST_F(ProcessDataTest, StoppingLeadsToInit) {
  go_operational();
  ASSERT_TRUE(master.stop());
  segment.wait(5_ms);
  EXPECT_FALSE(master.operational());
  EXPECT_EQ(master.al_status(1)->state, AlState::init);
}

}  // namespace
}  // namespace stator::master
