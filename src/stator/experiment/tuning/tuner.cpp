#include "stator/experiment/tuning/tuner.hpp"

#include <fmt/format.h>

namespace stator::experiment::tuning {
namespace {

void report_winding(const Chip& chip, const Winding& winding) {
  chip.report(fmt::format("  {:.4g} ohm, Ld {:.4g} mH, Lq {:.4g} mH", winding.resistance.value,
                          1e3 * winding.direct_inductance.value,
                          1e3 * winding.quadrature_inductance.value));
}

void report_mechanics(const Chip& chip, const Mechanics& mechanics) {
  chip.report(
      fmt::format("  flux linkage {:.4g} mV s, inertia {:.4g} kg m2, dry friction {:.3g} mN m",
                  1e3 * mechanics.flux_linkage.value, mechanics.inertia.value,
                  1e3 * mechanics.dry_friction.value));
}

}  // namespace

Tuning tune(product::TuningStage& stage, const Settings& settings) {
  Chip chip(stage, settings);
  Tuning result;
  try {
    chip.report("Current offsets: power stage off");
    measure_offsets(chip, result.winding);
    chip.report("Resistance: a current through each phase in turn, the shaft locks");
    measure_resistance(chip, result.winding);
    chip.report("Inductances: a sine on top of the locked field");
    measure_inductances(chip, result.winding);
    report_winding(chip, result.winding);
    chip.report("Encoder: the field turns slowly, forward and back");
    result.encoder = measure_encoder(chip);
    chip.report(fmt::format("  {} counts per revolution, {} pole pairs, counts {}",
                            result.encoder.resolution, result.encoder.pole_pairs,
                            result.encoder.reversed ? "down" : "up"));
    result.design = design_current_loops(chip, result.winding);
    chip.report("Flux linkage, inertia, friction: accelerating and braking with known current");
    result.mechanics = measure_mechanics(chip, result.winding, result.encoder.pole_pairs,
                                         result.encoder.resolution);
    design_outer_loops(chip, result.mechanics, result.design);
    measure_friction(chip, result.mechanics, result.design.supply);
    report_mechanics(chip, result.mechanics);
    chip.report("Proof: steps of current, velocity and position, then sines");
    result.verification = verify(chip, result.design, result.mechanics);
  } catch (...) {
    chip.enable(false);
    throw;
  }
  chip.enable(false);
  return result;
}

product::TunedDrive tuned_drive(const Tuning& tuning, const Settings& settings) {
  const LoopDesign& design = tuning.design;
  product::TunedDrive drive{
      .motor = settings.motor,
      .pole_pairs = tuning.encoder.pole_pairs,
      .current_scale = tuning.winding.current_scale,
      .current_offsets = {tuning.winding.offsets[0].value, tuning.winding.offsets[1].value},
      .pwm_maximum = settings.pwm_maximum,
      .encoder_resolution = tuning.encoder.resolution,
      .encoder_reversed = tuning.encoder.reversed,
      .encoder_offset = tuning.encoder.offset.value,
      .gains = {},
      .torque_limit = design.torque_limit,
      .torque_counts = design.torque_limit * settings.board.counts_per_ampere,
      .velocity_limit = design.velocity_limit};
  for (const Gain& gain : design.gains) {
    drive.gains.push_back({.name = gain.name, .format = gain.format, .value = gain.value});
  }
  return drive;
}

}  // namespace stator::experiment::tuning
