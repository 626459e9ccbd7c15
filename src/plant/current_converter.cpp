#include "plant/current_converter.hpp"

#include <algorithm>

namespace stator::plant {

CurrentConverter::CurrentConverter(const ConverterParameters& parameters)
    : parameters_(parameters),
      step_(static_cast<double>(1U << static_cast<unsigned>(16 - parameters.bits))),
      inverse_step_(1.0 / step_) {}

std::uint16_t CurrentConverter::convert(const ConverterChannel& channel, double value,
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

ConverterSample CurrentConverter::sample(ConverterState& state,
                                         const std::array<double, 2>& current, double voltage,
                                         double temperature, double period,
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
