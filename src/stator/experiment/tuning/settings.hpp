#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include "stator/control/foc/pwm_engine.hpp"

namespace stator::experiment::tuning {

/// What the maker of a board says of its converters. Signs are found by measurement.
struct Board {
  double counts_per_ampere = 1000.0;  ///< of the channels I0 and I1, > 0
  double counts_per_volt = 1000.0;    ///< of the supply, > 0
};

/// What a person knows of the axis and wants of it.
struct Settings {
  control::foc::MotorType motor = control::foc::MotorType::three_phase;
  Board board;
  double current = 3.0;             ///< A, amplitude: of the tests, and the limit of the drive
  std::int32_t pwm_maximum = 3999;  ///< PWM_MAXCNT; the gains hold for this frequency

  // Claims. What is stated and turns out otherwise is an error; what is not is measured.
  std::optional<std::int32_t> pole_pairs;
  std::optional<std::int32_t> encoder_resolution;  ///< counts per revolution
  std::optional<bool> encoder_reversed;

  // Wanted closed loops: Hz at which the actual value has fallen to 1/sqrt 2 of the target.
  std::optional<double> current_bandwidth;   ///< else a 25th of the PWM frequency
  std::optional<double> velocity_bandwidth;  ///< else a 20th of that
  std::optional<double> position_bandwidth;  ///< else a 5th of that

  double highest_speed = 0.0;  ///< rpm not to be exceeded in tests; 0: 45 % of the voltage

  /// Told as each step begins or ends.
  std::function<void(std::string_view)> report = [](std::string_view) {};
};

/// A value and the standard deviation it is known with, in the same unit.
struct Measured {
  double value = 0.0;
  double deviation = 0.0;
};

}  // namespace stator::experiment::tuning
