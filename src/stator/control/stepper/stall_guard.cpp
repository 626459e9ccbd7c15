#include "stator/control/stepper/stall_guard.hpp"

#include <algorithm>
#include <cmath>

namespace stator::control {

namespace {

constexpr int kFilterLength = 4;  // full steps

}  // namespace

bool StallGuard::finish_full_step(const StallGuardSettings& settings, int quadrant, bool forward) {
  const bool whole = whole_;
  whole_ = quadrant_ >= 0;
  quadrant_ = quadrant;
  // sum P / sqrt(mean i^2) is the sum of P / I.
  const double current = samples_ > 0.0 ? std::sqrt(square_current_ / samples_) : 0.0;
  const double unused =
      (forward ? induced_ : -induced_) - (current > 0.0 ? converted_ / current : 0.0);
  const double level =
      samples_ > 0.0 ? kCountsPerVolt * unused * regulated_ / (samples_ * samples_) : 0.0;
  induced_ = converted_ = square_current_ = samples_ = regulated_ = 0.0;
  if (!whole) {
    return false;
  }
  filtered_ += level;
  ++filtered_steps_;
  const int length = settings.filter ? kFilterLength : 1;
  if (filtered_steps_ < length) {
    return false;
  }
  const double mean = filtered_ / filtered_steps_;
  filtered_ = 0.0;
  filtered_steps_ = 0;
  value_ = static_cast<std::uint16_t>(std::clamp(mean + kCountsPerThreshold * settings.threshold,
                                                 0.0, static_cast<double>(kMaximum)));
  return true;
}

}  // namespace stator::control
