// The reason with which tuning stops when motor, sensor or limits do not permit it.
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "experiment/tuning_axis.hpp"

namespace stator::experiment::tuning {
namespace {

constexpr const char* kMotor = "QBL4208-61-04-013";

struct Trouble {
  const char* name;
  Obstacle obstacle;
  const char* says;  ///< part of the text
  std::function<void(plant::PwmAxisParameters&)> change = [](plant::PwmAxisParameters&) {};
  std::function<void(Settings&)> claim = [](Settings&) {};
  std::function<void(plant::PwmAxisFaults&)> fault = [](plant::PwmAxisFaults&) {};
};

class TuningStops : public testing::TestWithParam<Trouble> {};

TEST_P(TuningStops, WithItsReason) {
  const Trouble& trouble = GetParam();
  plant::PwmAxisParameters parameters = axis_with(kMotor);
  trouble.change(parameters);
  devices::tmc8670::TunableStage tunable(parameters);
  devices::tmc8670::ServoStage& stage = tunable.stage();
  plant::PwmAxisFaults faults;
  trouble.fault(faults);
  stage.plant().set_faults(faults);
  Settings settings = settings_for(parameters);
  trouble.claim(settings);
  try {
    static_cast<void>(tune(tunable, settings));
    FAIL() << "was tuned all the same";
  } catch (const TuningError& error) {
    EXPECT_EQ(error.obstacle(), trouble.obstacle) << error.what();
    EXPECT_NE(std::string(error.what()).find(trouble.says), std::string::npos) << error.what();
  }
  EXPECT_FALSE(stage.block().outputs().enable && stage.inputs().enable);
}

INSTANTIATE_TEST_SUITE_P(
    Causes, TuningStops,
    testing::Values(
        Trouble{.name = "NoMotor",
                .obstacle = Obstacle::no_motor,
                .says = "no phase carries current",
                .fault =
                    [](auto& faults) {
                      faults.terminals.open = {true, true, true, false};
                    }},
        Trouble{.name = "PhaseUOpen",
                .obstacle = Obstacle::phase_open,
                .says = "phase U carries no current",
                .fault = [](auto& faults) { faults.terminals.open[0] = true; }},
        Trouble{.name = "PhaseVOpen",
                .obstacle = Obstacle::phase_open,
                .says = "phase V carries no current",
                .fault = [](auto& faults) { faults.terminals.open[1] = true; }},
        Trouble{.name = "PhaseWOpen",
                .obstacle = Obstacle::phase_open,
                .says = "phase W carries no current",
                .fault = [](auto& faults) { faults.terminals.open[2] = true; }},
        Trouble{.name = "EncoderMissing",
                .obstacle = Obstacle::encoder_silent,
                .says = "the encoder does not count",
                .change = [](auto& axis) { axis.encoders[0].counts_per_revolution = 0; }},
        Trouble{.name = "EncoderCableBroken",
                .obstacle = Obstacle::encoder_silent,
                .says = "the encoder does not count",
                .fault = [](auto& faults) { faults.common.encoders[0].lost = true; }},
        Trouble{.name = "ShaftBlocked",
                .obstacle = Obstacle::shaft_blocked,
                .says = "nor does the shaft turn",
                .change = [](auto& axis) { axis.load.coulomb_friction = 10.0; }},
        Trouble{.name = "EndStop",
                .obstacle = Obstacle::shaft_blocked,
                .says = "end stop",
                .change = [](auto& axis) { axis.load.end_stop_maximum = 1.1; }},
        Trouble{.name = "SupplyOff",
                .obstacle = Obstacle::supply_too_low,
                .says = "the supply is 2 V",
                .change = [](auto& axis) { axis.supply_voltage = 2.0; }},
        Trouble{.name = "SupplyTooLowForTheWinding",
                .obstacle = Obstacle::supply_too_low,
                .says = "choose a lower --current",
                .change = [](auto& axis) { motor_of(axis).resistance = 8.0; }},
        Trouble{.name = "CurrentRange",
                .obstacle = Obstacle::current_range,
                .says = "choose a --current of at most 25.2 A",
                .claim = [](auto& settings) { settings.current = 30.0; }},
        Trouble{.name = "OffsetFarOff",
                .obstacle = Obstacle::current_sensing,
                .says = "far from the middle",
                .change = [](auto& axis) { axis.converter.currents[0].offset = 50'000.0; }},
        Trouble{.name = "OneAmplifierReversed",
                .obstacle = Obstacle::current_sensing,
                .says = "different signs",
                .change = [](auto& axis) { axis.converter.currents[1].gain = -1000.0; }},
        Trouble{.name = "WrongDirection",
                .obstacle = Obstacle::encoder_reversed,
                .says = "counts down while the field turns forward",
                .change = [](auto& axis) { axis.encoders[0].reversed = true; },
                .claim = [](auto& settings) { settings.encoder_reversed = false; }},
        Trouble{.name = "WrongResolution",
                .obstacle = Obstacle::encoder_resolution,
                .says = "4096 counts lie between two N pulses, 1024 were claimed",
                .claim = [](auto& settings) { settings.encoder_resolution = 1024; }},
        Trouble{.name = "WrongResolutionWithoutIndex",
                .obstacle = Obstacle::encoder_resolution,
                .says = "no whole number",
                .claim = [](auto& settings) { settings.encoder_resolution = 5000; },
                .fault = [](auto& faults) { faults.common.encoders[0].index_lost = true; }},
        Trouble{.name = "NothingTellsTheResolution",
                .obstacle = Obstacle::encoder_resolution,
                .says = "state --encoder-resolution or --pole-pairs",
                .fault = [](auto& faults) { faults.common.encoders[0].index_lost = true; }},
        Trouble{.name = "WrongPolePairs",
                .obstacle = Obstacle::pole_pairs,
                .says = "a revolution in 4.00 electrical turns",
                .claim = [](auto& settings) { settings.pole_pairs = 5; }},
        Trouble{.name = "CurrentLoopTooFast",
                .obstacle = Obstacle::bandwidth,
                .says = "lower --current-bandwidth",
                .claim = [](auto& settings) { settings.current_bandwidth = 5000.0; }},
        Trouble{.name = "VelocityLoopTooFast",
                .obstacle = Obstacle::bandwidth,
                .says = "lower --velocity-bandwidth",
                .claim = [](auto& settings) { settings.velocity_bandwidth = 400.0; }},
        Trouble{.name = "PositionLoopTooFast",
                .obstacle = Obstacle::bandwidth,
                .says = "lower --position-bandwidth",
                .claim = [](auto& settings) { settings.position_bandwidth = 60.0; }},
        Trouble{.name = "GainTooSmallForItsRegister",
                .obstacle = Obstacle::gain_range,
                .says = "P position would be",
                .claim = [](auto& settings) { settings.position_bandwidth = 0.01; }}),
    [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace stator::experiment::tuning
