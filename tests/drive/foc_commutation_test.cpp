// The search for the commutation against the registers of the block alone (reading A-60).

#include "stator/drive/foc/foc_commutation.hpp"

#include <cstdint>

#include <gtest/gtest.h>

#include "drive/foc_bench.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;
using control::foc::field;

class FocCommutationRegisters : public testing::Test {
 protected:
  static constexpr std::int32_t kCurrent = 1000;
  static constexpr std::int32_t kQuarterTurn = 16384;

  static CommutationSettings by(CommutationMethod method, std::uint8_t source = 3) {
    CommutationSettings settings;
    settings.method = method;
    settings.source = source;
    settings.hold_time = 10_ms;
    return settings;
  }
  void start(const CommutationSettings& settings) {
    commutation_.start(settings, kCurrent, base::SimTime());
  }
  void set_offset(const control::foc::Field& offset, std::int32_t value) {
    block_.set(offset, value);
    block_.step({});
  }
  /// The whole search by bang-bang; a change of `offset` stands for the shaft that turns.
  void pull_to_zero(std::uint8_t source, const control::foc::Field& offset) {
    set_offset(offset, 3000);
    start(by(CommutationMethod::bang_bang, source));
    commutation_.advance(base::SimTime() + 10_ms);
    set_offset(offset, 3000 + kQuarterTurn);
    commutation_.advance(base::SimTime() + 20_ms);
    block_.step({});
  }

  control::foc::FocBlock block_;
  FocCommutation commutation_{block_};
};

TEST_F(FocCommutationRegisters, NeedNoSearchForADirectCurrentMotor) {
  block_.set(field("MOTOR_TYPE"), 1);
  start(by(CommutationMethod::bang_bang));
  EXPECT_TRUE(commutation_.known());
  EXPECT_EQ(block_.get(field("PHI_E_SELECTION")), 3);
  EXPECT_EQ(block_.get(field("PID_FLUX_TARGET")), 0) << "no current";
}

TEST_F(FocCommutationRegisters, NeedNoSearchForASourceThatIsNoEncoder) {
  block_.set(field("MOTOR_TYPE"), 3);
  start(by(CommutationMethod::bang_bang, 5));
  EXPECT_TRUE(commutation_.known());
  EXPECT_EQ(block_.get(field("PHI_E_SELECTION")), 5);
}

TEST_F(FocCommutationRegisters, AreSearchedAgainWhenMethodOrSourceHasChanged) {
  block_.set(field("MOTOR_TYPE"), 3);
  start(by(CommutationMethod::none, 3));
  ASSERT_TRUE(commutation_.known());
  start(by(CommutationMethod::bang_bang, 3));
  EXPECT_TRUE(commutation_.active()) << "another method";
  commutation_.stop();

  commutation_.forget();
  start(by(CommutationMethod::none, 3));
  start(by(CommutationMethod::none, 6));
  EXPECT_EQ(block_.get(field("PHI_E_SELECTION")), 6) << "another encoder";
}

TEST_F(FocCommutationRegisters, AreUnknownAgainOnceForgotten) {
  start(by(CommutationMethod::none));
  ASSERT_TRUE(commutation_.known());
  commutation_.forget();
  EXPECT_FALSE(commutation_.known());
  block_.set(field("MOTOR_TYPE"), 3);
  start(by(CommutationMethod::bang_bang));
  commutation_.stop();
  EXPECT_FALSE(commutation_.active()) << "given up";
}

TEST_F(FocCommutationRegisters, OfBangBangHoldACurrentInDAndNoneInQ) {
  block_.set(field("MOTOR_TYPE"), 3);
  block_.set(field("PID_TORQUE_TARGET"), 500);  // what the last mode of operation left
  start(by(CommutationMethod::bang_bang));
  EXPECT_EQ(block_.get(field("PID_FLUX_TARGET")), kCurrent);
  EXPECT_EQ(block_.get(field("PID_TORQUE_TARGET")), 0);
}

TEST_F(FocCommutationRegisters, OfBangBangGoToTheSecondAngleWhenTheHoldTimeIsOver) {
  block_.set(field("MOTOR_TYPE"), 3);
  start(by(CommutationMethod::bang_bang));
  commutation_.advance(base::SimTime() + 10_ms - base::SimDuration(1));
  EXPECT_EQ(block_.get(field("PHI_E_EXT")), -kQuarterTurn);
  commutation_.advance(base::SimTime() + 10_ms);
  EXPECT_EQ(block_.get(field("PHI_E_EXT")), 0);
}

TEST_F(FocCommutationRegisters, OfBangBangShiftTheOffsetOfTheEncoderInUseOnly) {
  block_.set(field("MOTOR_TYPE"), 3);
  const auto analog_electrical = field("AENC_DECODER_PHI_E_OFFSET");
  const auto analog_mechanical = field("AENC_DECODER_PHI_A_OFFSET");

  pull_to_zero(6, analog_electrical);
  EXPECT_TRUE(commutation_.known());
  EXPECT_EQ(block_.get(field("AENC_DECODER_PHI_E")), 0);
  EXPECT_EQ(block_.get(analog_mechanical), 0);
  EXPECT_EQ(block_.get(field("ABN_DECODER_PHI_E_OFFSET")), 0);

  const std::int32_t electrical = block_.get(analog_electrical);
  pull_to_zero(7, analog_mechanical);
  EXPECT_TRUE(commutation_.known());
  EXPECT_EQ(block_.get(field("AENC_DECODER_PHI_A")), 0);
  EXPECT_EQ(block_.get(analog_electrical), electrical);
}

TEST_F(FocCommutationRegisters, OfMinimalMovementAreAsTheyWereAfterwards) {
  block_.set(field("MOTOR_TYPE"), 3);
  block_.set(field("UD_EXT"), 77);
  block_.set(field("UQ_EXT"), -55);
  start(by(CommutationMethod::minimal_movement));
  EXPECT_EQ(block_.get(field("UQ_EXT")), 0) << "only D is fed";
  commutation_.stop();
  EXPECT_EQ(block_.get(field("UD_EXT")), 77);
  EXPECT_EQ(block_.get(field("UQ_EXT")), -55);
}

TEST(FocCommutationByHalls, HandsTheAngleOverAnewAtEachSearch) {
  FocBench bench;
  bench.axis->foc_settings().commutation.method = CommutationMethod::halls;
  for (const std::int32_t wrong : {12'345, -20'000}) {
    bench.block.set(field("ABN_DECODER_PHI_E_OFFSET"), wrong);
    bench.axis->forget_commutation();
    bench.enable(ModeCode::profile_velocity);
    bench.write(0x60FF, 300);
    bench.pass(300_ms);
    EXPECT_EQ(bench.get(field("PHI_E_SELECTION")), 3);
    EXPECT_NEAR(bench.commutation_error(), 0.0, 5.0) << wrong;
    bench.write(0x60FF, 0);
    bench.pass(300_ms);
    bench.write(0x6040, 0);
    bench.pass(5_ms);
  }
}

}  // namespace
}  // namespace stator::drive
