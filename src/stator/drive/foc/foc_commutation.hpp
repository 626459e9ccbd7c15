#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/control/foc/foc_block.hpp"
#include "stator/drive/foc/foc_settings.hpp"

namespace stator::drive {

/// Finds the electrical zero of the encoder that a FOC block commutates with (reading A-60). While
/// it is active motion mode, targets and choice of angles are its own.
///
/// Halls: commutates by them, ready at once, until the block has given the encoder the angle of the
/// first border; impossible levels fail. Bang-bang: a current in D takes the rotor along from -180
/// to -90 degrees, so that it is not left where a field opposite to it would not move it, and pulls
/// it to 0, where the encoder's angle becomes 0; fails if the rotor does not stand in the end or
/// the encoder has not shown the quarter turn. Minimal movement: motion mode 9 of the block; fails
/// if the rotor moves too far.
class FocCommutation {
 public:
  explicit FocCommutation(control::foc::FocBlock& block) : block_(block) {}

  /// The bridge is on; `current` is CommutationSettings::current in steps of PID_FLUX_TARGET.
  void start(const CommutationSettings& settings, std::int32_t current, base::SimTime now);
  /// Once per control period while the bridge is on.
  void advance(base::SimTime now);
  /// The bridge goes off; what is not done is given up.
  void stop();
  /// What was found, or that nothing was, no longer counts.
  void forget();

  /// The angle may be used.
  [[nodiscard]] bool known() const {
    return state_ == State::handing_over || state_ == State::done;
  }
  [[nodiscard]] bool failed() const { return state_ == State::failed; }
  /// The levels of the halls are all equal, which no rotor makes.
  [[nodiscard]] static bool halls_impossible(const control::foc::FocBlock& block);
  /// Motion mode and targets of the block are the search's.
  [[nodiscard]] bool active() const {
    return state_ == State::first_angle || state_ == State::second_angle ||
           state_ == State::moving_minimally;
  }

 private:
  enum class State : std::uint8_t {
    unknown,
    handing_over,  ///< commutates by halls
    first_angle,   ///< bang-bang at -90 degrees
    second_angle,  ///< bang-bang at 0
    moving_minimally,
    done,
    failed,
  };

  void begin_by_halls();
  void begin_bang_bang();
  void begin_minimal_movement();
  void advance_bang_bang(base::SimTime now);
  void advance_minimal_movement();
  [[nodiscard]] std::int32_t encoder_angle() const;
  void shift_offset(const control::foc::Field& offset);
  void release();
  void fail();
  void finish();

  control::foc::FocBlock& block_;
  CommutationSettings settings_;
  State state_ = State::unknown;
  std::int32_t current_ = 0;              ///< PID_FLUX_TARGET
  std::int32_t external_direct_ = 0;      ///< UD_EXT as it was
  std::int32_t external_quadrature_ = 0;  ///< UQ_EXT
  base::SimTime since_;                   ///< of the state
  std::int32_t angle_ = 0;                ///< of the encoder, electrical, where it has to turn from
};

}  // namespace stator::drive
