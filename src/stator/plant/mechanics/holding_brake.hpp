#pragma once

#include <cstdint>
#include <optional>

#include "stator/base/sim_time.hpp"

namespace stator::plant {

/// Whether the armature of a holding brake lies on its disc. Without current the brake is closed.
struct HoldingBrakeState {
  bool open = false;
  base::SimDuration changing;  ///< how long its coil has been asking for the other position

  friend bool operator==(const HoldingBrakeState&, const HoldingBrakeState&) = default;
};

/// A holding brake as it is wired and as fast as it is; MechanicalLoad::brake_torque says whether
/// one is fitted and what it holds.
///
/// Catalogues give the two delays from switching the coil to the armature having moved; torque is
/// taken to change then, at once.
struct HoldingBrake {
  /// Output of the drive that feeds its coil; none: the one the drive has for this axis.
  std::optional<std::uint8_t> output{};
  /// Mean voltage at the coil, as a fraction of its supply, from which the coil pulls.
  double pull_in_duty = 0.5;
  /// A power-on brake: its coil closes it. Else a spring does, and the coil opens it.
  bool closed_by_current = false;
  base::SimDuration release_time{};  ///< from switching the coil to the shaft being free
  base::SimDuration apply_time{};    ///< from switching the coil to the shaft being held

  /// What a coil fed with `duty` (0 to 1) asks for.
  [[nodiscard]] constexpr bool releases(double duty) const {
    return (duty >= pull_in_duty) != closed_by_current;
  }

  /// Lets `duration` pass with the coil asking for `released`.
  constexpr void advance(HoldingBrakeState& state, bool released,
                         base::SimDuration duration) const {
    if (released == state.open) {
      state.changing = {};
    } else if (state.changing >= (released ? release_time : apply_time)) {
      state = {.open = released, .changing = {}};
    } else {
      state.changing += duration;
    }
  }
};

}  // namespace stator::plant
