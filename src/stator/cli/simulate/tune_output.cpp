#include "stator/cli/simulate/tune_output.hpp"

#include <cmath>

#include <fmt/format.h>

#include "stator/base/trigonometry.hpp"
#include "stator/cli/simulate/simulation_output.hpp"

namespace stator::cli {

namespace {

using experiment::tuning::BodePlot;
using experiment::tuning::Encoder;
using experiment::tuning::Gain;
using experiment::tuning::Measured;
using experiment::tuning::StepResponse;
using experiment::tuning::Tuning;

void print_measured(const char* quantity, const Measured& measured, double factor,
                    const char* unit) {
  fmt::print("{:26}  {:>11.5g}  {:>9.2g}  {}\n", quantity, factor * measured.value,
             factor * measured.deviation, unit);
}

void print_motor(const Tuning& tuning) {
  constexpr double kMilli = 1e3;
  constexpr double kMicro = 1e6;
  constexpr double kSquareRootOfThree = 1.73205080756887729353;
  constexpr double kThousandRpm = 1000.0 * base::kTwoPi / 60.0;
  constexpr double kDegrees = 360.0 / 65536.0;
  const auto& winding = tuning.winding;
  const auto& mechanics = tuning.mechanics;
  const Encoder& encoder = tuning.encoder;
  fmt::print("\n{:26}  {:>11}  {:>9}  {}\n", "QUANTITY", "MEASURED", "DEVIATION", "UNIT");
  print_measured("supply", winding.supply, 1.0, "V");
  print_measured("current offset 0", winding.offsets[0], 1.0, "counts");
  print_measured("current offset 1", winding.offsets[1], 1.0, "counts");
  print_measured("phase resistance", winding.resistance, kMilli, "mOhm, transistor included");
  print_measured("inductance Ld", winding.direct_inductance, kMicro, "uH");
  print_measured("inductance Lq", winding.quadrature_inductance, kMicro, "uH");
  fmt::print("{:26}  {:>11}  {:>9}\n", "pole pairs", encoder.pole_pairs, "");
  fmt::print("{:26}  {:>11}  {:>9}  {}\n", "encoder", encoder.resolution, "",
             encoder.reversed ? "counts/rev, counts down" : "counts/rev, counts up");
  print_measured("encoder offset", encoder.offset, kDegrees, "degree, electrical");
  if (encoder.has_index) {
    print_measured("  from the N pulse", {encoder.index_offset, encoder.offset.deviation}, kDegrees,
                   "degree, electrical");
  }
  print_measured("flux linkage", mechanics.flux_linkage, kMilli, "mV s");
  const double poles = encoder.pole_pairs;
  print_measured("back-EMF, line to line", mechanics.flux_linkage,
                 kSquareRootOfThree * poles * kThousandRpm, "V peak/1000 rpm");
  print_measured("torque constant", mechanics.flux_linkage,
                 kMilli * mechanics.torque_constant / mechanics.flux_linkage.value, "mN m/A peak");
  print_measured("inertia", mechanics.inertia, 1e7, "g cm2, load included");
  print_measured("dry friction", mechanics.dry_friction, kMilli, "mN m");
  print_measured("viscous friction", mechanics.viscous_friction, kMicro, "uN m s/rad");
  print_measured("load torque", mechanics.load_torque, kMilli, "mN m");
}

void print_gains(const Tuning& tuning) {
  fmt::print("\n{:26}  {:>11}  {:>9}  {}\n", "GAIN", "CALCULATED", "REGISTER", "FORMAT");
  for (const Gain& gain : tuning.design.gains) {
    fmt::print("{:26}  {:>11.2f}  {:>9}  {}, {:+.2f} %{}\n", gain.name, gain.wanted, gain.value,
               gain.format, 100.0 * gain.error(), gain.cut() ? ", cut to its range" : "");
  }
  for (const std::string& remark : tuning.design.remarks) {
    fmt::print("{}\n", remark);
  }
}

std::string hertz(double value) {
  return value > 0.0 ? fmt::format("{:.4g} Hz", value) : "-";
}

void print_loop(const char* loop, double wanted, const BodePlot* bode, const StepResponse& step) {
  fmt::print("{:10}  {:>10}  {:>10}  {:>12}  {:>9.3g} ms  {:>8.1f} %\n", loop, hertz(wanted),
             bode != nullptr ? hertz(bode->bandwidth) : "",
             bode != nullptr ? fmt::format("{:.0f} degree", bode->phase_margin) : "",
             1e3 * step.rise_time, 100.0 * std::fmax(step.overshoot, 0.0));
}

}  // namespace

void print_tuning(const Tuning& tuning) {
  print_motor(tuning);
  print_gains(tuning);
  const auto& proof = tuning.verification;
  fmt::print("\n{:10}  {:>10}  {:>10}  {:>12}  {:>12}  {:>10}\n", "LOOP", "WANTED", "BANDWIDTH",
             "MARGIN", "RISE 10-90 %", "OVERSHOOT");
  print_loop("current", tuning.design.wanted_current, &proof.current, proof.current_step);
  print_loop("velocity", tuning.design.wanted_velocity, &proof.velocity, proof.velocity_step);
  print_loop("position", tuning.design.wanted_position, nullptr, proof.position_step);
}

void draw_tuning(const Tuning& tuning, const std::string& prefix) {
  const auto keep = [&](const experiment::Result& result, const char* name) {
    const std::string path = prefix + name;
    write_csv(result, path + ".csv");
    draw(result, path + ".csv", path + ".svg");
    draw(result, path + ".csv", path + ".png");
  };
  keep(step_curves(tuning.verification), "-steps");
  keep(bode_curves(tuning.verification), "-bode");
}

}  // namespace stator::cli
