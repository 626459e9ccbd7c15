// The microstep table, a rounded sine of amplitude 248, and the direction of the current vector for
// each position.
#include "stator/control/stepper/microstep_sequencer.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "stator/base/trigonometry.hpp"

namespace stator::control {
namespace {

TEST(MicrostepSequencer, TableIsARoundedSineOfAmplitude248) {
  for (int i = 0; i < MicrostepSequencer::kTableSize; ++i) {
    const double exact = 248.0 * base::sine_cosine(base::kTwoPi * i / 1024.0).sine;
    ASSERT_LE(std::fabs(MicrostepSequencer::sine_entry(i) - exact), 0.5 + 1e-9) << "entry " << i;
  }
}

TEST(MicrostepSequencer, PositionZeroDrivesPhaseAAlone) {
  const MicrostepSequencer sequencer;
  const auto currents = sequencer.coil_currents(0, 3.0);
  EXPECT_EQ(currents[0], 3.0);
  EXPECT_EQ(currents[1], 0.0);
}

TEST(MicrostepSequencer, CurrentVectorTurnsForwardAQuarterPeriodPerFullStep) {
  const MicrostepSequencer sequencer;  // 256 microsteps per full step
  EXPECT_EQ(sequencer.coil_currents(256, 1.0), (std::array{0.0, 1.0}));
  EXPECT_EQ(sequencer.coil_currents(512, 1.0), (std::array{-1.0, 0.0}));
  EXPECT_EQ(sequencer.coil_currents(768, 1.0), (std::array{0.0, -1.0}));
  EXPECT_EQ(sequencer.coil_currents(-256, 1.0), (std::array{0.0, -1.0}));
}

TEST(MicrostepSequencer, ResolutionScalesMicrostepsToTheTable) {
  MicrostepSequencer sequencer;
  for (int resolution = 0; resolution <= 8; ++resolution) {
    sequencer.set_resolution(static_cast<std::uint8_t>(resolution));
    const int per_period = 4 << resolution;
    EXPECT_EQ(sequencer.table_index(1), 1024 / per_period) << "2^" << resolution;
    EXPECT_EQ(sequencer.table_index(per_period), 0) << "2^" << resolution;
    EXPECT_EQ(sequencer.table_index(-1), 1024 - 1024 / per_period) << "2^" << resolution;
  }
}

TEST(MicrostepSequencer, ResolutionAbove256MicrostepsIsCutTo256) {
  MicrostepSequencer sequencer;
  sequencer.set_resolution(11);
  EXPECT_EQ(sequencer.resolution(), 8);
}

TEST(MicrostepSequencer, IndexIsRightFarFromZero) {
  const MicrostepSequencer sequencer;
  const std::int64_t far = (std::int64_t{1} << 60) + 3;
  EXPECT_EQ(sequencer.table_index(far), 3);
  EXPECT_EQ(sequencer.table_index(-far), 1021);
}

}  // namespace
}  // namespace stator::control
