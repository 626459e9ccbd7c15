// Modes of operation as a master sees them: change of mode, halt, stops and statusword bits in
// each.

#include "devices/tmcm_3315_modes.hpp"

#include <array>
#include <cstdint>

namespace stator::devices {
namespace {

constexpr std::uint16_t kTargetReached = 0x0400;
constexpr std::uint16_t kBit12 = 0x1000;
constexpr std::uint16_t kFollowingError = 0x2000;
constexpr std::uint16_t kMotorActivity = 0x4000;
constexpr std::uint16_t kNegativeDirection = 0x8000;

constexpr std::array<std::int8_t, 4> kMovingModes{1, 3, 8, 9};
constexpr std::array<std::int8_t, 7> kAllModes{1, 3, 6, 8, 9, 10, 0};

// Change of mode

TEST_F(Tmcm3315Modes, AtRestTheModeChangesAtOnceInEveryPowerState) {
  for (const int controlword : {0, 6, 7, 15}) {
    control(0, static_cast<std::uint16_t>(controlword));
    for (const std::int8_t mode : kAllModes) {
      write<std::int8_t>(0x6060, mode);
      EXPECT_EQ(mode_display(), mode) << "controlword " << controlword;
    }
  }
}

TEST_F(Tmcm3315Modes, InMotionTheOldModeSlowsDownBeforeTheNewOneTakesOver) {
  for (const std::int8_t from : std::to_array<std::int8_t>({1, 8})) {
    for (const std::int8_t to : kAllModes) {
      if (to == from) {
        continue;
      }
      run_in(from);
      write<std::int8_t>(0x6060, to);
      EXPECT_EQ(mode_display(), from) << "the old mode is in force while the motor turns";
      bus_->pass(125_ms);
      EXPECT_NEAR(velocity(), 5000.0, 50.0) << int{from} << " to " << int{to} << ": 6084h";
      EXPECT_EQ(mode_display(), from);
      bus_->pass(127_ms);
      EXPECT_EQ(mode_display(), to);
      EXPECT_EQ(statusword() & 0x006F, 0x0027) << "still enabled";
    }
  }
}

TEST_F(Tmcm3315Modes, FromAVelocityModeTheMotorSlowsDownToo) {
  for (const std::int8_t from : std::to_array<std::int8_t>({3, 9})) {
    for (const std::int8_t to : std::to_array<std::int8_t>({0, 1, 6})) {
      run_in(from);
      write<std::int8_t>(0x6060, to);
      bus_->pass(125_ms);
      EXPECT_NEAR(velocity(), 5000.0, 50.0) << int{from} << " to " << int{to};
      EXPECT_EQ(mode_display(), from);
      bus_->pass(200_ms);
      EXPECT_EQ(velocity(), 0.0);
      EXPECT_EQ(mode_display(), to);
    }
  }
}

TEST_F(Tmcm3315Modes, ModeZeroKeepsTheMotorStillWhateverIsWritten) {
  set_profile(0, 50'000, 500'000);
  enable(0, 0);
  EXPECT_EQ(statusword() & 0x006F, 0x0027);
  write<std::int32_t>(0x60FF, 10'000);
  start_move(0, 10'000);
  bus_->pass(500_ms);
  EXPECT_EQ(position(), 0.0);
  EXPECT_EQ(statusword() & (kTargetReached | kBit12 | kMotorActivity), 0);
}

TEST_F(Tmcm3315Modes, AModeTakenBackWhileTheMotorSlowsDownStartsAnew) {
  run_in(3);
  write<std::int8_t>(0x6060, 0);
  bus_->pass(50_ms);
  write<std::int8_t>(0x6060, 3);
  bus_->pass(100_ms);
  EXPECT_LT(velocity(), 5000.0) << "the stop is completed";
  bus_->pass(1_s);
  EXPECT_EQ(velocity(), 10'000.0) << "60FFh is obeyed again";
  EXPECT_EQ(mode_display(), 3);
  EXPECT_EQ(statusword() & kTargetReached, kTargetReached);
}

TEST_F(Tmcm3315Modes, SetPointsDuringAChangeOfModeAreNotObeyed) {
  for (const std::int8_t mode : kMovingModes) {
    run_in(mode);
    write<std::int8_t>(0x6060, 0);
    write<std::int32_t>(0x60FF, 20'000);
    write<std::int32_t>(0x607A, -20'000);
    control(0, 0x001F);
    EXPECT_EQ(statusword() & (kBit12 | kTargetReached), 0) << "mode " << int{mode};
    bus_->pass(125_ms);
    EXPECT_NEAR(velocity(), 5000.0, 100.0) << "mode " << int{mode};
    bus_->pass(500_ms);
    EXPECT_EQ(velocity(), 0.0) << "mode " << int{mode};
  }
}

TEST_F(Tmcm3315Modes, APositioningEndedByAnotherModeIsNotTakenUpAgain) {
  run_in(1);
  write<std::int8_t>(0x6060, 0);
  bus_->pass(500_ms);
  const double stopped = position();
  write<std::int8_t>(0x6060, 1);
  bus_->pass(500_ms);
  EXPECT_EQ(position(), stopped);
  EXPECT_EQ(mode_display(), 1);
}

TEST_F(Tmcm3315Modes, IllegalModesAreRefusedAndChangeNothing) {
  run_in(3);
  for (const std::int8_t mode : std::to_array<std::int8_t>({-1, 2, 4, 5, 7, 11})) {
    EXPECT_EQ(bus_->download<std::int8_t>(0x6060, 0, mode), 0x06090030U) << int{mode};
  }
  bus_->pass(50_ms);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6060), 3);
  EXPECT_EQ(velocity(), 10'000.0);
}

TEST_F(Tmcm3315Modes, OnlyTheSetPointOfTheModeInForceIsObeyed) {
  run_in(1);
  write<std::int32_t>(0x60FF, -20'000);
  bus_->pass(50_ms);
  EXPECT_NEAR(velocity(), 10'000.0, 1.0) << "pp reads 607Ah";
  run_in(3);
  start_move(0, -5000);
  bus_->pass(50_ms);
  EXPECT_EQ(velocity(), 10'000.0) << "pv reads 60FFh";
  run_in(9);
  write<std::int32_t>(0x607A, -5000);
  bus_->pass(50_ms);
  EXPECT_EQ(velocity(), 10'000.0) << "csv reads 60FFh";
}

// Halt, quick stop, disable operation

TEST_F(Tmcm3315Modes, HaltSlowsDownInEveryModeAndItsEndResumes) {
  for (const std::int8_t mode : kMovingModes) {
    run_in(mode);
    control(0, 0x010F);
    bus_->pass(125_ms);
    EXPECT_NEAR(velocity(), 5000.0, 50.0) << "mode " << int{mode} << ": 6084h";
    EXPECT_EQ(statusword() & kBit12, 0) << "mode " << int{mode};
    bus_->pass(500_ms);
    EXPECT_EQ(velocity(), 0.0);
    EXPECT_EQ(statusword() & 0x006F, 0x0027) << "halt stays in Operation enabled";
    control(0, 0x000F);
    bus_->pass(500_ms);
    EXPECT_NEAR(velocity(), 10'000.0, 200.0) << "mode " << int{mode};
  }
}

TEST_F(Tmcm3315Modes, HaltDuringAChangeOfModeHoldsTheNewMode) {
  run_in(3);
  set_interpolation(1, -3);
  write<std::int8_t>(0x6060, 9);
  control(0, 0x010F);
  bus_->pass(1_s);
  EXPECT_EQ(mode_display(), 9);
  EXPECT_EQ(velocity(), 0.0);
  EXPECT_EQ(statusword() & kBit12, 0);
  control(0, 0x000F);
  bus_->pass(50_ms);
  EXPECT_NEAR(velocity(), 5'000.0, 200.0) << "what halt held back is caught up with on 6083h";
  bus_->pass(60_ms);
  EXPECT_EQ(velocity(), 10'000.0);
}

TEST_F(Tmcm3315Modes, QuickStopOptionsTakeTheirRampInEveryMode) {
  struct Case {
    std::int16_t option;
    double velocity_after_50_ms;
    std::uint16_t end;
  };
  for (const std::int8_t mode : kMovingModes) {
    for (const Case& c : {Case{1, 8000.0, 0x0040}, Case{2, 6000.0, 0x0040}, Case{5, 8000.0, 0x0007},
                          Case{6, 6000.0, 0x0007}}) {
      run_in(mode);
      write<std::int16_t>(0x605A, c.option);
      control(0, 0x0002);
      EXPECT_EQ(statusword() & 0x006F, 0x0007);
      EXPECT_EQ(statusword() & kBit12, 0) << "set-points are ignored";
      bus_->pass(50_ms);
      EXPECT_NEAR(velocity(), c.velocity_after_50_ms, 50.0)
          << "mode " << int{mode} << " option " << c.option;
      write<std::int32_t>(0x607A, 0);
      write<std::int32_t>(0x60FF, -10'000);
      bus_->pass(300_ms);
      EXPECT_EQ(velocity(), 0.0);
      EXPECT_EQ(statusword() & 0x004F, c.end) << "mode " << int{mode} << " option " << c.option;
    }
  }
}

TEST_F(Tmcm3315Modes, AQuickStopTakenBackOnItsRampGoesOnWithoutAJolt) {
  run_in(3);
  control(0, 0);
  bus_->pass(200_ms);
  use_encoder();
  write<std::int16_t>(0x605A, 6);
  enable(0, 3);
  bus_->pass(500_ms);
  ASSERT_EQ(velocity(), 10'000.0);
  control(0, 0x0002);
  bus_->pass(50_ms);
  control(0, 0x000F);
  bus_->pass(1_ms);
  EXPECT_NEAR(velocity(), 6000.0, 300.0) << "from the present speed, not from standstill";
  bus_->pass(100_ms);
  EXPECT_EQ(velocity(), 10'000.0);
}

TEST_F(Tmcm3315Modes, DisableOperationSlowsDownInEveryMode) {
  for (const std::int8_t mode : kMovingModes) {
    run_in(mode);
    control(0, 0x0007);
    bus_->pass(125_ms);
    EXPECT_NEAR(velocity(), 5000.0, 50.0) << "mode " << int{mode};
    EXPECT_EQ(statusword() & 0x006F, 0x0027);
    EXPECT_EQ(statusword() & kBit12, 0) << "set-points are ignored";
    control(0, 0x000F);
    bus_->pass(50_ms);
    EXPECT_LT(velocity(), 5000.0) << "the command under way is completed first";
    control(0, 0x0007);
    bus_->pass(200_ms);
    EXPECT_EQ(statusword() & 0x006F, 0x0023);
  }
}

TEST_F(Tmcm3315Modes, ShutdownAndDisableVoltageTakeNoRampInAnyMode) {
  for (const std::int8_t mode : kMovingModes) {
    for (const std::uint16_t controlword : std::to_array<std::uint16_t>({0x0006, 0x0000})) {
      run_in(mode);
      control(0, controlword);
      EXPECT_EQ(velocity(), 0.0) << "mode " << int{mode};
      bus_->pass(2_ms);
      EXPECT_EQ(statusword() & 0x004F, controlword == 0 ? 0x0040 : 0x0001);
    }
  }
}

// Statusword

TEST_F(Tmcm3315Modes, ReservedStatuswordBitsStayZeroInTheirModes) {
  struct Row {
    std::int8_t mode;
    std::uint16_t moving;   // of bits 10, 12, 13, 14, 15
    std::uint16_t at_rest;  // after 60FFh = 0, or with the target reached
  };
  // pp with bit 4 withdrawn.
  for (const Row& row :
       {Row{1, kMotorActivity, kTargetReached},
        Row{3, kTargetReached | kMotorActivity, kTargetReached},
        Row{8, kBit12 | kMotorActivity, kBit12}, Row{9, kBit12 | kMotorActivity, kBit12}}) {
    constexpr unsigned kAll =
        kTargetReached | kBit12 | kFollowingError | kMotorActivity | kNegativeDirection | 0x0100;
    run_in(row.mode);
    EXPECT_EQ(statusword() & kAll, row.moving) << "mode " << int{row.mode};
    write<std::int32_t>(0x60FF, 0);
    set_interpolation(1, -3);
    if (row.mode == 1 || row.mode == 8) {
      write<std::uint32_t>(0x6081, 100'000);
      start_move(0, 20'000);
    }
    bus_->pass(1_s);
    EXPECT_EQ(statusword() & kAll, row.at_rest) << "mode " << int{row.mode};
  }
}

TEST_F(Tmcm3315Modes, TheDirectionBitKeepsTheLastDirection) {
  run_in(9);
  write<std::int32_t>(0x60FF, -10'000);
  bus_->pass(10_ms);
  EXPECT_EQ(statusword() & (kMotorActivity | kNegativeDirection),
            kMotorActivity | kNegativeDirection);
  write<std::int32_t>(0x60FF, 0);
  bus_->pass(10_ms);
  EXPECT_EQ(statusword() & (kMotorActivity | kNegativeDirection), kNegativeDirection);
  write<std::int32_t>(0x60FF, 10);
  bus_->pass(10_ms);
  EXPECT_EQ(statusword() & (kMotorActivity | kNegativeDirection), kMotorActivity);
}

TEST_F(Tmcm3315Modes, ControlwordBitsOfOtherModesMeanNothing) {
  for (const std::int8_t mode : std::to_array<std::int8_t>({3, 8, 9})) {
    run_in(mode);
    write<std::int32_t>(0x607A, mode == 8 ? 1'000'000 : -7);
    for (const std::uint16_t bits :
         std::to_array<std::uint16_t>({0x0010, 0x0020, 0x0040, 0x0200})) {
      control(0, static_cast<std::uint16_t>(0x000F | bits));
      bus_->pass(20_ms);
      EXPECT_NEAR(velocity(), 10'000.0, 100.0) << "mode " << int{mode} << " bit " << bits;
    }
  }
}

TEST_F(Tmcm3315Modes, Bits5And9OfProfilePositionMeanNothing) {
  run_in(1);
  write<std::int32_t>(0x607A, -50'000);
  control(0, 0x022F);
  bus_->pass(100_ms);
  EXPECT_NEAR(velocity(), 10'000.0, 1.0) << "no set-point without an edge of bit 4";
  control(0, 0x023F);
  bus_->pass(1_s);
  EXPECT_NEAR(velocity(), -10'000.0, 1.0) << "and with one, at once, whatever bits 5 and 9 say";
}

TEST_F(Tmcm3315Modes, AFollowingErrorEndsEveryModeAndShowsBit13InCspOnly) {
  for (const std::int8_t mode : kMovingModes) {
    renew(damped_axis());
    go_operational();
    use_encoder();
    write<std::uint32_t>(0x6065, 20);
    enable(0, mode);
    bus_->pass(50_ms);
    ASSERT_EQ(statusword() & 0x206F, 0x0027) << "mode " << int{mode};
    device_->axis(0).plant().set_external_torque(-0.3);
    bus_->pass(20_ms);
    EXPECT_EQ(statusword() & 0x004F, 0x0008) << "mode " << int{mode};
    EXPECT_EQ((statusword() & kFollowingError) != 0, mode == 8) << "mode " << int{mode};
  }
}

}  // namespace
}  // namespace stator::devices
