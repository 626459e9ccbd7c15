#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/random.hpp"

namespace stator::plant {

/// Shunt, amplifier and input of one channel of a converter.
struct ConverterChannel {
  double gain = 1000.0;      ///< counts per A (or V); negative for a reversed amplifier
  double offset = 32'768.0;  ///< counts at 0
  double noise = 0.0;        ///< counts, standard deviation of a sample
  double drift = 0.0;        ///< counts per K above 25 degree Celsius
};

/// A converter whose raw values are unsigned 16-bit numbers. With fewer effective bits the lower
/// ones stand at 0.
struct ConverterParameters {
  std::array<ConverterChannel, 2> currents;                 ///< of U or X, and of W or Y
  ConverterChannel voltage{.gain = 1000.0, .offset = 0.0};  ///< of the supply
  int bits = 16;                                            ///< 8..16
  /// s by which a filter of delta-sigma modulators delays its values, 0 .. a PWM period: that of a
  /// sinc3 filter with decimation M and the clock f is 1.5 (M - 1) / f.
  double delay = 0.0;
};

/// Raw values of one sample.
struct ConverterSample {
  std::array<std::uint16_t, 2> currents{};
  std::uint16_t voltage = 0;
};

/// What a converter keeps from one sample to the next.
struct ConverterState {
  std::array<double, 2> earlier{};  ///< A, a period before
};

/// raw = clip(round(gain x + offset + drift (T - 25) + noise), 0, 65535)
class CurrentConverter {
 public:
  explicit CurrentConverter(const ConverterParameters& parameters);

  /// Samples the currents (A) and the supply (V) at the end of a period of `period` s.
  ConverterSample sample(ConverterState& state, const std::array<double, 2>& current,
                         double voltage, double temperature, double period,
                         base::Random& random) const;

 private:
  [[nodiscard]] std::uint16_t convert(const ConverterChannel& channel, double value,
                                      double temperature, base::Random& random) const;

  ConverterParameters parameters_;
  double step_;  ///< counts between neighbouring values, a power of 2
  double inverse_step_;
};

}  // namespace stator::plant
