#include "stator/experiment/tuning/tuner.hpp"

#include <cmath>

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

Tuning tune(devices::tmc8670::ServoStage& stage, const Settings& settings) {
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

std::vector<TunedObject> objects_of(const Tuning& tuning, const Settings& settings) {
  constexpr std::int64_t kAbn = 3;
  constexpr std::int64_t kAbnMechanical = 9;
  std::vector<TunedObject> objects;
  const auto add = [&](std::uint16_t index, int subindex, std::int64_t value, std::string meaning) {
    objects.push_back({{.index = index,
                        .subindex = static_cast<std::uint8_t>(subindex),
                        .bits = static_cast<std::uint64_t>(value)},
                       std::move(meaning)});
  };
  const Encoder& encoder = tuning.encoder;
  const auto& offsets = tuning.winding.offsets;
  add(0x2000, 1, static_cast<std::int64_t>(settings.motor), "motor type");
  add(0x2000, 2, encoder.pole_pairs, "pole pairs");
  add(0x2000, 3, tuning.winding.current_scale, "current scale");
  add(0x2000, 4, std::lround(offsets[0].value), "current offset 0");
  add(0x2000, 5, std::lround(offsets[1].value), "current offset 1");
  add(0x2001, 1, settings.pwm_maximum, "PWM maximum count, which the gains hold for");
  add(0x2001, 5, 1, "space vectors");
  add(0x2010, 1, encoder.resolution, "encoder positions per revolution");
  add(0x2010, 7, encoder.reversed ? 1 : 0, "encoder direction");
  add(0x2010, 8, std::lround(encoder.offset.value), "encoder electrical offset");
  add(0x2020, 1, kAbn, "commutation by the encoder");
  add(0x2020, 2, kAbnMechanical, "velocity of the shaft, rpm");
  add(0x2020, 3, kAbnMechanical, "position of the shaft");
  int subindex = 0;  // gains stand in the order of 2030h
  for (const Gain& gain : tuning.design.gains) {
    add(0x2030, ++subindex, gain.value, fmt::format("{}, {}", gain.name, gain.format));
  }
  add(0x2030, 8, 1, "advanced structure");
  add(0x2030, 9, 0, "velocity in every PWM period");
  add(0x2030, 10, 0, "position in every PWM period");
  add(0x2031, 1, std::lround(tuning.design.torque_limit * settings.board.counts_per_ampere),
      fmt::format("torque and flux limit, {:.3g} A", tuning.design.torque_limit));
  add(0x2031, 3, std::lround(tuning.design.velocity_limit), "velocity limit, rpm");
  return objects;
}

}  // namespace stator::experiment::tuning
