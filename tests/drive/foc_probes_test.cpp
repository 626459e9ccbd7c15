// Which object shows what of the two touch probes, where their signals come from, and what probes
// leave alone (60B8h to 60BDh, 60D0h to 60D4h).

#include <array>
#include <cstdint>

#include <gtest/gtest.h>

#include "drive/foc_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;
using control::foc::field;

class FocProbes : public testing::Test {
 protected:
  void turn() {
    bench_.enable(ModeCode::profile_velocity);
    bench_.write(0x60FF, 600);
    bench_.pass(300_ms);
  }
  /// Changes an input and returns when the axis sees it.
  std::int64_t change(std::size_t input, bool level) {
    bench_.probe[input] = level;
    bench_.step();
    const std::int64_t seen = bench_.now.nanoseconds();
    bench_.pass(1_ms);
    return seen;
  }
  void configure(std::int64_t function) {
    bench_.write(0x60B8, function);
    bench_.pass(1_ms);
  }
  FocBench bench_;
};

TEST_F(FocProbes, EachEdgeOfEachProbeHasObjectsOfItsOwn) {
  turn();
  configure(0x3131);
  const std::int64_t positive_1 = change(0, true);
  const std::int64_t positive_2 = change(1, true);
  const std::int64_t negative_1 = change(0, false);
  const std::int64_t negative_2 = change(1, false);
  EXPECT_EQ(bench_.read(0x60B9), 0x0707);
  EXPECT_EQ(bench_.read(0x60D1), positive_1);
  EXPECT_EQ(bench_.read(0x60D2), negative_1);
  EXPECT_EQ(bench_.read(0x60D3), positive_2);
  EXPECT_EQ(bench_.read(0x60D4), negative_2);
  EXPECT_GT(bench_.read(0x60BA), 0);
  EXPECT_GT(bench_.read(0x60BC), bench_.read(0x60BA));
  EXPECT_GT(bench_.read(0x60BB), bench_.read(0x60BC));
  EXPECT_GT(bench_.read(0x60BD), bench_.read(0x60BB));
}

TEST_F(FocProbes, TakeTheInputThat60D0hNames) {
  bench_.write(0x60D0, 1, 2);
  bench_.write(0x60D0, 2, 1);
  configure(0x1919);
  change(1, true);
  EXPECT_EQ(bench_.read(0x60B9), 0x0103) << "input 2 is the source of probe 1";
  change(0, true);
  EXPECT_EQ(bench_.read(0x60B9), 0x0303);
}

TEST_F(FocProbes, EndWithTheirFunctionAlsoWhere60D0hNamesNoSource) {
  bench_.write(0x60D0, 1, 0);
  bench_.write(0x60D0, 2, 0);
  configure(0x0011);
  EXPECT_EQ(bench_.read(0x60B9), 0x0001);
  configure(0x0000);
  EXPECT_EQ(bench_.read(0x60B9), 0x0000);
}

TEST_F(FocProbes, LeaveTheFlagOfTheIndexPulseAloneUnlessTheyWaitForOne) {
  turn();
  bench_.write(0x60FF, 0);
  bench_.pass(300_ms);
  ASSERT_EQ(bench_.get(field("ENC_N")), 1);
  configure(0x0010);  // an edge is chosen, the probe is off
  EXPECT_EQ(bench_.get(field("ENC_N")), 1);
}

TEST_F(FocProbes, SeeAnIndexPulseOfAnEncoderWithoutAResolution) {
  configure(0x0015);
  bench_.block.set(field("ABN_DECODER_PPR"), 0);
  bench_.plant.set_external_torque(0.01);
  EXPECT_TRUE(bench_.pass_until([&] { return (bench_.read(0x60B9) & 2) != 0; }, 1_s));
}

TEST_F(FocProbes, TorqueDemandOfADisabledDriveIsZero) {
  bench_.write(0x6087, 0);
  bench_.enable(ModeCode::profile_torque);
  bench_.write(0x6071, 500);
  bench_.pass(5_ms);
  ASSERT_EQ(bench_.read(0x6074), 500);
  bench_.write(0x6040, 0);
  bench_.pass(5_ms);
  EXPECT_EQ(bench_.read(0x6074), 0);
}

}  // namespace
}  // namespace stator::drive
