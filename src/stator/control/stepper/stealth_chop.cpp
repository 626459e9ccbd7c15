#include "stator/control/stepper/stealth_chop.hpp"

#include <algorithm>
#include <cmath>

namespace stator::control {

namespace {

constexpr double kClock = 16e6;  // Hz
constexpr double kFullAmplitude = 255.0;

}  // namespace

double stealth_chop_duty(const StealthChopSettings& settings, double speed, double current) {
  const double gained = settings.gradient * 256.0 * speed / kClock;
  return std::min(1.0, (settings.amplitude * current + gained) / kFullAmplitude);
}

std::array<double, 2> coil_duty(const std::array<double, 2>& current_target, double crest) {
  const double amplitude =
      std::sqrt(current_target[0] * current_target[0] + current_target[1] * current_target[1]);
  const double scale = amplitude > 0.0 ? crest / amplitude : 0.0;
  return {scale * current_target[0], scale * current_target[1]};
}

}  // namespace stator::control
