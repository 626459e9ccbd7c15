#pragma once

#include <cstdint>

#include "stator/control/motion_controller/motion_controller.hpp"

namespace stator::control::motion_controller {

/// AP 193.
enum class SearchMode : std::uint8_t {
  left_switch = 1,
  right_then_left_switch = 2,
  right_then_reference_switch = 3,  ///< in series with the left one: the first met from the right
};

/// Why a search ended without a reference.
enum class SearchFailure : std::uint8_t {
  none,
  deviation,  ///< the encoder's deviation stopped the motor
  undriven,   ///< the power stage went off, or was off
  no_speed,   ///< a speed of 0: no switch would ever be met
};

struct SearchSettings {
  SearchMode mode = SearchMode::left_switch;
  std::uint32_t search_speed = 0;  ///< AP 194, units of the chip; 0 = AP 4 (A50)
  std::uint32_t switch_speed = 0;  ///< AP 195, the same; 0 = a quarter of AP 4
};

/// The firmware's reference search (RFS) on a MotionController, in order of its states (A51). A
/// switch is searched by its active level, whether it may stop the motor or not (A43), and every
/// state that moves is followed by one that waits for the end of braking with AP 17. The reference
/// is the middle between where the left input is released on the way right and where it is met on
/// the way left; a switch that braking has passed is crossed again from the left. The values are
/// what RFS STATUS answers.
enum class SearchState : std::uint8_t {
  inactive = 0,
  to_right_switch = 1,
  braking_at_right_switch = 2,
  to_left_switch = 3,
  braking_at_left_switch = 4,
  leaving_left_switch = 5,
  braking_after_left_switch = 6,
  reentering_left_switch = 7,
  braking_at_reference = 8,
};

/// How a device uses it: start() and stop() at the command RFS, advance() once per control period
/// after the controller's, while active. Commands that move the motor meanwhile have no lasting
/// effect; a device stops the search first.
class ReferenceSearch {
 public:
  void start(MotionController& controller, const SearchSettings& settings);
  /// RFS STOP: brakes and leaves coordinates as they are.
  void stop(MotionController& controller);
  /// Ends a search under way, whose motor is not driven any more.
  void abandon(MotionController& controller);
  void advance(MotionController& controller);

  [[nodiscard]] bool active() const { return state_ != SearchState::inactive; }
  [[nodiscard]] SearchState state() const { return state_; }
  /// Of the latest search.
  [[nodiscard]] SearchFailure failure() const { return failure_; }
  /// AP 196, microsteps from the reference to where the right switch was met, after a search in
  /// mode 2 or 3; 0 before.
  [[nodiscard]] std::int32_t switch_distance() const { return switch_distance_; }

 private:
  void search_left(MotionController& controller);
  void enter(MotionController& controller, SearchState state, std::int32_t velocity);
  void next_at_rest(MotionController& controller);
  void finish(MotionController& controller);
  void end(MotionController& controller, SearchFailure failure = SearchFailure::none);

  SearchState state_ = SearchState::inactive;
  SearchFailure failure_ = SearchFailure::none;
  bool right_searched_ = false;
  bool left_seen_ = false;  ///< while leaving it
  std::int32_t search_speed_ = 0;
  std::int32_t switch_speed_ = 0;
  std::int64_t right_position_ = 0;
  std::int64_t released_at_ = 0;
  std::int64_t reentered_at_ = 0;
  std::int32_t switch_distance_ = 0;
};

}  // namespace stator::control::motion_controller
