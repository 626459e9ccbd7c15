#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/base/random.hpp"

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

inline std::uint16_t CurrentConverter::convert(const ConverterChannel& channel, double value,
                                               double temperature, base::Random& random) const {
  constexpr double kRounder = 0x1.8p52;
  constexpr double kSheetTemperature = 25.0;
  double counts =
      channel.gain * value + channel.offset + channel.drift * (temperature - kSheetTemperature);
  if (channel.noise > 0.0) {
    counts += channel.noise * random.bell();
  }
  const double whole = ((counts * inverse_step_ + kRounder) - kRounder) * step_;
  return static_cast<std::uint16_t>(std::clamp(whole, 0.0, 65'536.0 - step_));
}

inline ConverterSample CurrentConverter::sample(ConverterState& state,
                                                const std::array<double, 2>& current,
                                                double voltage, double temperature, double period,
                                                base::Random& random) const {
  ConverterSample result;
  const double back = parameters_.delay > 0.0 ? std::min(parameters_.delay / period, 1.0) : 0.0;
  for (std::size_t k = 0; k < current.size(); ++k) {
    const double delayed = current[k] + back * (state.earlier[k] - current[k]);
    result.currents[k] = convert(parameters_.currents[k], delayed, temperature, random);
    state.earlier[k] = current[k];
  }
  result.voltage = convert(parameters_.voltage, voltage, temperature, random);
  return result;
}

}  // namespace stator::plant
