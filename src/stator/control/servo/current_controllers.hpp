#pragma once

#include <algorithm>
#include <cstdint>

#include "stator/control/pair.hpp"
#include "stator/control/rounding.hpp"

namespace stator::control {

/// The PI controllers of flux (d) and torque (q) current with what bounds their voltages: mA in, mV
/// with 16 bits behind the binary point out. They are two PiController with the same gains, each
/// with the voltage limit, and limit_circle() behind them, stepped at once. All integers of that
/// format are less than 2^53, so floating-point numbers hold them exactly, and the results are the
/// same to the last bit.
///
/// Ranges: whole errors, |e| < 2^28; P and I 0..65535; limit 1 .. 2^46.
class CurrentControllers {
 public:
  /// What one of the two shows.
  struct Shown {
    std::int32_t error;
    std::int32_t sum;  ///< saturated
  };

  /// Takes gains; the sums stay.
  void configure(std::uint16_t proportional, std::uint16_t integral);
  /// Takes another I; the voltages that the sums stand for stay.
  void change_integral(std::uint16_t integral);

  /// One period with the errors of d and q; the vector of the voltages is not longer than `limit`,
  /// and d comes first.
  Pair step(Pair error, double limit) {
    error_ = error;
    const Mask added = cut() ? without_cut(error) : accumulates_;
    const Pair sum = sum_ + kept(error, added);
    const Pair integral = integral_ * sum;
    const Pair output = proportional_ * error + integral;
    // An integer is within the limit's whole part when its square is within the limit's. A vector
    // in the circle has its parts within the limit, too.
    const Pair integral_square = integral * integral;
    const Pair output_square = output * output;
    const double square = limit * limit;
    if (std::max(integral_square[0], integral_square[1]) > square ||
        output_square[1] > square - output_square[0]) [[unlikely]] {
      return step_at_limit(sum, limit);
    }
    sum_ = sum;
    cut_ = {};
    return output;
  }
  /// The limit cut one of the latest voltages.
  [[nodiscard]] bool cut() const { return cut_.d != 0 || cut_.q != 0; }

  void reset() {
    error_ = Pair{};
    sum_ = Pair{};
    cut_ = {};
  }
  [[nodiscard]] Shown flux() const { return shown(0); }
  [[nodiscard]] Shown torque() const { return shown(1); }

 private:
  using Mask = long long __attribute__((vector_size(16)));
  struct Signs {
    int d = 0;
    int q = 0;
  };

  static Pair kept(Pair value, Mask mask) {
    return reinterpret_cast<Pair>(reinterpret_cast<Mask>(value) & mask);
  }
  [[nodiscard]] Mask without_cut(Pair error) const;
  Pair step_at_limit(Pair sum, double limit);
  [[nodiscard]] Shown shown(int axis) const {
    return {static_cast<std::int32_t>(static_cast<std::int64_t>(error_[axis])),
            saturated(static_cast<std::int64_t>(sum_[axis]))};
  }

  Pair proportional_{};
  Pair integral_{};
  Mask accumulates_{};  ///< no bits without I
  Pair sum_{};
  Pair error_{};
  double inverse_integral_ = 0.0;
  Signs cut_;  ///< sign of what the limit took from the latest voltages
};

}  // namespace stator::control
