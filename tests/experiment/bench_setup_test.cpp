// What is put on the test bench and tuned, by the names people give.

#include "stator/experiment/bench_setup.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/experiment/tuning/tuning_setup.hpp"

namespace stator::experiment {
namespace {

using ::testing::HasSubstr;

BenchDevice device(const std::string& name, const std::string& type) {
  return {name, devices::products().find(type)->defaults()};
}

/// Two modules and a servo drive on a bus, as a rack lists them.
std::vector<BenchDevice> rack_devices() {
  return {device("x", "tmcm-3315"), device("servo", "tmc8670"), device("spindle", "tmcc160")};
}

/// What it throws says; "nothing" if it throws nothing.
template <typename Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const ExperimentError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(BenchSetup, TakesTheFirstDeviceOnTheNetworkOfItsKindOfMotor) {
  const BenchSetup stepper = setup_of_axis(rack_devices(), MotorKind::two_phase, {.rack = "r"});
  EXPECT_GT(stepper.full_scale_current, 0.0);
  std::vector<BenchDevice> devices = rack_devices();
  devices[2].setup.axes().front().servo->load.inertia = 4e-4;
  const BenchSetup servo = setup_of_axis(devices, MotorKind::three_phase, {.rack = "r"});
  EXPECT_EQ(servo.servo.load.inertia, 4e-4);
}

TEST(BenchSetup, TakesTheAxisThatIsAskedFor) {
  std::vector<BenchDevice> devices = rack_devices();
  devices[0].setup.axes()[2].stepper->load.inertia = 7e-5;
  const BenchSetup setup =
      setup_of_axis(devices, MotorKind::two_phase, {.rack = "r", .device = "x", .axis = 2});
  EXPECT_EQ(setup.axis.load.inertia, 7e-5);
}

TEST(BenchSetup, SaysWhatThereIsInsteadOfWhatIsAskedFor) {
  const auto setup = [](MotorKind kind, const BenchAxis& asked) {
    return message_of([&] { static_cast<void>(setup_of_axis(rack_devices(), kind, asked)); });
  };
  EXPECT_EQ(setup(MotorKind::two_phase, {.rack = "r.toml", .device = "y"}),
            "r.toml has no device \"y\"; it has: servo, spindle, x");
  EXPECT_THAT(setup(MotorKind::two_phase, {.rack = "r.toml", .device = "x", .axis = 3}),
              HasSubstr("x has no axis 3 with a stepper motor"));
  EXPECT_THAT(setup(MotorKind::three_phase, {.rack = "r.toml", .device = "x"}),
              HasSubstr("x has no axis 0 with a three-phase motor"));
}

TEST(BenchSetup, ChangesQuantitiesOfBothAxesWithinTheirRanges) {
  for (const AxisQuantity& quantity : axis_quantities()) {
    SCOPED_TRACE(quantity.name);
    BenchSetup setup;
    const double value = quantity.maximum / 2.0;
    change_quantity(quantity, value, quantity.name, setup);
    EXPECT_EQ(quantity.of_stepper(setup.axis), quantity.against ? -value : value);
    EXPECT_EQ(quantity.of_servo(setup.servo), quantity.against ? -value : value);
    EXPECT_THAT(message_of([&] { change_quantity(quantity, 2.0 * quantity.maximum, "it", setup); }),
                HasSubstr("it must lie in"));
    EXPECT_EQ(quantity.of_stepper(setup.axis), quantity.against ? -value : value);
  }
}

TEST(BenchSetup, KnowsMotorsByName) {
  BenchSetup setup;
  change_motor("QSH5718-79-30-163", MotorKind::two_phase, setup);
  const double inertia = setup.axis.motor.rotor_inertia;
  change_motor("QSH5718-55-30-098", MotorKind::two_phase, setup);
  EXPECT_NE(setup.axis.motor.rotor_inertia, inertia);
  EXPECT_THAT(message_of([&] { change_motor("QSH5718-79-30-164", MotorKind::two_phase, setup); }),
              HasSubstr("did you mean \"QSH5718-79-30-163\"?"));
}

TEST(BenchSetup, HasAModuleWhoseFirmwareDrivesTheAxis) {
  EXPECT_NE(module_for_bench(devices::products()), nullptr);
  EXPECT_EQ(module_for_bench({}), nullptr);
}

TEST(TuningSetup, TakesTheFirstThatCanBeTunedOrTheOneOfThatName) {
  const std::vector<BenchDevice> devices = rack_devices();
  const auto place = [&](const std::string& name) {
    return tuning::require_tunable(devices, name, "r.toml", devices::products());
  };
  EXPECT_EQ(place(""), 1U);
  EXPECT_EQ(place("servo"), 1U);
  EXPECT_EQ(message_of([&] { place("x"); }), "r.toml has no tmc8670 called \"x\"; it has: servo");
  EXPECT_EQ(message_of([] {
              static_cast<void>(tuning::require_tunable({}, "", "r.toml", devices::products()));
            }),
            "r.toml has no tmc8670, the one product that can be tuned");
}

TEST(TuningSetup, KnowsTheTypePlateAndTheBoard) {
  product::Setup setup = device("servo", "tmc8670").setup;
  plant::PwmAxisParameters& axis = tuning::tuned_axis(setup);
  axis.motor = tuning::require_motor("EC45-flat-70W");
  const tuning::Settings settings = tuning::settings_of(setup, {}, {});
  EXPECT_EQ(settings.current, tuning::rated_current(axis.motor));
  EXPECT_GT(settings.board.counts_per_ampere, 0.0);
  EXPECT_EQ(settings.motor, control::foc::MotorType::three_phase);
  EXPECT_EQ(tuning::settings_of(setup, {}, 0.5).current, 0.5);
  axis.motor = tuning::require_motor("QSH5718-55-30-098");
  EXPECT_EQ(tuning::settings_of(setup, {}, {}).motor, control::foc::MotorType::two_phase);
  EXPECT_THAT(message_of([] { static_cast<void>(tuning::require_motor("M")); }),
              HasSubstr("motor \"M\" is not known; the motors are: "));
}

}  // namespace
}  // namespace stator::experiment
