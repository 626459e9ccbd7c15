// The state machine of the touch probes, edge by edge.

#include "stator/drive/foc/touch_probe.hpp"

#include <array>
#include <cstdint>

#include <gtest/gtest.h>

namespace stator::drive {
namespace {

constexpr std::array<std::int16_t, 2> kInputs{1, 2};

class TouchProbes : public testing::Test {
 protected:
  /// A period with probe inputs at these levels, 1000 ns and 10 units after the one before.
  void see(bool first, bool second = false, bool index = false) {
    now_ += base::SimDuration(1000);
    position_ += 10;
    probe_.observe({.input = {first, second},
                    .index = index,
                    .position = position_,
                    .index_position = position_ - 3,
                    .now = now_});
  }
  TouchProbe probe_;
  base::SimTime now_;
  std::int64_t position_ = 0;
};

TEST_F(TouchProbes, DoNothingUntilTheyAreEnabled) {
  EXPECT_FALSE(probe_.armed());
  probe_.configure(0x0030, kInputs);  // edges without enable
  EXPECT_FALSE(probe_.armed());
  see(false);
  see(true);
  EXPECT_EQ(probe_.status(), 0x0000);
  probe_.configure(0x0001, kInputs);  // enable without edges
  EXPECT_FALSE(probe_.armed());
  EXPECT_EQ(probe_.status(), 0x0001);
}

TEST_F(TouchProbes, FirstPositiveEdgeIsStoredOnce) {
  probe_.configure(0x0011, kInputs);
  EXPECT_TRUE(probe_.armed());
  see(false);
  see(true);  // at 20, 2000 ns
  EXPECT_EQ(probe_.status(), 0x0003);
  EXPECT_FALSE(probe_.armed());
  see(false);
  see(true);
  EXPECT_EQ(probe_.positive(0).position, 20);
  EXPECT_EQ(probe_.positive(0).time, 2000U);
  EXPECT_EQ(probe_.negative(0).position, 0);
}

TEST_F(TouchProbes, BothEdgesAreStoredApart) {
  probe_.configure(0x0031, kInputs);
  see(false);
  see(true);
  EXPECT_TRUE(probe_.armed());
  see(true);
  see(false);
  EXPECT_EQ(probe_.status(), 0x0007);
  EXPECT_EQ(probe_.positive(0).position, 20);
  EXPECT_EQ(probe_.negative(0).position, 40);
  EXPECT_EQ(probe_.negative(0).time, 4000U);
}

TEST_F(TouchProbes, ALevelThatIsThereAlreadyIsNoEdge) {
  probe_.configure(0x0011, kInputs);
  see(true);
  see(true);
  EXPECT_EQ(probe_.status(), 0x0001);
  see(false);
  see(true);
  EXPECT_EQ(probe_.status(), 0x0003);
}

TEST_F(TouchProbes, ContinuousStoresEveryEdgeAndToggles) {
  probe_.configure(0x0013, kInputs);
  see(false);
  see(true);
  EXPECT_EQ(probe_.status(), 0x0043);
  see(false);
  EXPECT_EQ(probe_.status(), 0x0043);
  see(true);
  EXPECT_EQ(probe_.status(), 0x0003);
  EXPECT_EQ(probe_.positive(0).position, 40);
  EXPECT_TRUE(probe_.armed());
}

TEST_F(TouchProbes, TakingABitBackClearsWhatItHadStoredAndAllowsTheNext) {
  probe_.configure(0x0031, kInputs);
  see(false);
  see(true);
  see(false);
  EXPECT_EQ(probe_.status(), 0x0007);
  probe_.configure(0x0021, kInputs);
  EXPECT_EQ(probe_.status(), 0x0005);
  probe_.configure(0x0031, kInputs);
  EXPECT_TRUE(probe_.armed());
  see(true);
  EXPECT_EQ(probe_.status(), 0x0007);
  EXPECT_EQ(probe_.positive(0).position, 40);
  probe_.configure(0x0000, kInputs);
  EXPECT_EQ(probe_.status(), 0x0000);
  EXPECT_EQ(probe_.positive(0).position, 40) << "the value stays to be read";
  probe_.configure(0x0011, kInputs);
  see(true);
  EXPECT_EQ(probe_.status(), 0x0001) << "the level from before is no edge";
}

TEST_F(TouchProbes, TheSecondProbeHasTheUpperByteAndItsOwnInput) {
  probe_.configure(0x2111, kInputs);
  see(false, true);
  see(true, true);
  EXPECT_EQ(probe_.status(), 0x0103);
  see(true, false);
  EXPECT_EQ(probe_.status(), 0x0503);
  EXPECT_EQ(probe_.negative(1).position, 30);
  EXPECT_EQ(probe_.negative(1).time, 3000U);
}

TEST_F(TouchProbes, IndexPulsesHaveAPlaceOfTheirOwn) {
  probe_.configure(0x0015, kInputs);
  EXPECT_TRUE(probe_.waits_for_index());
  see(true);
  EXPECT_EQ(probe_.status(), 0x0001);
  see(false, false, true);
  EXPECT_EQ(probe_.status(), 0x0003);
  EXPECT_EQ(probe_.positive(0).position, 17);
  EXPECT_FALSE(probe_.waits_for_index());
  probe_.configure(0x0025, kInputs);
  EXPECT_FALSE(probe_.armed()) << "it has no negative edge";
}

TEST_F(TouchProbes, SourcesAreChosenBy60D0h) {
  probe_.configure(0x1919, {2, 5});
  see(false);
  see(true);
  EXPECT_EQ(probe_.status(), 0x0101) << "input 1 is nobody's source";
  see(true, true);
  EXPECT_EQ(probe_.status(), 0x0103);
  see(true, true, true);
  EXPECT_EQ(probe_.status(), 0x0303);
  probe_.configure(0x0019, {7, 7});
  EXPECT_FALSE(probe_.armed()) << "no such source";
}

TEST_F(TouchProbes, ValuesAreTheLowerBitsOfPositionAndTime) {
  now_ = base::SimTime(base::SimDuration(5'000'000'000));
  position_ = (std::int64_t{1} << 32U) + 100;
  probe_.configure(0x0011, kInputs);
  see(false);
  see(true);
  EXPECT_EQ(probe_.positive(0).position, 120);
  EXPECT_EQ(probe_.positive(0).time, 5'000'002'000U - 4'294'967'296U);
}

}  // namespace
}  // namespace stator::drive
