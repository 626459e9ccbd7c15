#include "stator/experiment/tuning/loop_model.hpp"

#include <algorithm>
#include <cmath>

#include "stator/base/trigonometry.hpp"

namespace stator::experiment::tuning {
namespace {

using Response = LoopModel::Response;

constexpr double kMeterPeriod = 15.0 / 65536.0;  // s
constexpr int kMeterSamples = 4;

/// exp(j x)
Response turned(double x) {
  const base::SineCosine z = base::sine_cosine(x);
  return {z.cosine, z.sine};
}

/// Mean over `time` seconds that end now.
Response mean_over(double time, double angular) {
  const double x = angular * time;
  return std::fabs(x) < 1e-9 ? Response(1.0) : (1.0 - turned(-x)) / Response(0.0, x);
}

constexpr double kLowest = 0.01;  // Hz
constexpr double kRatio = 1.005;  // of neighbouring frequencies

}  // namespace

Response LoopModel::locked_current(double frequency) const {
  const Response z = turned(base::kTwoPi * frequency * period);
  return current_share / (z * z - z + current_share);
}

Response LoopModel::current(double frequency) const {
  if (emf_constant == 0.0) {
    return locked_current(frequency);
  }
  const Response s(0.0, base::kTwoPi * frequency);
  const Response locked = locked_current(frequency);
  const Response winding = resistance + inductance * s;
  const Response emf = emf_constant * torque_constant / (inertia * s + viscous_friction);
  const Response open = locked / (1.0 - locked) * winding / (winding + emf);
  return open / (1.0 + open);
}

Response LoopModel::meter(double frequency) {
  const double angular = base::kTwoPi * frequency;
  return mean_over(kMeterSamples * kMeterPeriod, angular) * mean_over(kMeterPeriod, angular);
}

Response LoopModel::velocity_path(double frequency) const {
  const Response s(0.0, base::kTwoPi * frequency);
  return current(frequency) * torque_constant / (inertia * s + viscous_friction) * meter(frequency);
}

Response LoopModel::velocity_controller(double frequency) const {
  const Response back = turned(-base::kTwoPi * frequency * period);
  return velocity_gain * (1.0 + velocity_integral * period / (1.0 - back));
}

Response LoopModel::velocity(double frequency) const {
  const Response open = velocity_controller(frequency) * velocity_path(frequency);
  return open / (1.0 + open);
}

Response LoopModel::position(double frequency) const {
  const Response s(0.0, base::kTwoPi * frequency);
  const Response open = position_gain / s * velocity(frequency) / meter(frequency);
  return open / (1.0 + open);
}

double bandwidth_of(const LoopModel& model, Response (LoopModel::*loop)(double) const) {
  const double half_power = std::sqrt(0.5);
  const double highest = 0.5 / model.period;
  double high = kLowest;
  while (high < highest && std::abs((model.*loop)(high)) >= half_power) {
    high *= kRatio;
  }
  if (high >= highest) {
    return 0.0;
  }
  double low = high / kRatio;
  for (int n = 0; n < 30; ++n) {
    const double middle = 0.5 * (low + high);
    (std::abs((model.*loop)(middle)) < half_power ? high : low) = middle;
  }
  return high;
}

double peak_of(const LoopModel& model, Response (LoopModel::*loop)(double) const) {
  double peak = 0.0;
  double frequency = kLowest;
  while (frequency < 0.5 / model.period) {
    peak = std::max(peak, std::abs((model.*loop)(frequency)));
    frequency *= kRatio;
  }
  return peak;
}

}  // namespace stator::experiment::tuning
