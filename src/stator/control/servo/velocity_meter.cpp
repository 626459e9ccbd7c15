#include "stator/control/servo/velocity_meter.hpp"

#include <algorithm>

namespace stator::control {

double VelocityMeter::measure(std::uint32_t period) {
  const std::uint32_t silent = period - reference_period_;
  const std::int64_t moved = edge_position_ - reference_position_;
  if (moved != 0) {
    const auto way = static_cast<double>(moved);
    const bool turned_back = (moved > 0) != forward_ && moved >= -1 && moved <= 1;
    forward_ = moved > 0;
    // A shaft that stood long has its reference further back than the edge's time can tell.
    const std::uint32_t duration = std::clamp(edge_period_ - reference_period_, 1U, kStillLimit);
    velocity_ = turned_back ? 0.0 : way / static_cast<double>(duration);
    reference_position_ = edge_position_;
    reference_period_ = edge_period_;
  } else if (silent >= kStillLimit) {
    velocity_ = 0.0;
    reference_period_ = period - kStillLimit;  // keeps differences of the counter unambiguous
  } else if (velocity_ != 0.0) {
    const double bound = 1.0 / static_cast<double>(silent);
    velocity_ = std::clamp(velocity_, -bound, bound);
  }
  return velocity_;
}

}  // namespace stator::control
