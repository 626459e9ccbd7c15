#pragma once

#include <cstdint>

#include "stator/base/axis_signals.hpp"

namespace stator::control::motion_controller {

/// The chip's incremental encoder interface: every count adds the encoder constant to the position
/// or takes it away; what is less than a microstep is kept, so nothing drifts. Binary mode:
/// constant and remainder in 1/65536 (A36); decimal mode: in 1/10000 (A35). The position wraps at
/// 32 bits.
///
/// Null events (AP 43). The null channel counts as active at its level (bit 2) while A and B have
/// the levels of bits 0 and 1, unless bit 3 ignores them. An event is its going active (bit 6),
/// inactive (bit 7), or with neither bit being active. Every event latches the position (A37) and
/// sets the status; with bit 8 it also clears the position. Bit 5 without bit 4 asks for this once:
/// it is cleared by the event, and later ones only latch until AP 43 is written again.
///
/// The N mark of an encoder is one count wide, A and B are high there. A mark passed between two
/// calls is found to the count, levels and edges outside of it are seen once per call: with the
/// level inverted (bit 2 = 0 and a positive pulse), the channel is active nearly everywhere.
class EncoderInterface {
 public:
  /// AP 42.
  void set_constant(std::uint32_t constant);
  /// AP 43.
  void set_mode(std::uint32_t mode);
  /// Takes in count and N channel.
  void sample(const base::AxisSensing& sensing);

  /// AP 41.
  [[nodiscard]] std::int32_t position() const { return static_cast<std::int32_t>(whole_); }
  void set_position(std::int32_t position);
  /// AP 45: at the latest null event, or where latch() was called.
  [[nodiscard]] std::int32_t latched() const { return latched_; }
  void latch() { latched_ = position(); }
  /// AP 44: a null event has been.
  [[nodiscard]] bool status() const { return status_; }
  /// The same, and clears it.
  bool read_status();
  /// AP 43 as it is now, that is without a bit 5 that has acted.
  [[nodiscard]] std::uint32_t mode() const { return mode_; }

 private:
  [[nodiscard]] bool has(std::uint32_t bits) const { return (mode_ & bits) != 0; }
  [[nodiscard]] bool levels_match(std::int64_t count) const;
  void look_at_null_channel(const base::AxisSensing& sensing);
  void note_where_it_stands(const base::AxisSensing& sensing);
  void null_event(std::int64_t count);
  void move(std::int64_t counts);

  void update_increment();

  std::uint32_t constant_ = 65'536;
  std::uint32_t mode_ = 0;
  bool cleared_once_ = false;
  std::int64_t base_ = 65'536;       ///< fractions of a microstep
  std::int64_t increment_ = 65'536;  ///< of a count, in fractions
  std::uint32_t whole_ = 0;
  std::int64_t remainder_ = 0;  ///< 0 <= remainder < base
  std::int32_t latched_ = 0;
  bool status_ = false;

  bool sampled_ = false;
  std::int64_t count_ = 0;
  std::uint32_t passages_ = 0;
  std::int64_t mark_ = 0;  ///< count of the N mark
  bool in_mark_ = false;
  bool active_ = false;  ///< outside of marks
};

}  // namespace stator::control::motion_controller
