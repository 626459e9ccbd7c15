#include "stator/control/stepper/microstep_sequencer.hpp"

#include "stator/base/trigonometry.hpp"

namespace stator::control {

namespace {

constexpr int kQuarter = MicrostepSequencer::kTableSize / 4;

/// sin(x), 0 <= x <= pi/2, as a constant expression; good to 1e-10, the table needs 1e-3.
constexpr double quarter_sine(double x) {
  double term = x;
  double sum = x;
  for (int n = 1; n <= 8; ++n) {
    term *= -x * x / static_cast<double>((2 * n) * (2 * n + 1));
    sum += term;
  }
  return sum;
}

/// Nearest whole number of a value that is not negative (std::lround is no constant expression).
constexpr std::int16_t rounded(double value) {
  const auto whole = static_cast<std::int16_t>(value);
  return static_cast<std::int16_t>(value - whole < 0.5 ? whole : whole + 1);
}

constexpr std::array<std::int16_t, kQuarter + 1> make_quarter_wave() {
  std::array<std::int16_t, kQuarter + 1> table{};
  for (int i = 0; i <= kQuarter; ++i) {
    const double angle = 0.5 * base::kPi * i / kQuarter;
    table[static_cast<std::size_t>(i)] =
        rounded(MicrostepSequencer::kAmplitude * quarter_sine(angle));
  }
  return table;
}

constexpr auto kQuarterWave = make_quarter_wave();
static_assert(kQuarterWave[0] == 0 && kQuarterWave[kQuarter] == MicrostepSequencer::kAmplitude);

/// The quarter wave unrolled over a period and a quarter, so that sine and cosine are one look-up
/// each.
constexpr std::array<std::int16_t, std::size_t{5} * kQuarter> make_wave() {
  std::array<std::int16_t, std::size_t{5} * kQuarter> table{};
  for (int i = 0; i < 5 * kQuarter; ++i) {
    const int within_half = i % (2 * kQuarter);
    const int within_quarter = within_half <= kQuarter ? within_half : 2 * kQuarter - within_half;
    const std::int16_t magnitude = kQuarterWave[static_cast<std::size_t>(within_quarter)];
    const bool positive = i % (4 * kQuarter) < 2 * kQuarter;
    table[static_cast<std::size_t>(i)] =
        static_cast<std::int16_t>(positive ? magnitude : -magnitude);
  }
  return table;
}

constexpr auto kWave = make_wave();

}  // namespace

int MicrostepSequencer::sine_entry(int index) {
  return kWave[static_cast<std::size_t>(index)];
}

std::array<double, 2> MicrostepSequencer::coil_currents(std::int64_t microsteps,
                                                        double amplitude) const {
  const auto index = static_cast<std::size_t>(table_index(microsteps));
  const double step = amplitude * (1.0 / kAmplitude);
  return {step * kWave[index + kQuarter], step * kWave[index]};
}

}  // namespace stator::control
