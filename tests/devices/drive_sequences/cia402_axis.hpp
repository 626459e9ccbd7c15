#pragma once

#include <cstdint>

#include "devices/drive_sequences/recording.hpp"
#include "stator/drive/axis/axis.hpp"

namespace stator::tests {

/// What a product chooses where CiA 402 leaves it a choice.
struct Cia402Choices {
  double counts = 1.0;                ///< increments of position objects per revolution
  bool halts_homing = true;           ///< otherwise bit 8 means nothing in homing mode
  bool halt_releases_torque = false;  ///< halt in torque modes takes the torque away
  double switch_deceleration = 0.0;   ///< rev/s² at a limit switch, 0: 6084h
  bool steps_to_rest = false;         ///< a profile with an end velocity ends in a step
};

/// Watches an axis from sample to sample.
class Cia402Observer {
 public:
  /// What the objects of `axis` command and show now. What is left of `sample` is the plant's.
  void observe(const drive::Axis& axis, const Cia402Choices& choices, Sample& sample);

 private:
  std::uint32_t homings_ = 0;
  drive::ModeCode mode_ = drive::ModeCode::none;
  bool powered_ = false;
  bool homed_ = false;  ///< it homed before the stop that is under way began, which keeps its ramp
};

/// Whether the controlword of now or an option code of 0 lets power go off.
[[nodiscard]] PowerOff power_off_by(const drive::Axis& axis);

}  // namespace stator::tests
