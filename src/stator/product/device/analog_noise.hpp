#pragma once

#include <cmath>
#include <cstdint>

#include "stator/base/random.hpp"

namespace stator::product {

/// Disturbance of a converter's readings, equally distributed; none by default. A seed gives the
/// same readings in every run.
class AnalogNoise {
 public:
  explicit AnalogNoise(std::uint64_t seed) : random_(seed) {}

  /// Counts by which a reading is off at most, either way.
  void set_amplitude(double counts) { amplitude_ = static_cast<std::int32_t>(std::lround(counts)); }

  /// `counts` as the converter reads them now, 0..`full_scale`.
  [[nodiscard]] std::int32_t disturb(std::int32_t counts, std::int32_t full_scale) {
    if (amplitude_ == 0) [[likely]] {
      return counts;
    }
    const auto spread = 2 * static_cast<std::uint64_t>(amplitude_) + 1;
    const std::int32_t disturbed =
        counts + static_cast<std::int32_t>(random_.below(spread)) - amplitude_;
    return disturbed < 0 ? 0 : disturbed > full_scale ? full_scale : disturbed;
  }

 private:
  base::Random random_;
  std::int32_t amplitude_ = 0;
};

}  // namespace stator::product
