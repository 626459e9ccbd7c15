#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "stator/plant/axes/stepper_axis.hpp"

namespace stator::devices::tmcm_142 {

/// Rates of the CAN bus by global parameter 69, from 1 on; bit/s (L5965-L5972).
inline constexpr std::array<std::uint32_t, 8> kCanBitRates{10'000,  20'000,  50'000,  100'000,
                                                           125'000, 250'000, 500'000, 1'000'000};
/// Rates of the serial interfaces by global parameter 65, from 0 on; bit/s (L5943-L5954).
inline constexpr std::array<std::uint32_t, 12> kBaudRates{9600,    14'400,  19'200,  28'800,
                                                          38'400,  57'600,  76'800,  115'200,
                                                          230'400, 250'000, 500'000, 1'000'000};

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
