#pragma once

#include <cstdint>

#include "stator/drive/modes/homing_methods.hpp"
#include "stator/drive/modes/operating_mode.hpp"

namespace stator::drive {

/// Homing on hard stops, methods -1 to -6 (TMCC160 CANopen manual L2703-L2795). The velocity loop
/// drives the motor with 6099h:02 against the stop until its current reaches the threshold; current
/// that gains speed is no sign of a stop, so before the shaft has run at that speed with less, it
/// must stand. From there the motor goes back by the clearance with 6099h:01 and stands at 0, and
/// 607Dh ends there.
/// A method for both ends goes on to the other one, whose end of 607Dh becomes the position there;
/// one that scales lets the way between them be 65535 scaled increments. Switches and software
/// limits do not count.
class HardStopSearch {
 public:
  /// 65535 scaled increments: what the way between the ends becomes.
  static constexpr double kScaledRange = 65535.0;

  void begin(const HomingMethod& method);
  /// Once per control period; true when home is found and the limits are set.
  [[nodiscard]] bool advance(const ModeContext& context);

 private:
  enum class Stage : std::uint8_t { pushing, returning };

  void push(const ModeContext& context);
  [[nodiscard]] bool held_up(const ModeContext& context, double velocity);
  [[nodiscard]] bool is_on_goal(const ModeContext& context) const;
  [[nodiscard]] bool arrived(const ModeContext& context);
  void set_limit(const ModeContext& context, std::int64_t position) const;
  void scale(const ModeContext& context, std::int64_t end) const;

  const HomingMethod* method_ = nullptr;
  Stage stage_ = Stage::pushing;
  int direction_ = 0;  ///< towards the stop looked for, 1 or -1
  bool second_ = false;
  bool has_run_ = false;     ///< in this direction, with half the current of a stop
  bool is_stalled_ = false;  ///< with the current of a stop
  base::SimTime stalled_since_;
  std::int64_t goal_ = 0;
};

/// The shaft of a servo axis is on `goal`, as near as a position counts as reached, and not fast.
/// It need not stand: cogging and friction can make a shaft swing about its goal for ever. Always
/// true of a stepper, which has its counter only.
[[nodiscard]] bool shaft_is_at(const ModeContext& context, std::int64_t goal);

/// Speeds of homing, pps.
[[nodiscard]] double homing_fast_speed(const ModeContext& context);
[[nodiscard]] double homing_slow_speed(const ModeContext& context);

}  // namespace stator::drive
