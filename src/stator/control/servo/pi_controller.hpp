#pragma once

#include <cstdint>

#include "stator/control/rounding.hpp"

namespace stator::control {

/// Where the binary points of a PI controller's integers stand.
struct PiFormat {
  int proportional_bits = 8;  ///< of P: 256 = 1
  int integral_bits = 16;     ///< of I: 65536 = 1 per period
  int error_bits = 0;         ///< of the error
};

/// A PI controller in integers:
///   output = P * e / 2^p + I * sum(e) / 2^i,   |output| <= limit
///
/// Output and limit carry 16 bits behind the binary point, so that no rounding of the output makes
/// the loop hunt. Two rules prevent wind-up: |I * sum| stays within the limit, and while the output
/// is cut an error that pushes further is not added. A limiter behind the controller tells it of
/// its cut with set_cut(). With I = 0 the sum is 0.
///
/// Ranges: |e| < 2^31, P and I 0..65535, limit 0 .. 2^46.
template <PiFormat format>
class PiController {
 public:
  static constexpr int kOutputBits = 16;

  void configure(std::uint16_t proportional, std::uint16_t integral) {
    proportional_ = proportional;
    integral_ = integral;
    integral_mask_ = integral == 0 ? 0 : -1;
    inverse_integral_ = integral == 0 ? 0.0 : 1.0 / integral;
    sum_ &= integral_mask_;
  }

  /// One period with error `error`; `limit` and result in 2^-16 of the output's unit.
  std::int64_t step(std::int32_t error, std::int64_t limit) {
    error_ = error;
    if (cut_ == 0 || (cut_ > 0) != (error > 0)) {
      sum_ += error & integral_mask_;
    }
    std::int64_t integral = shifted<kIntegralShift>(integral_ * sum_);
    if (integral > limit || integral < -limit) {
      sum_ = sum_for(integral > limit ? limit : -limit);
      integral = shifted<kIntegralShift>(integral_ * sum_);
    }
    const std::int64_t output =
        shifted<kProportionalShift>(proportional_ * std::int64_t{error}) + integral;
    cut_ = static_cast<int>(output > limit) - static_cast<int>(output < -limit);
    return cut_ == 0 ? output : (cut_ > 0 ? limit : -limit);
  }

  /// The output was cut further by a later stage: +1 a positive, -1 a negative one.
  void set_cut(int sign) { cut_ = sign; }
  /// Starts anew with an integral part of `output` (2^-16), as far as the gain I can hold one.
  void preset(std::int64_t output) {
    error_ = 0;
    cut_ = 0;
    sum_ = integral_ == 0 ? 0 : sum_for(output);
  }

  [[nodiscard]] std::int32_t error() const { return error_; }  ///< in its format
  [[nodiscard]] std::int64_t sum() const { return sum_; }      ///< in the error's format
  [[nodiscard]] int cut() const { return cut_; }

 private:
  static constexpr int kProportionalShift =
      kOutputBits - format.proportional_bits - format.error_bits;
  static constexpr int kIntegralShift = kOutputBits - format.integral_bits - format.error_bits;

  template <int left>
  static constexpr std::int64_t shifted(std::int64_t value) {
    if constexpr (left >= 0) {
      return value * (std::int64_t{1} << left);
    } else {
      return value >> -left;
    }
  }
  /// The sum whose integral part is `output`, rounded towards zero so that it stays within a limit.
  [[nodiscard]] std::int64_t sum_for(std::int64_t output) const {
    constexpr double kUnit =
        kIntegralShift >= 0
            ? 1.0 /
                  static_cast<double>(std::int64_t{1} << (kIntegralShift >= 0 ? kIntegralShift : 0))
            : static_cast<double>(std::int64_t{1} << (kIntegralShift < 0 ? -kIntegralShift : 0));
    return static_cast<std::int64_t>(static_cast<double>(output) * kUnit * inverse_integral_);
  }

  std::int64_t proportional_ = 0;
  std::int64_t integral_ = 0;
  std::int64_t sum_ = 0;
  double inverse_integral_ = 0.0;
  std::int32_t integral_mask_ = 0;
  std::int32_t error_ = 0;
  int cut_ = 0;  ///< sign of what the limit took from the latest output
};

/// 1/256 rpm in, mA out.
using VelocityPiController = PiController<PiFormat{.error_bits = 8}>;

}  // namespace stator::control
