#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "experiment/tuning_axis.hpp"
#include "stator/devices/catalogue/products.hpp"

namespace stator::experiment::tuning {
namespace {

using control::foc::field;

/// Electrical degrees by which the block's angle is ahead of the rotor.
double misalignment(devices::tmc8670::ServoStage& stage, int pole_pairs) {
  const double shown = stage.block().get(field("ABN_DECODER_PHI_E")) / 65536.0;
  return 360.0 * std::remainder(shown - stage.plant().revolutions() * pole_pairs, 1.0);
}

struct NamedMotor {
  const char* name;
  bool rough;  ///< load, more friction, noise, offsets and dead time; the encoder is reversed
};

class TuningOf : public testing::TestWithParam<NamedMotor> {
 protected:
  static plant::PwmAxisParameters axis() {
    plant::PwmAxisParameters result = axis_with(GetParam().name);
    if (GetParam().rough) {
      result.load.inertia = 2.0 * motor_of(result).rotor_inertia;
      result.load.coulomb_friction = 2e-3;
      result.load.viscous_friction = 2e-5;
      result.converter.currents[0] = {.gain = 1000.0, .offset = 32'900.0, .noise = 15.0};
      result.converter.currents[1] = {.gain = 1000.0, .offset = 32'500.0, .noise = 15.0};
      result.inverter.dead_time = 300e-9;
      result.encoders[0].reversed = true;
      result.initial_revolutions = 0.37;
    }
    return result;
  }
};

TEST_P(TuningOf, FindsTheMotorAndSetsTheLoopsWanted) {
  plant::PwmAxisParameters parameters = axis();
  const plant::ThreePhaseMotorParameters& motor = motor_of(parameters);
  devices::tmc8670::TunableStage tunable(parameters);
  devices::tmc8670::ServoStage& stage = tunable.stage();
  const Tuning tuning = tune(tunable, settings_for(parameters));
  const auto near = [](double found, double truth, double share, const char* what) {
    EXPECT_NEAR(found / truth, 1.0, share) << what << ": " << found << " instead of " << truth;
  };
  near(tuning.winding.resistance.value, motor.resistance + parameters.inverter.on_resistance, 0.03,
       "resistance");
  near(tuning.winding.direct_inductance.value, motor.direct_inductance, 0.03, "Ld");
  near(tuning.winding.quadrature_inductance.value, motor.quadrature_inductance, 0.03, "Lq");
  near(tuning.mechanics.flux_linkage.value, motor.flux_linkage, 0.05, "flux linkage");
  near(tuning.mechanics.torque_constant, motor.torque_constant(), 0.05, "torque constant");
  near(tuning.mechanics.inertia.value, motor.rotor_inertia + parameters.load.inertia, 0.05,
       "inertia");
  near(tuning.mechanics.dry_friction.value,
       motor.coulomb_friction + parameters.load.coulomb_friction, 0.05, "dry friction");
  near(tuning.mechanics.viscous_friction.value,
       motor.viscous_friction + parameters.load.viscous_friction, 0.05, "viscous friction");
  EXPECT_EQ(tuning.encoder.pole_pairs, motor.pole_pairs);
  EXPECT_EQ(tuning.encoder.resolution, parameters.encoders[0].counts_per_revolution);
  EXPECT_EQ(tuning.encoder.reversed, parameters.encoders[0].reversed);
  EXPECT_NEAR(tuning.winding.offsets[0].value, parameters.converter.currents[0].offset, 1.0);
  EXPECT_NEAR(tuning.winding.offsets[1].value, parameters.converter.currents[1].offset, 1.0);
  EXPECT_NEAR(misalignment(stage, motor.pole_pairs), 0.0, 2.0);
  near(tuning.verification.current.bandwidth, 1000.0, 0.10, "bandwidth of the current loop");
  near(tuning.verification.velocity.bandwidth, 50.0, 0.10, "bandwidth of the velocity loop");
  EXPECT_GT(tuning.verification.current.phase_margin, 60.0);
  EXPECT_GT(tuning.verification.velocity.phase_margin, 50.0);
}

INSTANTIATE_TEST_SUITE_P(Motors, TuningOf,
                         testing::Values(NamedMotor{"QBL4208-61-04-013", false},
                                         NamedMotor{"mj5208", false},
                                         NamedMotor{"EC45-flat-70W", true},
                                         NamedMotor{"QBL4208-41-04-006", true}),
                         [](const auto& instance) {
                           std::string name = instance.param.name;
                           std::erase(name, '-');
                           return name + (instance.param.rough ? "Rough" : "");
                         });

TEST(TuningAlignment, IsWithinTwoDegreesFromEveryAngle) {
  for (int k = 0; k < 8; ++k) {
    plant::PwmAxisParameters parameters = axis_with("QBL4208-61-04-013");
    parameters.initial_revolutions = k / 8.0 / motor_of(parameters).pole_pairs;
    devices::tmc8670::TunableStage tunable(parameters);
    devices::tmc8670::ServoStage& stage = tunable.stage();
    Chip chip(tunable, settings_for(parameters));
    Winding winding;
    measure_offsets(chip, winding);
    measure_resistance(chip, winding);
    measure_inductances(chip, winding);
    const Encoder encoder = measure_encoder(chip);
    EXPECT_NEAR(misalignment(stage, encoder.pole_pairs), 0.0, 2.0) << 45 * k << " degrees";
    // The N pulse of this encoder comes at the zero of the shaft.
    EXPECT_NEAR(encoder.index_offset * 360.0 / 65536.0, 0.0, 2.0) << 45 * k << " degrees";
  }
}

TEST(TuningAlignment, HoldsForTheCounterAsItWasAtPowerOn) {
  plant::PwmAxisParameters parameters = axis_with("QBL4208-61-04-013");
  parameters.initial_revolutions = 0.37;
  parameters.encoders[0].reversed = true;
  devices::tmc8670::TunableStage tuned(parameters);
  const Tuning tuning = tune(tuned, settings_for(parameters));
  devices::tmc8670::ServoStage fresh(parameters);
  fresh.block().set(field("N_POLE_PAIRS"), tuning.encoder.pole_pairs);
  fresh.block().set(field("ABN_DECODER_PPR"), tuning.encoder.resolution);
  fresh.block().set(field("ABN_DIRECTION"), tuning.encoder.reversed ? 1 : 0);
  fresh.block().set(field("ABN_DECODER_PHI_E_OFFSET"), std::lround(tuning.encoder.offset.value));
  fresh.step();
  EXPECT_NEAR(misalignment(fresh, tuning.encoder.pole_pairs), 0.0, 2.0);
}

TEST(TuningLoops, HaveTheBandwidthsAskedFor) {
  struct Wish {
    double current, velocity, position;
  };
  for (const Wish& wish : {Wish{600.0, 30.0, 5.0}, Wish{2000.0, 100.0, 25.0}}) {
    plant::PwmAxisParameters parameters = axis_with("QBL4208-61-04-013");
    devices::tmc8670::TunableStage tunable(parameters);
    devices::tmc8670::ServoStage& stage = tunable.stage();
    stage.block().set(field("PWM_BBM_H"), 0);  // the model has no dead time
    stage.block().set(field("PWM_BBM_L"), 0);
    Settings settings = settings_for(parameters);
    settings.current_bandwidth = wish.current;
    settings.velocity_bandwidth = wish.velocity;
    settings.position_bandwidth = wish.position;
    const Tuning tuning = tune(tunable, settings);
    EXPECT_NEAR(tuning.verification.current.bandwidth / wish.current, 1.0, 0.10);
    EXPECT_NEAR(tuning.verification.velocity.bandwidth / wish.velocity, 1.0, 0.10);
    const StepResponse& step = tuning.verification.position_step;
    for (std::size_t k = 0; k < step.time.size(); ++k) {
      EXPECT_NEAR(step.actual[k] / step.height, step.model[k] / step.height, 0.1) << step.time[k];
    }
  }
}

TEST(TuningLoops, FollowTheLinearModel) {
  plant::PwmAxisParameters parameters = axis_with("QBL4208-61-04-013");
  devices::tmc8670::TunableStage tunable(parameters);
  const Tuning tuning = tune(tunable, settings_for(parameters));
  for (const BodePlot* plot : {&tuning.verification.current, &tuning.verification.velocity}) {
    for (std::size_t n = 0; n < plot->frequency.size(); ++n) {
      // Below, the rotor swings on the spring of the current that holds it.
      if (plot->frequency[n] > 0.1 * plot->wanted && plot->frequency[n] < 2.0 * plot->wanted) {
        EXPECT_LT(std::abs(plot->measured[n] - plot->model[n]), 0.08) << plot->frequency[n];
      }
    }
  }
}

TEST(TuningOfTheSupply, BurnsWhatBrakingReturnsInsteadOfRaisingItWithoutBound) {
  plant::PwmAxisParameters parameters = axis_with("QBL4208-61-04-013");
  parameters.load.inertia = 2e-4;  // 7 J at the highest speed, 0.14 J in the capacitor at 24 V
  devices::tmc8670::TunableStage tunable(parameters);
  devices::tmc8670::ServoStage& stage = tunable.stage();
  Settings settings = settings_for(parameters);
  settings.current_bandwidth = 500.0;
  settings.velocity_bandwidth = 10.0;
  // Never off again once on: the brake chopper remembers a peak of 1.4 times the supply.
  stage.block().set(field("ADC_VM_LIMIT_LOW"), 0);
  stage.block().set(field("ADC_VM_LIMIT_HIGH"), 33'600);
  const Tuning tuning = tune(tunable, settings);
  EXPECT_FALSE(stage.block().outputs().brake_chopper);
  EXPECT_NEAR(tuning.mechanics.inertia.value / (4.8e-6 + 2e-4), 1.0, 0.05);
}

TEST(TuningOfReversedAmplifiers, TurnsTheScaleRound) {
  plant::PwmAxisParameters parameters = axis_with("QBL4208-61-04-013");
  parameters.converter.currents[0].gain = -1000.0;
  parameters.converter.currents[1].gain = -1000.0;
  devices::tmc8670::TunableStage tunable(parameters);
  const Tuning tuning = tune(tunable, settings_for(parameters));
  EXPECT_EQ(tuning.winding.current_scale, -256);
  EXPECT_NEAR(tuning.winding.resistance.value / 0.37, 1.0, 0.03);
}

TEST(TuningObjects, HoldWhatTheRegistersWereSetTo) {
  plant::PwmAxisParameters parameters = axis_with("QBL4208-61-04-013");
  devices::tmc8670::TunableStage tunable(parameters);
  devices::tmc8670::ServoStage& stage = tunable.stage();
  const Settings settings = settings_for(parameters);
  const Tuning tuning = tune(tunable, settings);
  const auto product = devices::products().find("tmc8670");
  const product::TunedDrive drive = tuned_drive(tuning, settings);
  const auto value_of = [&](unsigned index, unsigned subindex) {
    for (const product::TunedObject& tuned : product->tuning()->objects_of(drive)) {
      if (tuned.index == index && tuned.subindex == subindex) {
        return tuned.value;
      }
    }
    ADD_FAILURE() << std::hex << index << ':' << subindex << " is missing";
    return std::int64_t{0};
  };
  const auto& block = stage.block();
  EXPECT_EQ(value_of(0x2000, 2), block.get(field("N_POLE_PAIRS")));
  EXPECT_EQ(value_of(0x2000, 4), block.get(field("ADC_I0_OFFSET")));
  EXPECT_EQ(value_of(0x2000, 5), block.get(field("ADC_I1_OFFSET")));
  EXPECT_EQ(value_of(0x2010, 1), block.get(field("ABN_DECODER_PPR")));
  EXPECT_EQ(value_of(0x2010, 8), block.get(field("ABN_DECODER_PHI_E_OFFSET")));
  EXPECT_EQ(value_of(0x2030, 1), block.get(field("PID_FLUX_P")));
  EXPECT_EQ(value_of(0x2030, 2), block.get(field("PID_FLUX_I")));
  EXPECT_EQ(value_of(0x2030, 3), block.get(field("PID_TORQUE_P")));
  EXPECT_EQ(value_of(0x2030, 4), block.get(field("PID_TORQUE_I")));
  EXPECT_EQ(value_of(0x2030, 5), block.get(field("PID_VELOCITY_P")));
  EXPECT_EQ(value_of(0x2030, 6), block.get(field("PID_VELOCITY_I")));
  EXPECT_EQ(value_of(0x2030, 7), block.get(field("PID_POSITION_P")));
  EXPECT_EQ(value_of(0x2031, 1), block.get(field("PID_TORQUE_FLUX_LIMITS")));
  EXPECT_EQ(value_of(0x2031, 3), block.get(field("PID_VELOCITY_LIMIT")));
}

TEST(TuningOfAStepper, FindsItsTwoPhases) {
  plant::PwmAxisParameters parameters;
  const plant::StepperMotorParameters motor = *plant::find_stepper_motor("QSH5718-55-30-098");
  parameters.motor = motor;
  parameters.supply_voltage = 48.0;
  parameters.encoders[0].counts_per_revolution = 40'000;
  devices::tmc8670::TunableStage tunable(parameters);
  devices::tmc8670::ServoStage& stage = tunable.stage();
  Settings settings;
  settings.motor = control::foc::MotorType::two_phase;
  settings.current = std::sqrt(2.0) * motor.rated_current;
  const Tuning tuning = tune(tunable, settings);
  // The path of a phase leads through two transistors.
  EXPECT_NEAR(tuning.winding.resistance.value /
                  (motor.resistance + 2.0 * parameters.inverter.on_resistance),
              1.0, 0.03);
  EXPECT_NEAR(tuning.winding.direct_inductance.value / motor.inductance, 1.0, 0.03);
  EXPECT_EQ(tuning.encoder.pole_pairs, motor.pole_pairs);
  EXPECT_NEAR(misalignment(stage, motor.pole_pairs), 0.0, 2.0);
  EXPECT_NEAR(tuning.mechanics.torque_constant / (motor.pole_pairs * motor.flux_linkage), 1.0,
              0.05);
  EXPECT_NEAR(tuning.mechanics.inertia.value / motor.rotor_inertia, 1.0, 0.05);
}

}  // namespace
}  // namespace stator::experiment::tuning
