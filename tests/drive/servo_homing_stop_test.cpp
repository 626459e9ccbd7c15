// Whatever stops a homing run of a servo axis, in whichever stage: the motor comes to rest on its
// ramp and stays, the statusword tells so, and home is found where it is afterwards.

#include "drive/foc_bench.hpp"
#include "drive/homing_stops.hpp"
#include "drive/servo_bench.hpp"

namespace stator::drive {
namespace {

constexpr double kEnough = 1e6;                   // rpm/s
constexpr double kSpeedPerAmpereSecond = 1300.0;  // rpm per A and s with 2e-4 kg m²

class FocTrack : public FocBench {
 public:
  static constexpr double kStands = 20.0;  ///< rpm: a count of the encoder for the velocity meter

  explicit FocTrack(int method, double inertia = 0.0) : FocBench(track(method, inertia)) {
    left_switch = -0.7;
    home_switch = {1.0, 1.2};
    if (method == 19) {
      right_switch = 1.4;
    }
    axis->settings().hard_stop = {.current = 0.6, .positive_clearance = 16'384};
    axis->foc_settings().overvoltage = 30.0;
    write(0x6099, 1, 300);
    write(0x6099, 2, method < 0 ? 200 : 60);
  }
  [[nodiscard]] double turned() const { return revolutions(); }
  [[nodiscard]] double home() const {
    return revolutions() - static_cast<double>(position()) / kTurn;
  }
  [[nodiscard]] double strongest() const {
    return axis->settings().maximum_torque * kSpeedPerAmpereSecond *
           (2e-4 / std::max(plant.parameters().load.inertia, 1e-6));
  }
  void set_fault(bool present) { plant.set_supply_voltage(present ? 31.0 : 24.0); }

 private:
  static plant::PwmAxisParameters track(int method, double inertia) {
    plant::PwmAxisParameters parameters = foc_plant();
    parameters.initial_revolutions = 0.3;
    if (method < 0) {
      parameters.load.end_stop_maximum = 1.5;
    }
    parameters.load.inertia = inertia;
    return parameters;
  }
};

/// With a load that its torque can hardly bring up to speed within the ramp, tuned for it.
class FocHeavyTrack : public FocTrack {
 public:
  explicit FocHeavyTrack(int method) : FocTrack(method, 2e-4) {
    block.set(control::foc::field("PID_VELOCITY_P"), 8200);
  }
};

class ServoTrack : public ServoBench {
 public:
  static constexpr double kStands = 40.0;  ///< rpm: it swings about where it stands

  explicit ServoTrack(int method) {
    left_switch = -2000.0;
    right_switch = 5000.0;
    motor.upper_stop = 6000.0;
    axis->settings().hard_stop = {.current = 1.0, .positive_clearance = 500};
    write(0x6099, 1, 300);
    write(0x6099, 2, method < 0 ? 200 : 60);
  }
  [[nodiscard]] double turned() const { return motor.counts() / ServoMotor::kCounts; }
  [[nodiscard]] double home() const {
    return (motor.counts() - static_cast<double>(position())) / ServoMotor::kCounts;
  }
  [[nodiscard]] double strongest() const { return kEnough; }
  /// Friction, which the motor of the bench lacks, holds a shaft that stands without power.
  void pass(base::SimDuration duration) override {
    for (const base::SimTime end = now + duration; now < end;) {
      ServoBench::pass(base::SimDuration(1'000'000));
      motor.blocked = !axis->bridge_enabled() && std::fabs(rpm()) < kStands;
    }
  }
  /// Undervoltage, as the sensors tell it; too much voltage would switch the power off.
  void set_fault(bool present) { sensing.supply_voltage = present ? 6.0 : 24.0; }
};

class FocHomingStops : public testing::TestWithParam<int> {};

TEST_P(FocHomingStops, InEveryStageTheMotorComesToRestAndHomeIsFoundAfterwards) {
  using enum HomingStop;
  expect_rest_in_every_stage<FocTrack>(
      GetParam(), {bit_four, halt_slow_down, halt_quick_stop, quick_stop, quick_stop_and_stay,
                   shutdown, disable, mode, network, fault});
}

INSTANTIATE_TEST_SUITE_P(Methods, FocHomingStops, testing::Values(17, 19, 34, -1));

class FocHeavyHomingStops : public testing::TestWithParam<int> {};

TEST_P(FocHeavyHomingStops, ALoadThatLagsComesToRestToo) {
  using enum HomingStop;
  expect_rest_in_every_stage<FocHeavyTrack>(
      GetParam(), {bit_four, halt_quick_stop, quick_stop, disable, mode, network});
}

INSTANTIATE_TEST_SUITE_P(Methods, FocHeavyHomingStops, testing::Values(17, 34, -1));

class ServoHomingStops : public testing::TestWithParam<int> {};

TEST_P(ServoHomingStops, InEveryStageTheMotorComesToRestAndHomeIsFoundAfterwards) {
  using enum HomingStop;
  expect_rest_in_every_stage<ServoTrack>(GetParam(), {bit_four, quick_stop, quick_stop_and_stay,
                                                      shutdown, disable, mode, network, fault});
}

INSTANTIATE_TEST_SUITE_P(Methods, ServoHomingStops, testing::Values(17, 18, -1));

}  // namespace
}  // namespace stator::drive
