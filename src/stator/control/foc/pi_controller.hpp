#pragma once

#include <cstdint>

#include "stator/control/foc/fixed_point.hpp"

namespace stator::control::foc {

/// MODE_PID_TYPE.
enum class PiStructure : std::uint8_t { classic, advanced };

/// Parameters of a controller as its register holds them.
struct PiParameters {
  std::int32_t p = 0;      ///< s16, Q8.8 or Q4.12
  std::int32_t i = 0;      ///< s16, Q0.15
  std::int64_t limit = 0;  ///< of output and integral, >= 0, < 2^32
};

/// Bits of PiState::clipped, in the order of the status flags.
inline constexpr std::uint32_t kTargetClipped = 1;
inline constexpr std::uint32_t kRateClipped = 2;
inline constexpr std::uint32_t kSumClipped = 4;
inline constexpr std::uint32_t kOutputClipped = 8;

/// What a controller remembers.
struct PiState {
  std::int32_t error = 0;
  /// Classic: sum of errors times 10 ns. Advanced: integrator with all its bits behind the point.
  std::int64_t integral = 0;
  std::uint32_t clipped = 0;  ///< in the latest evaluation: kSumClipped, kOutputClipped
};

/// One PI controller in the chip's integers; `p_bits` stand behind the point of P (8 for flux,
/// torque and velocity, 12 for position). The error is a word of 32 bits.
///
///   classic:   out = P e + I (sum of e over time in us) / 256       (equation 4, L963-L969)
///   advanced:  out = P e + sum of P I e over the evaluations        (equation 6, L979-L991)
///
/// The integral is cut so that its part stays within the limit, then the sum is cut (L998); with
/// I = 0 the classic integral is held at 0. The integrator keeps its fraction: it loses
/// nothing however small the error, and a loop comes to rest without error. Against exact
/// arithmetic the output is at most 2 LSB too small (two roundings downwards), never too large.
template <int p_bits>
class PiController {
 public:
  void configure(PiStructure structure, const PiParameters& parameters) {
    if (structure != structure_) {
      state_.integral = 0;
    }
    structure_ = structure;
    p_ = parameters.p;
    i_ = parameters.i;
    limit_ = parameters.limit;
    if (structure == PiStructure::advanced) {
      integral_limit_ = limit_ << (p_bits + kIBits);
    } else {
      const std::int64_t i = i_ < 0 ? -i_ : i_;
      integral_limit_ = i == 0 ? 0 : limit_ * (kTicksPerUs << kClassicBits) / i;
    }
  }

  /// One evaluation with the error `error`; `ticks` of 10 ns have passed since the last.
  std::int32_t step(std::int32_t error, std::int64_t ticks) {
    state_.error = error;
    const std::int64_t proportional = std::int64_t{p_} * error;
    state_.clipped = 0;
    if (structure_ == PiStructure::advanced) [[likely]] {
      state_.integral = limited(state_.integral + proportional * i_, integral_limit_, kSumClipped);
    } else {
      state_.integral = limited(state_.integral + error * ticks, integral_limit_, kSumClipped);
    }
    const std::int64_t wanted = (proportional >> p_bits) + integral_part();
    return static_cast<std::int32_t>(limited(wanted, limit_, kOutputClipped));
  }

  /// Forgets error and integral.
  void reset() { state_ = {}; }

  /// The integral as the register PID_..._ERROR_SUM shows it: classic the sum of errors in us,
  /// advanced the integrator in the unit of the output; saturated to s32.
  [[nodiscard]] std::int32_t error_sum() const {
    return saturate_s32(structure_ == PiStructure::advanced ? integral_part()
                                                            : state_.integral / kTicksPerUs);
  }
  [[nodiscard]] const PiState& state() const { return state_; }

 private:
  static constexpr int kIBits = 15;
  static constexpr int kClassicBits = 15 + 8;  ///< of I, and the division by 256
  static constexpr std::int64_t kTicksPerUs = 100;

  /// value, cut to -limit..limit; if that takes anything, `flag` says so.
  std::int64_t limited(std::int64_t value, std::int64_t limit, std::uint32_t flag) {
    if (!within(value, limit)) [[unlikely]] {
      state_.clipped |= flag;
      return value < 0 ? -limit : limit;
    }
    return value;
  }
  [[nodiscard]] std::int64_t integral_part() const {
    if (structure_ == PiStructure::advanced) {
      return state_.integral >> (p_bits + kIBits);
    }
    return floor_division((state_.integral * i_) >> kClassicBits, kTicksPerUs);
  }

  PiStructure structure_ = PiStructure::classic;
  std::int32_t p_ = 0;
  std::int32_t i_ = 0;
  std::int64_t limit_ = 0;
  std::int64_t integral_limit_ = 0;
  PiState state_;
};

}  // namespace stator::control::foc
