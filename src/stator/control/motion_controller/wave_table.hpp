#pragma once

#include <array>
#include <cstdint>

namespace stator::control::motion_controller {

/// The chip's microstep table: 8192 entries per electrical period, 2048 per full step (A26, A101),
/// and the pointer into it (AP 63). Phase A follows the cosine and phase B the sine, as in
/// MicrostepSequencer.
///
/// The table is computed when the resolution is written (AP 27), and takes the sine offset (AP 29)
/// as it stands then (A47): around its zero crossings the wave steps by the offset, in 1/1024 of
/// the amplitude, and its peak stays where it is.
class WaveTable {
 public:
  static constexpr int kSize = 8192;
  static constexpr int kFullStep = kSize / 4;
  static constexpr std::uint8_t kCoarsest = 11;  ///< highest index of AP 27: full steps

  /// AP 27, 0..11: 2048 / 2^index microsteps per full step. `sine_offset`: AP 29.
  void load(std::uint8_t resolution_index, std::uint8_t sine_offset);
  [[nodiscard]] std::uint8_t resolution_index() const { return resolution_; }

  /// Moves the pointer by microsteps.
  void advance(std::int64_t microsteps) { travel_ += microsteps << resolution_; }
  /// AP 63.
  [[nodiscard]] int position() const { return static_cast<int>(travel_ & (kSize - 1)); }
  void set_position(int entry);
  /// Entries passed since power-on, not wrapped; set_position() moves it within a period.
  [[nodiscard]] std::int64_t travel() const { return travel_; }

  /// Parts of full current, -1..1, in phases A and B at the pointer.
  [[nodiscard]] std::array<double, 2> phases() const;
  /// The wave at an entry, -1..1.
  [[nodiscard]] double wave(int entry) const;

 private:
  std::uint8_t resolution_ = 0;
  double offset_ = 0.0;  ///< part of the amplitude
  std::int64_t travel_ = 0;
};

/// On-pole full step positions (multiples of kFullStep) that a pointer meets on its way from one
/// travel to another: pulses of the FS output.
[[nodiscard]] std::int64_t full_steps_met(std::int64_t from, std::int64_t to);

}  // namespace stator::control::motion_controller
