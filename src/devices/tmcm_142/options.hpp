#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "plant/stepper_axis.hpp"

namespace stator::devices::tmcm_142 {

/// Choices the document leaves open; the defaults are those of
/// docs/devices/tmcm-142-decisions.md.
struct Options {
  bool writable_encoder_position = false;  ///< axis parameter 41 can be set (A34)
  bool eight_input_bits = false;           ///< reading all inputs leaves IN_8 out (A72)
  bool opto_bias = true;                   ///< pin 15 feeds the opto-couplers of IN_7 and IN_8
};

/// The switches on the add-on board (L200-L228). Their patterns are lost (A12), so they are named
/// by what they do.
struct DipSwitches {
  /// Switch 100: is added to the module address on RS-422 (global parameter 66) and to the CAN
  /// identifier (71), 0..15.
  std::uint8_t address = 0;
  /// Switches 101 and 102: the one interface that works, "can" or one of
  /// Tmcm142::kSerialInterfaces; nothing: all of them do.
  std::optional<std::string> interface {};
};

/// Motor, load and supply as a module has them unless told otherwise: 200 full steps per revolution
/// (L99-L103), 24 V, an encoder with 40,000 counts per revolution, no switches.
[[nodiscard]] plant::StepperAxisParameters default_axis();

}  // namespace stator::devices::tmcm_142
