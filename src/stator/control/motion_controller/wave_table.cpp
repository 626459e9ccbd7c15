#include "stator/control/motion_controller/wave_table.hpp"

#include <algorithm>

#include "stator/base/trigonometry.hpp"

namespace stator::control::motion_controller {

namespace {

/// `value` / kFullStep towards minus infinity.
std::int64_t full_steps(std::int64_t value) {
  return value >> 11;
}

}  // namespace

void WaveTable::load(std::uint8_t resolution_index, std::uint8_t sine_offset) {
  resolution_ = std::min(resolution_index, kCoarsest);
  offset_ = sine_offset / 1024.0;
}

void WaveTable::set_position(int entry) {
  travel_ += (entry - travel_) & (kSize - 1);
}

double WaveTable::wave(int entry) const {
  const int within = entry & (kSize - 1);
  if ((within & (kSize / 2 - 1)) == 0) {
    return 0.0;
  }
  const double sine = base::sine_cosine(within * (base::kTwoPi / kSize)).sine;
  return sine * (1.0 - offset_) + (within < kSize / 2 ? offset_ : -offset_);
}

std::array<double, 2> WaveTable::phases() const {
  const int entry = position();
  return {wave(entry + kFullStep), wave(entry)};
}

std::int64_t full_steps_met(std::int64_t from, std::int64_t to) {
  return to >= from ? full_steps(to) - full_steps(from) : full_steps(from - 1) - full_steps(to - 1);
}

}  // namespace stator::control::motion_controller
