#include "stator/control/motion_controller/encoder_interface.hpp"

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/control/motion_controller/motion_controller_settings.hpp"

namespace stator::control::motion_controller {
namespace {

using namespace encoder_mode;

/// An encoder with an N mark at count 100, one count wide, A and B high there.
class Encoder {
 public:
  explicit Encoder(std::uint32_t mode, std::uint32_t constant = 65'536) {
    interface.set_constant(constant);
    interface.set_mode(mode);
    interface.sample(sensing);
  }
  /// Turns to `count`, in one go as far as the interface sees.
  void turn_to(std::int64_t count) {
    const std::int64_t before = sensing.encoder_count;
    sensing.encoder_count = count;
    if ((before < 100 && count >= 100) || (before > 100 && count <= 100)) {
      ++sensing.encoder_index_passages;
      sensing.encoder_index_count = 100;
    }
    sensing.encoder_index = count == 100;
    interface.sample(sensing);
  }

  base::AxisSensing sensing;
  EncoderInterface interface;
};

TEST(EncoderInterface, BinaryConstantCountsIn65536ths) {
  Encoder encoder(0, 6'710'886);  // 102.4 microsteps a count, nearly
  encoder.turn_to(1);
  EXPECT_EQ(encoder.interface.position(), 102);
  encoder.turn_to(4'000);
  EXPECT_EQ(encoder.interface.position(), 409'599);  // 4000 * 6710886 / 65536 = 409599.98
  encoder.turn_to(0);
  EXPECT_EQ(encoder.interface.position(), 0);
}

TEST(EncoderInterface, DecimalConstantCountsInTenThousandths) {
  Encoder encoder(kDecimal, (102U << 16U) + 4'000U);
  encoder.turn_to(1);
  EXPECT_EQ(encoder.interface.position(), 102);
  encoder.turn_to(5);
  EXPECT_EQ(encoder.interface.position(), 512);
  encoder.turn_to(4'000);
  EXPECT_EQ(encoder.interface.position(), 409'600);
  encoder.turn_to(-1);
  EXPECT_EQ(encoder.interface.position(), -103) << "the remainder counts up from the floor";
}

TEST(EncoderInterface, RemaindersNeverDrift) {
  base::Random random(42);
  for (const std::uint32_t mode : {0U, kDecimal}) {
    const std::uint32_t constant = mode == 0 ? 838'861U : (12U << 16U) + 8'001U;
    Encoder encoder(mode, constant);
    std::int64_t count = 0;
    for (int i = 0; i < 100'000; ++i) {
      count += static_cast<std::int64_t>(random.below(2'001)) - 1'000;
      encoder.turn_to(count);
      const std::int64_t exact = mode == 0 ? (count * 838'861) >> 16
                                           : (count * 128'001 - (count < 0 ? 9'999 : 0)) / 10'000;
      ASSERT_EQ(encoder.interface.position(), static_cast<std::int32_t>(exact)) << "step " << i;
    }
  }
}

TEST(EncoderInterface, AChangeOfTheBaseKeepsTheRemainder) {
  Encoder encoder(0, 49'152);  // 3/4
  encoder.turn_to(1);
  EXPECT_EQ(encoder.interface.position(), 0);
  encoder.interface.set_mode(kDecimal);
  encoder.interface.set_constant(2'500);
  encoder.turn_to(2);
  EXPECT_EQ(encoder.interface.position(), 1);
}

TEST(EncoderInterface, ThePositionWraps) {
  Encoder encoder(0);
  encoder.interface.set_position(2'147'483'647);
  encoder.turn_to(1);
  EXPECT_EQ(encoder.interface.position(), -2'147'483'648LL);
}

TEST(EncoderInterface, EdgesLatchWhereTheyAre) {
  Encoder positive(kNullActiveHigh | kIgnoreAb | kPositiveEdge, 131'072);
  positive.turn_to(150);
  EXPECT_EQ(positive.interface.latched(), 200);
  EXPECT_EQ(positive.interface.position(), 300) << "latched only";
  Encoder negative(kNullActiveHigh | kIgnoreAb | kNegativeEdge, 131'072);
  negative.turn_to(100);
  EXPECT_FALSE(negative.interface.status());
  negative.turn_to(150);
  EXPECT_EQ(negative.interface.latched(), 202);
  negative.turn_to(100);
  negative.turn_to(90);
  EXPECT_EQ(negative.interface.latched(), 198);
}

TEST(EncoderInterface, WithNeitherEdgeTheLevelIsTheEvent) {
  Encoder encoder(kNullActiveHigh | kIgnoreAb);
  encoder.turn_to(100);
  EXPECT_TRUE(encoder.interface.read_status());
  encoder.turn_to(100);
  EXPECT_TRUE(encoder.interface.read_status()) << "still active";
  encoder.turn_to(101);
  EXPECT_FALSE(encoder.interface.read_status());
  encoder.turn_to(99);
  EXPECT_TRUE(encoder.interface.read_status()) << "passed in between";
  EXPECT_EQ(encoder.interface.latched(), 100);
}

TEST(EncoderInterface, AnInvertedNullChannelHasItsEdgesTheOtherWay) {
  // Active low: the mark is the inactive part.
  Encoder positive(kIgnoreAb | kPositiveEdge);
  positive.turn_to(100);
  EXPECT_FALSE(positive.interface.status());
  positive.turn_to(101);
  EXPECT_TRUE(positive.interface.status());
  EXPECT_EQ(positive.interface.latched(), 101);
  Encoder negative(kIgnoreAb | kNegativeEdge);
  negative.turn_to(99);
  EXPECT_FALSE(negative.interface.status());
  negative.turn_to(100);
  EXPECT_TRUE(negative.interface.status());
}

TEST(EncoderInterface, AAndBMustHaveTheirLevels) {
  for (std::uint32_t levels = 0; levels < 4; ++levels) {
    Encoder encoder(kNullActiveHigh | kPositiveEdge | levels);
    encoder.turn_to(150);
    EXPECT_EQ(encoder.interface.status(), levels == (kChannelA | kChannelB)) << levels;
  }
  Encoder low(kNegativeEdge | kPositiveEdge);  // active while N, A and B are low
  low.turn_to(150);                            // (150 - 100) & 3 = 2
  EXPECT_TRUE(low.interface.read_status());
  low.turn_to(150);
  EXPECT_FALSE(low.interface.read_status());
  low.turn_to(151);
  EXPECT_TRUE(low.interface.read_status());
}

TEST(EncoderInterface, StatusIsClearedByReadingAndTheLatchStays) {
  Encoder encoder(kNullActiveHigh | kIgnoreAb | kPositiveEdge);
  encoder.turn_to(120);
  EXPECT_TRUE(encoder.interface.status());
  EXPECT_TRUE(encoder.interface.read_status());
  EXPECT_FALSE(encoder.interface.read_status());
  EXPECT_EQ(encoder.interface.latched(), 100);
}

TEST(EncoderInterface, EveryNullEventClearsWithBit8) {
  Encoder encoder(kNullActiveHigh | kIgnoreAb | kPositiveEdge | kClearOnNull | kClearContinuously);
  encoder.interface.set_position(1'000);
  encoder.turn_to(130);
  EXPECT_EQ(encoder.interface.latched(), 1'100);
  EXPECT_EQ(encoder.interface.position(), 30);
  encoder.turn_to(80);
  EXPECT_EQ(encoder.interface.latched(), 0);
  EXPECT_EQ(encoder.interface.position(), -20);
}

TEST(EncoderInterface, ClearsOnceAndTakesTheBitBack) {
  const std::uint32_t mode = kNullActiveHigh | kIgnoreAb | kPositiveEdge | kClearOnNull;
  Encoder encoder(mode | kClearOnce);
  encoder.turn_to(130);
  EXPECT_EQ(encoder.interface.position(), 30);
  EXPECT_EQ(encoder.interface.mode(), mode);
  encoder.interface.set_position(500);
  encoder.turn_to(80);
  EXPECT_EQ(encoder.interface.position(), 450) << "later events only latch";
  EXPECT_EQ(encoder.interface.latched(), 470);
  encoder.interface.set_mode(mode | kClearOnce);
  encoder.turn_to(130);
  EXPECT_EQ(encoder.interface.position(), 30);
}

TEST(EncoderInterface, BitsThatAskForClearingNeedBit8) {
  Encoder encoder(kNullActiveHigh | kIgnoreAb | kPositiveEdge | kClearOnce | kClearContinuously);
  encoder.turn_to(130);
  EXPECT_EQ(encoder.interface.position(), 130);
  EXPECT_EQ(encoder.interface.latched(), 100);
}

TEST(EncoderInterface, TheFirstLookMakesNoEvent) {
  EncoderInterface interface;
  interface.set_mode(kNullActiveHigh | kIgnoreAb | kPositiveEdge);
  base::AxisSensing sensing;
  sensing.encoder_count = 5'000;
  sensing.encoder_index_passages = 7;
  sensing.encoder_index_count = 4'900;
  interface.sample(sensing);
  EXPECT_FALSE(interface.status());
  EXPECT_EQ(interface.position(), 0);
}

}  // namespace
}  // namespace stator::control::motion_controller
