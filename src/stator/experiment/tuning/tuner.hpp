#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stator/devices/tmc8670/objects.hpp"
#include "stator/devices/tmc8670/servo_stage.hpp"
#include "stator/experiment/result.hpp"
#include "stator/experiment/tuning/encoder.hpp"
#include "stator/experiment/tuning/loop_design.hpp"
#include "stator/experiment/tuning/mechanics.hpp"
#include "stator/experiment/tuning/settings.hpp"
#include "stator/experiment/tuning/tuning_error.hpp"
#include "stator/experiment/tuning/verification.hpp"
#include "stator/experiment/tuning/winding.hpp"

namespace stator::experiment::tuning {

/// Everything a commissioning finds out.
struct Tuning {
  Winding winding;
  Encoder encoder;
  Mechanics mechanics;
  LoopDesign design;
  Verification verification;
};

/// Commissions the axis behind `stage`: offsets, resistance, inductances, encoder, gains of the
/// current loops, flux linkage, inertia and friction, gains of the outer loops, proof. Knows of the
/// motor what the registers of the FOC block tell. Leaves the registers set and the power stage
/// off. Throws TuningError for what cannot be measured.
[[nodiscard]] Tuning tune(devices::tmc8670::ServoStage& stage, const Settings& settings);

/// A tuned value as an object of the device, and what it is.
struct TunedObject {
  devices::tmc8670::ObjectValue object;
  std::string meaning;
};

/// The objects that hold the result, by index.
[[nodiscard]] std::vector<TunedObject> objects_of(const Tuning& tuning, const Settings& settings);

/// Steps with the linear model beside them, for a picture.
[[nodiscard]] Result step_curves(const Verification& verification);
/// Gain and phase of the closed loops with the linear model beside them.
[[nodiscard]] Result bode_curves(const Verification& verification);

}  // namespace stator::experiment::tuning
