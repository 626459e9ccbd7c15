#include "stator/control/servo/current_controllers.hpp"

#include <cmath>

#include "stator/control/servo/space_vector.hpp"

namespace stator::control {

void CurrentControllers::configure(std::uint16_t proportional, std::uint16_t integral) {
  constexpr double kOutputUnit = 256.0;  // 16 bits of the output less 8 of P
  proportional_ = both(kOutputUnit * proportional);
  integral_ = both(integral);
  inverse_integral_ = integral == 0 ? 0.0 : 1.0 / integral;
  accumulates_ = integral == 0 ? Mask{0, 0} : Mask{-1, -1};
  sum_ = kept(sum_, accumulates_);
}

void CurrentControllers::change_integral(std::uint16_t integral) {
  const Pair voltage = integral_ * sum_;
  integral_ = both(integral);
  inverse_integral_ = integral == 0 ? 0.0 : 1.0 / integral;
  accumulates_ = integral == 0 ? Mask{0, 0} : Mask{-1, -1};
  // Towards zero, so that the integral part stays within the limit.
  for (const int axis : {0, 1}) {
    sum_[axis] = static_cast<double>(static_cast<std::int64_t>(voltage[axis] * inverse_integral_));
  }
}

// An error with the sign of the cut pushes further.
CurrentControllers::Mask CurrentControllers::without_cut(Pair error) const {
  const Mask pushes =
      error * Pair{static_cast<double>(cut_.d), static_cast<double>(cut_.q)} > both(0.0);
  return accumulates_ & ~pushes;
}

Pair CurrentControllers::step_at_limit(Pair sum, double limit) {
  const auto whole = static_cast<double>(static_cast<std::int64_t>(limit));
  const auto step_one = [&](int axis, int& cut) {
    double integral = integral_[axis] * sum[axis];
    if (std::fabs(integral) > whole) {
      // Towards zero, so that the integral part stays within the limit.
      sum[axis] = static_cast<double>(
          static_cast<std::int64_t>(std::copysign(whole, integral) * inverse_integral_));
      integral = integral_[axis] * sum[axis];
    }
    const double output = proportional_[axis] * error_[axis] + integral;
    cut = static_cast<int>(output > whole) - static_cast<int>(output < -whole);
    return std::clamp(output, -whole, whole);
  };
  RotorVector voltage;
  voltage.d = step_one(0, cut_.d);
  voltage.q = step_one(1, cut_.q);
  if (limit_circle(voltage, limit)) {
    cut_.q = voltage.q < 0.0 ? -1 : 1;
  }
  sum_ = sum;
  return Pair{voltage.d, voltage.q};
}

}  // namespace stator::control
