#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "stator/base/random.hpp"

namespace stator::environment {

/// What holds during one episode of an axis.
struct Conditions {
  double inertia = 0.0;           ///< kg m^2 of the load
  double viscous_friction = 0.0;  ///< N m s/rad of motor and load
  double coulomb_friction = 0.0;  ///< N m of motor and load
  double resistance = 0.0;        ///< ohm of a phase
  double inductance = 0.0;        ///< H of a phase, along the magnets
  double flux_linkage = 0.0;      ///< V s
  double supply_voltage = 0.0;    ///< V of the source
  double load_torque = 0.0;       ///< N m on the shaft, positive = forward
  double load_torque_at = 0.0;    ///< s since the beginning at which it sets in
  double initial_position = 0.0;  ///< revolutions
  double initial_speed = 0.0;     ///< rad/s
  double target = 0.0;            ///< the first one: N m, rad/s or revolutions, as the task is
};

/// A member of Conditions, the name it has for users, and what may be given for it.
struct ConditionName {
  std::string_view name;
  double Conditions::*member;
  double minimum;
  double maximum;
};

inline constexpr std::array kConditionNames{
    ConditionName{"inertia", &Conditions::inertia, 0.0, 10.0},
    ConditionName{"viscous_friction", &Conditions::viscous_friction, 0.0, 10.0},
    ConditionName{"coulomb_friction", &Conditions::coulomb_friction, 0.0, 100.0},
    ConditionName{"resistance", &Conditions::resistance, 1e-3, 1e3},
    ConditionName{"inductance", &Conditions::inductance, 1e-6, 1.0},
    ConditionName{"flux_linkage", &Conditions::flux_linkage, 1e-5, 10.0},
    ConditionName{"supply_voltage", &Conditions::supply_voltage, 0.0, 100.0},
    ConditionName{"load_torque", &Conditions::load_torque, -100.0, 100.0},
    ConditionName{"load_torque_at", &Conditions::load_torque_at, 0.0, 1e6},
    ConditionName{"initial_position", &Conditions::initial_position, -1e6, 1e6},
    ConditionName{"initial_speed", &Conditions::initial_speed, -1e4, 1e4},
    ConditionName{"target", &Conditions::target, -1e6, 1e6},
};

inline constexpr std::size_t kConditions = kConditionNames.size();
inline constexpr std::size_t kTargetCondition = kConditions - 1;

/// Conditions that are told instead of drawn, in the order of kConditionNames.
using GivenConditions = std::array<std::optional<double>, kConditions>;

/// From `low` to `high`, drawn evenly.
struct Span {
  double low = 1.0;
  double high = 1.0;

  [[nodiscard]] double draw(base::Random& random) const {
    return low + (high - low) * random.uniform();
  }
};

/// What differs from one episode to the next. Shares are of the values of the axis, if nothing else
/// is said.
struct Randomisation {
  Span inertia{0.5, 2.0};           ///< of the load
  Span viscous_friction{0.5, 2.0};  ///< of motor and load
  Span coulomb_friction{0.5, 2.0};  ///< of motor and load
  Span resistance{0.9, 1.2};
  Span inductance{0.9, 1.1};
  Span flux_linkage{0.95, 1.05};
  Span supply_voltage{0.9, 1.1};
  Span load_torque{-0.2, 0.2};      ///< of the rated torque
  Span initial_position{0.0, 1.0};  ///< revolutions
  Span initial_speed{0.0, 0.0};     ///< of the rated speed

  /// Nothing differs, and there is no load torque.
  [[nodiscard]] static constexpr Randomisation none() {
    return {.inertia = {},
            .viscous_friction = {},
            .coulomb_friction = {},
            .resistance = {},
            .inductance = {},
            .flux_linkage = {},
            .supply_voltage = {},
            .load_torque = {0.0, 0.0},
            .initial_position = {0.0, 0.0},
            .initial_speed = {0.0, 0.0}};
  }
};

}  // namespace stator::environment
