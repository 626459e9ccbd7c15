#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stator/experiment/result.hpp"
#include "stator/experiment/tuning/encoder.hpp"
#include "stator/experiment/tuning/loop_design.hpp"
#include "stator/experiment/tuning/mechanics.hpp"
#include "stator/experiment/tuning/settings.hpp"
#include "stator/experiment/tuning/tuning_error.hpp"
#include "stator/experiment/tuning/verification.hpp"
#include "stator/experiment/tuning/winding.hpp"
#include "stator/product/catalogue/tuning.hpp"

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
[[nodiscard]] Tuning tune(product::TuningStage& stage, const Settings& settings);

/// What the drive is to be set to, for its product to make objects of.
[[nodiscard]] product::TunedDrive tuned_drive(const Tuning& tuning, const Settings& settings);

/// Steps with the linear model beside them, for a picture.
[[nodiscard]] Result step_curves(const Verification& verification);
/// Gain and phase of the closed loops with the linear model beside them.
[[nodiscard]] Result bode_curves(const Verification& verification);

}  // namespace stator::experiment::tuning
