// The TMC8670's FOC block on a motor: initialisation of its sensors, handover between them,
// velocity and position.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "control/foc_drive.hpp"

namespace stator::control::foc {
namespace {

constexpr double kDegree = 65536.0 / 360.0;

/// An axis that comes to rest by itself, its shaft `degrees` (electrical) forward at power-on.
plant::ServoAxisParameters damped_axis(double degrees) {
  plant::ServoAxisParameters result = FocDrive::linear_axis();
  result.motor.viscous_friction = 2e-4;
  result.motor.coulomb_friction = result.motor.static_friction = 5e-4;
  result.initial_revolutions = degrees / 360.0 / result.motor.pole_pairs;
  return result;
}

/// Electrical angle by which `shown` (s16) is ahead of the rotor, in degrees.
double ahead(const FocDrive& drive, std::int32_t shown) {
  const double rotor = drive.axis.observe().electrical_angle / (2.0 * M_PI) * 65536.0;
  return std::remainder(shown - rotor, 65536.0) / kDegree;
}

TEST(FocOpenLoopDrive, TurnsTheMotorAndShowsWhatTheSensorsSay) {
  FocDrive drive(damped_axis(0.0));
  drive.block.set(field("MODE_MOTION"), 8);
  drive.block.set(field("PHI_E_SELECTION"), 2);
  drive.block.set(field("UD_EXT"), 5000);
  drive.block.set(field("OPENLOOP_ACCELERATION"), 2000);
  drive.block.set(field("OPENLOOP_VELOCITY_TARGET"), 400);
  drive.run(1.5);
  EXPECT_NEAR(drive.rpm(), 400.0 / 4, 2.0);  // electrical rpm and four pole pairs
  EXPECT_NEAR(drive.block.get(field("PID_VELOCITY_ACTUAL")), 100, 20);
  double largest = 0.0, encoder_lag = 0.0, hall_lag = 0.0;
  for (int k = 0; k < 5000; ++k) {
    drive.step();
    const double phi = drive.block.get(field("OPENLOOP_PHI"));
    const auto lag = [&](const Field& f) {
      return std::fabs(std::remainder(drive.block.get(f) - phi, 65536.0)) / kDegree;
    };
    encoder_lag = std::max(encoder_lag, lag(field("ABN_DECODER_PHI_E")));
    hall_lag = std::max(hall_lag, lag(field("HALL_PHI_E")));
    largest = std::max(largest, std::fabs(1.0 * drive.block.get(field("ADC_IUX"))));
  }
  // The rotor follows the field at the angle that friction, EMF and inductance ask for: in the
  // right direction and with the right number of pole pairs; halls add half a sector.
  EXPECT_LT(encoder_lag, 12.0);
  EXPECT_LT(hall_lag, 44.0);
  EXPECT_GT(largest, 2000.0);  // what scales and offsets are set by: more than 2 A
}

TEST(FocDirection, OffsetsAlignTheEncoderWithTheRotor) {
  // Torque at the same current goes with the cosine of the misalignment.
  for (const double degrees : {0.0, 60.0, 120.0}) {
    plant::ServoAxisParameters parameters = FocDrive::linear_axis();
    parameters.load.inertia = 1e-3;
    FocDrive drive(parameters);
    drive.tune_currents(0.2);
    drive.block.set(field("ABN_DECODER_PHI_E_OFFSET"), std::lround(degrees * kDegree));
    drive.block.set(field("PID_TORQUE_TARGET"), 1000);
    drive.block.set(field("MODE_MOTION"), 1);
    drive.run(0.02);
    const double torque = drive.axis.observe().electromagnetic_torque;
    const double expected = parameters.motor.torque_constant() * std::cos(degrees / 180.0 * M_PI);
    EXPECT_NEAR(torque, expected, 0.03 * parameters.motor.torque_constant()) << degrees;
  }
}

TEST(FocDirection, AnEncoderCountingBackwardsMakesTheDriveLock) {
  for (const bool swapped : {false, true}) {
    FocDrive drive(damped_axis(0.0));
    drive.encoder_swapped = swapped;
    drive.tune_currents(0.2);
    drive.block.set(field("PID_TORQUE_TARGET"), 1000);
    drive.block.set(field("MODE_MOTION"), 1);
    drive.run(0.1);
    const double turned = drive.axis.observe().shaft_revolutions;
    drive.run(0.1);
    const double further = drive.axis.observe().shaft_revolutions - turned;
    if (swapped) {
      EXPECT_LT(std::fabs(further), 0.25);  // caught within half an electrical revolution
      drive.block.set(field("ABN_DIRECTION"), 1);
      drive.block.set(field("ABN_DECODER_PHI_E"), std::lround(-ahead(drive, 0) * kDegree));
      drive.run(0.1);
      EXPECT_GT(drive.rpm(), 500.0);
    } else {
      EXPECT_GT(further, 1.0);
    }
  }
}

TEST(FocInitialisation, BangBangPullsTheRotorIntoTheWantedDirection) {
  for (const double start : {40.0, -100.0, 150.0}) {
    FocDrive drive(damped_axis(start));
    drive.block.set(field("MODE_MOTION"), 8);
    drive.block.set(field("PHI_E_SELECTION"), 1);
    drive.block.set(field("UD_EXT"), 5000);
    drive.run(0.5);
    EXPECT_NEAR(ahead(drive, 0), 0.0, 1.0) << start;
    drive.block.set(field("ABN_DECODER_PHI_E"), 0);
    EXPECT_NEAR(ahead(drive, drive.block.get(field("ABN_DECODER_PHI_E"))), 0.0, 1.0) << start;
  }
}

TEST(FocInitialisation, MinimalMovementFindsTheRotorWithoutTurningItFar) {
  for (const double start : {20.0, 70.0, -60.0, -120.0, 150.0}) {
    FocDrive drive(damped_axis(start));
    drive.block.set(field("UD_EXT"), 1500);
    drive.block.set(field("MODE_MOTION"), 9);
    drive.run(0.1);
    EXPECT_EQ(drive.block.get(field("ENC_INIT_MINI_MOVE_STATUS")), 1);
    EXPECT_NEAR(drive.block.get(field("ENC_INIT_MINI_MOVE_U_D")), 625, 1);
    double farthest = 0.0;
    while (drive.block.get(field("ENC_INIT_MINI_MOVE_STATUS")) == 1) {
      drive.step();
      const double moved = drive.axis.observe().shaft_revolutions * 4 * 360.0 - start;
      farthest = std::max(farthest, std::fabs(moved));
    }
    // A quarter of the way to the first angle of the field.
    EXPECT_LT(farthest, std::fabs(start) / 4.0 + 5.0) << start;
    EXPECT_EQ(drive.block.get(field("ENC_INIT_MINI_MOVE_STATUS")), 2);
    // Friction leaves a small angle.
    EXPECT_NEAR(ahead(drive, drive.block.get(field("ABN_DECODER_PHI_E"))), 0.0, 6.0) << start;
  }
}

TEST(FocInitialisation, ByHallsThenHandsOverToTheEncoder) {
  for (const double start : {0.0, 100.0, -70.0}) {
    FocDrive drive(damped_axis(start));
    drive.tune_currents(0.2);
    drive.block.set(field("PHI_E_SELECTION"), 5);
    drive.block.set(field("ENCODER_INIT_HALL_ENABLE"), 1);
    drive.block.set(field("PID_TORQUE_TARGET"), 500);
    drive.block.set(field("MODE_MOTION"), 1);
    drive.step();
    EXPECT_EQ(drive.block.get(field("ENC_INIT_HALL_STATUS")), 1);
    drive.run(0.2);
    EXPECT_EQ(drive.block.get(field("ENC_INIT_HALL_STATUS")), 2);
    EXPECT_EQ(drive.block.get(field("ENC_INIT_HALL_PHI_E_ABN_OFFSET")),
              drive.block.get(field("ABN_DECODER_PHI_E_OFFSET")));
    drive.block.set(field("PHI_E_SELECTION"), 3);
    const double before = drive.rpm();
    drive.run(0.01);
    EXPECT_GT(drive.rpm(), 0.9 * before);
    // Hysteresis of the sensors, the period and the count of the edge.
    EXPECT_NEAR(ahead(drive, drive.block.get(field("PHI_E"))), 0.0, 5.0) << start;
  }
}

/// A drive with velocity and position loops.
FocDrive servo() {
  FocDrive drive(damped_axis(0.0));
  drive.tune_currents(0.2);
  drive.block.set(field("PID_TORQUE_FLUX_LIMITS"), 5000);
  drive.block.set(field("PID_VELOCITY_P"), 512);
  drive.block.set(field("PID_VELOCITY_I"), 60);
  drive.block.set(field("PID_POSITION_P"), 40);
  drive.block.set(field("PID_VELOCITY_LIMIT"), 1500);
  return drive;
}

TEST(FocServo, HoldsItsVelocityUnderLoad) {
  for (const std::int32_t rpm : {1000, -1500}) {
    FocDrive drive = servo();
    drive.block.set(field("PID_VELOCITY_TARGET"), rpm);
    drive.block.set(field("MODE_MOTION"), 2);
    drive.run(0.5);
    EXPECT_NEAR(drive.rpm(), rpm, 3.0);
    drive.axis.set_external_torque(rpm > 0 ? -0.03 : 0.03);
    drive.run(0.5);
    EXPECT_NEAR(drive.rpm(), rpm, 3.0);
  }
}

TEST(FocServo, MovesToItsPosition) {
  FocDrive drive = servo();
  drive.block.set(field("MODE_MOTION"), 3);
  drive.block.set(field("PID_POSITION_TARGET"), 10 * 65536);
  drive.run(2.0);
  EXPECT_NEAR(drive.axis.observe().shaft_revolutions, 10.0, 0.003);
  EXPECT_NEAR(drive.block.get(field("PID_POSITION_ACTUAL")), 10 * 65536, 200);
}

}  // namespace
}  // namespace stator::control::foc
