// The experiment resonance: how a stepper's rotor swings around a full step, its frequency and
// damping.
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "stator/experiment/equations.hpp"
#include "stator/experiment/field_bench.hpp"
#include "stator/experiment/measurements.hpp"

namespace stator::experiment {

namespace {

constexpr Option kSwing{.name = "swing",
                        .unit = "microstep",
                        .help = "Size of the step towards the full step, of 256",
                        .minimum = 1.0,
                        .maximum = 128.0,
                        .preset = 24.0};
constexpr std::array kResonanceOptions{kCurrent, kSwing, kStep};

constexpr double kSettling = 1.0;       ///< s before the step
constexpr double kSmallestSwing = 0.2;  ///< of the first: smaller ones are not evaluated
constexpr int kMostSwings = 60;
constexpr double kElectricalDegrees = 180.0 / base::kPi;

/// A turning point of the rotor: when, and how far from the full step.
struct Extreme {
  double time;
  double angle;
};

/// Finds extremes in samples of an angle at equal distances; a parabola places them in between.
class ExtremeFinder {
 public:
  explicit ExtremeFinder(double step) : step_(step) {}

  void take(int n, double angle) {
    const double rise = current_ - before_;
    const double fall = angle - current_;
    if (n >= 2 && rise * fall < 0.0) {
      const double curvature = fall - rise;
      const double offset = -0.5 * (rise + fall) / curvature;
      found_.push_back({(n - 1 + offset) * step_, current_ + 0.25 * offset * (rise + fall)});
    }
    before_ = current_;
    current_ = angle;
  }
  [[nodiscard]] const std::vector<Extreme>& found() const { return found_; }

 private:
  double step_;
  double before_ = 0.0;
  double current_ = 0.0;
  std::vector<Extreme> found_;
};

/// What keeps the swings from being those of a linear spring with one constant friction. Both are
/// small, and both are known: the restoring torque bends, and breakaway friction acts at turning
/// points.
class SwingSize {
 public:
  SwingSize(const plant::StepperMotorParameters& motor, const Equations& equations, double current)
      : motor_(motor),
        holding_(equations.regulated_pull_out(current)),
        stiffness_(equations.stiffness(current)),
        turning_speed_(equations.natural_frequency(current) / motor.pole_pairs) {}

  /// Turning point of a linear spring that holds the same energy, electrical rad: of
  /// Th sin x + Td sin 4x it is (1 - cos x) Th + (1 - cos 4x) Td / 4.
  [[nodiscard]] double linear(double angle) const {
    const double energy = holding_ * (1.0 - std::cos(angle)) +
                          0.25 * motor_.detent_torque * (1.0 - std::cos(4.0 * angle));
    return std::sqrt(2.0 * energy / stiffness_);
  }
  /// By how much breakaway friction shortens the half period after a turning point of `size`: the
  /// mean of (Ts - Tc) / (1 + (w / ws)^2) along a cosine, twice, over the stiffness.
  [[nodiscard]] double breakaway_loss(double size) const {
    const double ratio = size * turning_speed_ / motor_.stribeck_speed;
    const double root = std::sqrt(1.0 + ratio * ratio);
    const double mean = std::atanh(ratio / root) / (ratio * root);
    return 2.0 * (motor_.static_friction - motor_.coulomb_friction) * mean / stiffness_;
  }

 private:
  plant::StepperMotorParameters motor_;
  double holding_;
  double stiffness_;
  double turning_speed_;  ///< shaft rad/s in the middle of a swing per electrical rad of its size
};

/// Straight line through the sizes of successive swings. Each half period takes a constant away by
/// dry friction and a part by viscous friction: a[n+1] = slope a[n] - constant, slope = exp(-d/2).
double logarithmic_decrement(const std::vector<Extreme>& extremes, const SwingSize& size) {
  double count = 0.0;
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t n = 0; n + 1 < extremes.size(); ++n) {
    const double now = size.linear(extremes[n].angle);
    const double next = size.linear(extremes[n + 1].angle) + size.breakaway_loss(now);
    count += 1.0;
    x += now;
    y += next;
    xx += now * now;
    xy += now * next;
  }
  const double slope = (count * xy - x * y) / (count * xx - x * x);
  return -2.0 * std::log(slope);
}

/// The equations' oscillation: after each turning point a damped cosine around the point at which
/// dry friction, that opposes the motion, is in balance.
class DampedSwing {
 public:
  DampedSwing(const Equations& equations, double current, double start)
      : decay_(equations.decay_rate()),
        dry_(equations.dry_deflection(current)),
        turning_point_(start) {
    const double natural = equations.natural_frequency(current);
    frequency_ = std::sqrt(natural * natural - decay_ * decay_);
  }

  /// Angle at `time`, which must not fall from call to call.
  double at(double time) {
    const double half_period = base::kPi / frequency_;
    while (time - begin_ >= half_period && std::fabs(turning_point_) > dry_) {
      turning_point_ = centre() - (turning_point_ - centre()) * std::exp(-decay_ * half_period);
      begin_ += half_period;
    }
    const double elapsed = time - begin_;
    if (std::fabs(turning_point_) <= dry_) {
      return turning_point_;
    }
    return centre() + (turning_point_ - centre()) * std::exp(-decay_ * elapsed) *
                          (std::cos(frequency_ * elapsed) +
                           decay_ / frequency_ * std::sin(frequency_ * elapsed));
  }

 private:
  [[nodiscard]] double centre() const { return turning_point_ > 0.0 ? dry_ : -dry_; }

  double decay_;
  double dry_;
  double frequency_ = 0.0;
  double turning_point_;
  double begin_ = 0.0;
};

}  // namespace

std::span<const Option> resonance_options() {
  return kResonanceOptions;
}

Result measure_resonance(const BenchSetup& setup, const Values& values) {
  plant::StepperAxisParameters axis = uncoupled(setup.axis);
  axis.load.constant_torque = 0.0;
  const Equations equations(axis);
  const double current = values.value_or("current", equations.rated_current());
  const double step_angle = values["swing"] * base::kPi / 512.0;
  FieldBench bench(axis, current, microseconds(values["step"]));
  const auto settling = static_cast<int>(kSettling / bench.step());
  for (int n = 0; n < settling; ++n) {
    bench.hold(step_angle);
  }

  const double start = bench.rotor();
  const double period = base::kTwoPi / equations.natural_frequency(current);
  DampedSwing expected(equations, current, start);
  Panel swing{"time", "ms", "rotor from full step", "° electrical", {}, {{"measured", {}, {}}, {}}};
  swing.curves[1] = {"linear equation of motion", Curve::Style::equation, {}};
  ExtremeFinder finder(bench.step());
  const auto shown = static_cast<int>(12.0 * period / bench.step());
  const int every = std::max(1, shown / 600);
  const auto longest = static_cast<int>(kMostSwings * 0.5 * period / bench.step());
  for (int n = 0; n <= longest; ++n) {
    if (n % every == 0) {
      values.reached(n, longest);
    }
    const double rotor = bench.rotor();
    finder.take(n, rotor);
    if (n <= shown && n % every == 0) {
      const double time = n * bench.step();
      swing.x.push_back(time * 1e3);
      swing.curves[0].values.push_back(rotor * kElectricalDegrees);
      swing.curves[1].values.push_back(expected.at(time) * kElectricalDegrees);
    }
    bench.hold(0.0);
  }
  std::vector<Extreme> extremes;
  for (const Extreme& extreme : finder.found()) {
    if (std::fabs(extreme.angle) < kSmallestSwing * std::fabs(start)) {
      break;
    }
    extremes.push_back(extreme);
  }
  if (extremes.size() < 4) {
    throw ExperimentError(
        "resonance: the rotor comes to rest within two periods, too few to tell frequency and "
        "damping; choose less friction, more --current or more --swing");
  }

  Result result;
  result.title = "Oscillation of the rotor around a full step";
  const auto half_periods = static_cast<double>(extremes.size() - 1);
  const double frequency = 0.5 * half_periods / (extremes.back().time - extremes.front().time);
  const double decay = equations.decay_rate();
  const double natural = equations.natural_frequency(current);
  result.comparisons.push_back({"frequency of the oscillation", "Hz", frequency,
                                std::sqrt(natural * natural - decay * decay) / base::kTwoPi});
  const double decrement =
      logarithmic_decrement(extremes, SwingSize(axis.motor, equations, current));
  result.comparisons.push_back({"logarithmic decrement per period", "", decrement,
                                equations.logarithmic_decrement(current)});
  result.comparisons.push_back({"viscous friction from it", "N m s/rad",
                                2.0 * equations.inertia() * decrement * frequency,
                                equations.viscous_friction()});

  Panel sizes{"half period", "", "turning point", "° electrical", {}, {{"measured", {}, {}}, {}}};
  sizes.curves[0].style = Curve::Style::measured_points;
  sizes.curves[1] = {"(a - dry) exp(-δ/2) - dry", Curve::Style::equation, {}};
  double size = std::fabs(start);
  const double dry = equations.dry_deflection(current);
  const double left = std::exp(-0.5 * equations.logarithmic_decrement(current));
  for (std::size_t n = 0; n < extremes.size(); ++n) {
    size = (size - dry) * left - dry;
    sizes.x.push_back(static_cast<double>(n + 1));
    sizes.curves[0].values.push_back(std::fabs(extremes[n].angle) * kElectricalDegrees);
    sizes.curves[1].values.push_back(size * kElectricalDegrees);
  }
  result.remarks.push_back(fmt::format(
      "{:.3g} A: stiffness Kt I + 4 Td = {:.3g} N m per electrical radian, J = {:.3g} kg m². A "
      "regulated current gives no electrical damping: the supply cancels the induced voltage.",
      current, equations.stiffness(current), equations.inertia()));
  result.panels = {swing, sizes};
  return result;
}

}  // namespace stator::experiment
