#include "stator/experiment/tuning/mechanics.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>

#include "stator/base/trigonometry.hpp"
#include "stator/experiment/tuning/statistics.hpp"
#include "stator/experiment/tuning/tuning_error.hpp"

namespace stator::experiment::tuning {
namespace {

using control::foc::field;

constexpr std::int32_t kTorqueMode = 1;
constexpr std::int32_t kVelocityMode = 2;
constexpr double kRpm = base::kTwoPi / 60.0;  // rad/s
constexpr double kVoltageShare = 0.45;  // of full modulation: room for the current controllers
constexpr int kPeriods = 16;            // PWM periods of a slice

/// Means over some PWM periods.
struct Slice {
  double begin = 0.0;  ///< rad of the shaft, at its begin
  double time = 0.0;   ///< s it took
  Sample mean;
};

/// Braking returns energy, which a source with a diode does not take: from this much more than its
/// voltage on a current along the magnets burns it, from that much on torque rests.
constexpr double kBurnAbove = 1.03;
constexpr double kRestAbove = 1.25;

void set_currents(Chip& chip, double flux, double torque) {
  chip.set(field("PID_FLUX_TARGET"), std::lround(flux / chip.ampere()));
  chip.set(field("PID_TORQUE_TARGET"), std::lround(torque / chip.ampere()));
}

/// The shaft turned by a current, in slices.
class Run {
 public:
  Run(Chip& chip, double supply, double radians_per_count)
      : chip_(chip), supply_(supply), radians_per_count_(radians_per_count) {}

  void set_torque(double current) { current_ = current; }
  [[nodiscard]] double angle() const {
    return radians_per_count_ * static_cast<double>(chip_.count());
  }
  void take_slice() {
    const double share = chip_.supply() / supply_;
    set_currents(chip_, share > kBurnAbove ? 0.7 * chip_.settings().current : 0.0,
                 share > kRestAbove ? 0.0 : current_);
    Slice slice{.begin = angle(), .time = kPeriods * chip_.period(), .mean = {}};
    for (int k = 0; k < kPeriods; ++k) {
      chip_.step();
      const Sample sample = chip_.sample();
      slice.mean.id += sample.id / kPeriods;
      slice.mean.iq += sample.iq / kPeriods;
      slice.mean.ud += sample.ud / kPeriods;
      slice.mean.uq += sample.uq / kPeriods;
      slice.mean.supply += sample.supply / kPeriods;
    }
    slices_.push_back(slice);
  }
  [[nodiscard]] const std::vector<Slice>& slices() const { return slices_; }
  void clear() { slices_.clear(); }
  /// Speed over the last slices, rad/s.
  [[nodiscard]] double speed() const {
    constexpr std::size_t kBack = 6;
    if (slices_.size() < kBack) {
      return 0.0;
    }
    const Slice& then = slices_[slices_.size() - kBack];
    return (angle() - then.begin) / (static_cast<double>(kBack) * then.time);
  }
  /// Share of full modulation in the last slice.
  [[nodiscard]] double modulation() const {
    const Sample& last = slices_.back().mean;
    return std::hypot(last.ud, last.uq) / (32768.0 * chip_.volt_at(last.supply));
  }

 private:
  Chip& chip_;
  double supply_;  ///< V of the source
  double radians_per_count_;
  double current_ = 0.0;  ///< A
  std::vector<Slice> slices_;
};

/// Accelerates with `current` until the speed in its direction exceeds `speed`, the voltage its
/// share or `longest` seconds have passed. Returns the speed.
double accelerate(Chip& chip, Run& run, double current, double speed, double longest) {
  run.set_torque(current);
  const double sign = current > 0.0 ? 1.0 : -1.0;
  const auto most = static_cast<int>(longest / (kPeriods * chip.period()));
  for (int n = 0; n < most; ++n) {
    run.take_slice();
    const double now = sign * run.speed();
    if (now > speed || (now > 0.0 && n > 8 && run.modulation() > kVoltageShare)) {
      break;
    }
  }
  return run.speed();
}

void brake_to_rest(Chip& chip, Run& run, double current) {
  const double speed = run.speed();
  accelerate(chip, run, speed > 0.0 ? -current : current, 0.0, 3.0);
  run.set_torque(0.0);
  set_currents(chip, 0.0, 0.0);
}

/// A current with which the shaft gets going, or an error.
double starting_current(Chip& chip, Run& run, double radians_per_turn) {
  for (const double share : {0.3, 0.6, 1.0}) {
    const double current = share * chip.settings().current;
    const double from = run.angle();
    run.set_torque(current);
    for (int left = chip.periods(0.3) / kPeriods; left > 0; --left) {
      run.take_slice();
      if (std::fabs(run.angle() - from) > radians_per_turn) {
        brake_to_rest(chip, run, current);
        return current;
      }
    }
  }
  run.set_torque(0.0);
  set_currents(chip, 0.0, 0.0);
  throw TuningError(Obstacle::shaft_blocked,
                    fmt::format("inertia: {:.3g} A do not turn the shaft by one electrical turn in "
                                "0.3 s; free it or raise --current",
                                chip.settings().current));
}

/// The applied voltage across the rotor: between sample and the middle of the period in which the
/// bridge applies the vector, the rotor turns on.
double voltage_across(const Slice& slice, double electrical_speed, double period) {
  const base::SineCosine z = base::sine_cosine(1.5 * period * electrical_speed);
  return slice.mean.uq * z.cosine - slice.mean.ud * z.sine;
}

/// Unknowns: flux linkage, what dead time takes along the current as a share of the supply, offset.
void add_voltages(LeastSquares<3>& fit, const std::vector<Slice>& slices, const Winding& winding,
                  double poles, double period) {
  constexpr double kLeastCurrent = 1e-3;  // A
  for (std::size_t n = 0; n + 1 < slices.size(); ++n) {
    const Slice& slice = slices[n];
    const double electrical = poles * (slices[n + 1].begin - slice.begin) / slice.time;
    const double emf = voltage_across(slice, electrical, period) -
                       winding.resistance.value * slice.mean.iq -
                       electrical * winding.direct_inductance.value * slice.mean.id;
    const double current = std::hypot(slice.mean.id, slice.mean.iq);
    const double along = slice.mean.iq / std::max(current, kLeastCurrent);
    fit.add({electrical, slice.mean.supply * along, 1.0}, emf);
  }
}

/// What has settled after the step of the current.
std::vector<Slice> steady(const std::vector<Slice>& slices) {
  constexpr std::ptrdiff_t kStep = 4;
  return {slices.begin() + std::min(kStep, std::ssize(slices)), slices.end()};
}

/// Slices put together `many` at a time.
std::vector<Slice> merged(const std::vector<Slice>& slices, std::size_t many) {
  std::vector<Slice> result;
  for (std::size_t n = 0; n + many <= slices.size(); n += many) {
    Slice sum{.begin = slices[n].begin, .time = 0.0, .mean = {}};
    for (std::size_t k = n; k < n + many; ++k) {
      sum.time += slices[k].time;
      sum.mean.iq += slices[k].mean.iq / static_cast<double>(many);
    }
    result.push_back(sum);
  }
  return result;
}

/// Unknowns: 1/J times torque constant, dry friction, viscous friction, load torque.
void add_accelerations(LeastSquares<4>& fit, const std::vector<Slice>& slices) {
  for (std::size_t n = 0; n + 2 < slices.size(); ++n) {
    const Slice& first = slices[n];
    const Slice& second = slices[n + 1];
    const double before = (second.begin - first.begin) / first.time;
    const double after = (slices[n + 2].begin - second.begin) / second.time;
    if (before * after <= 0.0) {
      continue;  // dry friction changed its sign somewhere within
    }
    const double current = 0.5 * (first.mean.iq + second.mean.iq);
    const double speed = 0.5 * (before + after);
    fit.add({current, speed > 0.0 ? -1.0 : 1.0, -speed, 1.0}, (after - before) / first.time);
  }
}

Measured scaled(const Measured& of, double factor) {
  return {of.value * factor, std::fabs(of.deviation * factor)};
}

}  // namespace

Mechanics measure_mechanics(Chip& chip, const Winding& winding, std::int32_t pole_pairs,
                            std::int32_t resolution) {
  constexpr double kLongest = 2.0;  // s of one acceleration
  constexpr int kReversals = 6;
  Run run(chip, winding.supply.value, base::kTwoPi / resolution);
  set_currents(chip, 0.0, 0.0);
  chip.close_loop(kTorqueMode);
  const double turn = base::kTwoPi / pole_pairs;
  const double current = starting_current(chip, run, turn);
  const double given = chip.settings().highest_speed;
  const double limit = given > 0.0 ? given * base::kTwoPi / 60.0 : 1e6;
  Mechanics result;
  result.highest_speed = accelerate(chip, run, current, limit, kLongest);
  LeastSquares<4> acceleration;
  LeastSquares<3> voltage;
  for (int n = 0; n < kReversals; ++n) {
    run.clear();
    const double sign = n % 2 == 0 ? -1.0 : 1.0;
    accelerate(chip, run, sign * current, result.highest_speed, 2.0 * kLongest);
    const std::vector<Slice> slices = steady(run.slices());
    add_voltages(voltage, slices, winding, pole_pairs, chip.period());
    add_accelerations(acceleration, merged(slices, std::max<std::size_t>(1, slices.size() / 24)));
  }
  brake_to_rest(chip, run, current);
  if (chip.take_clipped()) {
    throw TuningError(
        Obstacle::current_range,
        "inertia: a current left the range of its converter; choose a lower --current");
  }
  result.flux_linkage = voltage.solve()[0];
  result.torque_constant = chip.torque_factor() * pole_pairs * result.flux_linkage.value;
  const auto found = acceleration.solve();
  const double inertia = result.torque_constant / found[0].value;
  result.inertia = {
      inertia, inertia * std::hypot(found[0].deviation / found[0].value,
                                    result.flux_linkage.deviation / result.flux_linkage.value)};
  result.dry_friction = scaled(found[1], inertia);
  result.viscous_friction = scaled(found[2], inertia);
  result.load_torque = scaled(found[3], inertia);
  return result;
}

void step_burning(Chip& chip, double supply) {
  const double burning = chip.supply() > kBurnAbove * supply ? 0.7 * chip.settings().current : 0.0;
  chip.set(field("PID_FLUX_TARGET"), std::lround(burning / chip.ampere()));
  chip.step();
}

void change_velocity(Chip& chip, const Mechanics& mechanics, double supply, std::int32_t target) {
  constexpr double kShare = 0.3;
  constexpr double kSettle = 0.3;    // s
  constexpr double kLongest = 60.0;  // s
  const double acceleration =
      kShare * chip.settings().current * mechanics.torque_constant / mechanics.inertia.value;
  const double step = acceleration * chip.period() / kRpm;  // rpm
  double wanted = chip.get(field("PID_VELOCITY_TARGET"));
  int left = chip.periods(kLongest);
  while (std::lround(wanted) != target && left-- > 0) {
    const double missing = target - wanted;
    wanted += chip.supply() > kRestAbove * supply ? 0.0 : std::clamp(missing, -step, step);
    chip.set(field("PID_VELOCITY_TARGET"), std::lround(wanted));
    step_burning(chip, supply);
  }
  for (left = chip.periods(kSettle); left > 0; --left) {
    step_burning(chip, supply);
  }
}

void measure_friction(Chip& chip, Mechanics& mechanics, double supply) {
  constexpr double kAverage = 0.5;  // s
  LeastSquares<3> fit;
  set_currents(chip, 0.0, 0.0);
  chip.set(field("PID_VELOCITY_TARGET"), 0);
  chip.close_loop(kVelocityMode);
  for (const double share : {0.25, 0.5, 0.75, -0.25, -0.5, -0.75}) {
    const auto target =
        static_cast<std::int32_t>(std::lround(share * mechanics.highest_speed / kRpm));
    change_velocity(chip, mechanics, supply, target);
    Mean current;
    for (int left = chip.periods(kAverage); left > 0; --left) {
      step_burning(chip, supply);
      current.add(chip.ampere() * chip.get(field("PID_TORQUE_ACTUAL")));
    }
    fit.add({share > 0.0 ? 1.0 : -1.0, target * kRpm, -1.0},
            mechanics.torque_constant * current.value());
  }
  change_velocity(chip, mechanics, supply, 0);
  const auto found = fit.solve();
  mechanics.dry_friction = found[0];
  mechanics.viscous_friction = found[1];
  mechanics.load_torque = found[2];
}

void settle_supply(Chip& chip, double volts) {
  constexpr double kEnough = 1.005;
  constexpr double kLongest = 3.0;  // s
  constexpr double kRest = 0.02;    // s until currents are gone
  set_currents(chip, 0.0, 0.0);
  chip.close_loop(kTorqueMode);
  for (int left = chip.periods(kLongest); left > 0 && chip.supply() > kEnough * volts; --left) {
    chip.set(field("PID_FLUX_TARGET"), std::lround(0.7 * chip.settings().current / chip.ampere()));
    chip.step();
  }
  set_currents(chip, 0.0, 0.0);
  chip.run(kRest);
}

}  // namespace stator::experiment::tuning
