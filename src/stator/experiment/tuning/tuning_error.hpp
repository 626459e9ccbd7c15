#pragma once

#include <cstdint>
#include <string>

#include "stator/experiment/experiment.hpp"

namespace stator::experiment::tuning {

/// Why an axis cannot be tuned.
enum class Obstacle : std::uint8_t {
  supply_too_low,      ///< the supply, or what it can drive through the winding
  current_range,       ///< the converters cannot measure the current asked for
  current_sensing,     ///< offsets or signs of the current channels make no sense
  no_motor,            ///< no current flows, whatever the voltage
  phase_open,          ///< one phase carries no current
  encoder_silent,      ///< the motor turns, the encoder does not count
  shaft_blocked,       ///< the shaft does not follow the field
  encoder_reversed,    ///< the encoder counts the other way than was claimed
  encoder_resolution,  ///< counts per revolution are not those claimed, or not known
  pole_pairs,          ///< the number of pole pairs is not the one claimed
  bandwidth,           ///< a bandwidth asked for that no gains give
  gain_range,          ///< a gain does not fit into its register
};

/// A step that could not be measured: which one, what was seen, what to change.
class TuningError : public ExperimentError {
 public:
  TuningError(Obstacle obstacle, const std::string& text)
      : ExperimentError(text), obstacle_(obstacle) {}
  [[nodiscard]] Obstacle obstacle() const { return obstacle_; }

 private:
  Obstacle obstacle_;
};

}  // namespace stator::experiment::tuning
