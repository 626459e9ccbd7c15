#include "stator/control/foc/velocity_meter.hpp"

namespace stator::control::foc {

void VelocityMeter::measure(std::int32_t turned, std::int32_t ticks) {
  constexpr std::int64_t kRpm = 6'000'000'000;  // revolutions per 10 ns in rpm
  constexpr std::int64_t kStandstill = 10'000'000;
  way_ += turned;
  time_ += ticks;
  if (way_ >= least_way_ || way_ <= -least_way_) {
    by_time_ = saturate_s32(way_ * kRpm / (time_ << 16));
    way_ = 0;
    time_ = 0;
  } else if (time_ >= kStandstill) {
    by_time_ = 0;
    way_ = 0;
    time_ = 0;
  }
}

}  // namespace stator::control::foc
