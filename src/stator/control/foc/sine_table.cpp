#include "stator/control/foc/sine_table.hpp"

#include <array>
#include <cstddef>
#include <utility>

namespace stator::control::foc {
namespace {

constexpr double kTwoPi = 6.28318530717958647693;

/// Power series, exact to the last bits for |x| <= pi; evaluated by the compiler only.
consteval double series(double x, double first, int order) {
  double term = first;
  double sum = first;
  for (int n = order; n < 40; n += 2) {
    term *= -x * x / (static_cast<double>(n + 1) * static_cast<double>(n + 2));
    sum += term;
  }
  return sum;
}

/// The nearest integer.
consteval std::int32_t to_word(double value) {
  const double half = value < 0.0 ? -0.5 : 0.5;
  return static_cast<std::int32_t>(value + half);
}

consteval std::int32_t to_q30(double value) {
  return to_word(value * 1073741824.0);
}

consteval SineTables make_sine_tables() {
  SineTables result{};
  for (int k = 0; k < 256; ++k) {
    const double turn = (k < 128 ? k : k - 256) / 256.0 * kTwoPi;
    result.coarse[k] = {to_q30(series(turn, turn, 1)), to_q30(series(turn, 1.0, 0))};
    const double part = k / 65536.0 * kTwoPi;
    result.fine[k] = {to_q30(series(part, part, 1)), to_q30(series(part, 1.0, 0))};
  }
  return result;
}

constexpr int kSteps = 256;

/// Arc tangent of k/256 in 1/65536 of 1/65536 revolution, by Newton's method on the series above.
consteval std::array<std::int32_t, kSteps + 2> make_arc_table() {
  std::array<std::int32_t, kSteps + 2> result{};
  double angle = 0.0;
  for (std::size_t k = 0; k < result.size(); ++k) {
    const double slope = static_cast<double>(k) / kSteps;
    for (int n = 0; n < 4; ++n) {
      const double sine = series(angle, angle, 1);
      const double cosine = series(angle, 1.0, 0);
      angle -= (sine - slope * cosine) / (cosine + slope * sine);
    }
    result[k] = to_word(angle / kTwoPi * 4294967296.0);
  }
  return result;
}

constexpr auto kArcTangent = make_arc_table();

}  // namespace

constinit const SineTables kSineTables = make_sine_tables();

std::uint16_t arc_tangent(std::int32_t y, std::int32_t x) {
  const auto ax = static_cast<std::uint32_t>(x < 0 ? -x : x);
  const auto ay = static_cast<std::uint32_t>(y < 0 ? -y : y);
  const std::uint32_t longer = ax > ay ? ax : ay;
  if (longer == 0) {
    return 0;
  }
  const std::uint32_t shorter = ax > ay ? ay : ax;
  // 8 bits choose the step, 16 interpolate within it.
  const std::uint64_t ratio = (static_cast<std::uint64_t>(shorter) << 24U) / longer;
  const auto step = static_cast<std::size_t>(ratio >> 16U);
  const std::int64_t low = kArcTangent[step];
  const std::int64_t rise = kArcTangent[step + 1] - low;
  const std::int64_t octant = low + ((rise * static_cast<std::int64_t>(ratio & 0xFFFFU)) >> 16);
  constexpr std::int64_t kQuarter = std::int64_t{1} << 30;
  std::int64_t angle = ax > ay ? octant : kQuarter - octant;
  angle = x < 0 ? 2 * kQuarter - angle : angle;
  angle = y < 0 ? -angle : angle;
  return static_cast<std::uint16_t>((angle + 0x8000) >> 16);
}

}  // namespace stator::control::foc
