#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "stator/devices/tmcm_3315/objects.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/product/device/analog_noise.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::devices::tmcm_3315 {

/// What the automatic brake control of each axis feeds (200Ch), 0..255; none: switched off.
using BrakeFeeds = std::array<std::optional<std::uint8_t>, kAxisCount>;

/// General-purpose inputs and outputs of the module: 2702h, 2703h, 270Eh, and the outputs that the
/// automatic brake control takes over.
///
/// The "four analog or digital inputs" (L1) are four pins that 270Eh and 2702h show in two ways
/// (H-14): INn is high while analog input n reads half of full scale or more.
///
/// The document does not say which output serves which brake: OUT0 to OUT2 serve axes 0 to 2, as
/// pulse-width modulation with 255 steps. A brake output is driven in every state of the network,
/// because the brake must stay open until a motor that lost its master has stopped; the others are
/// switched in Operational only (L299-L300).
class ModuleIo {
 public:
  static constexpr std::size_t kChannels = 4;

  explicit ModuleIo(dictionary::Dictionary& dictionary);
  ModuleIo(const ModuleIo&) = delete;
  ModuleIo& operator=(const ModuleIo&) = delete;
  ~ModuleIo() = default;

  /// The firmware starts anew: its outputs are off, the levels at its inputs stay.
  void restart();
  /// Brings 2702h and 270Eh up to date.
  void read_inputs();
  void switch_outputs(bool operational, const BrakeFeeds& brakes);

  /// IN0..IN3 in bits 16..19.
  [[nodiscard]] std::uint32_t input_bits() const;
  /// OUT0..OUT3 in bits 16..19, as 2703h has them; 1: there is some current.
  [[nodiscard]] std::uint32_t output_bits() const;
  /// Mean voltage at an output, 0 to 1.
  [[nodiscard]] double output_duty(std::size_t output) const { return channels_[output].duty(); }

  [[nodiscard]] bool level(std::size_t input) const { return channels_[input].level(); }
  [[nodiscard]] std::uint16_t counts(std::size_t input) const { return channels_[input].counts; }
  /// A digital signal at the pin: 0 or full scale.
  void set_level(std::size_t input, bool high) { channels_[input].set_level(high ? 1.0 : 0.0); }
  void set_counts(std::size_t input, std::uint16_t counts) { channels_[input].counts = counts; }

  /// "output0", "input0", "analog_input0" and so on.
  void append_signals(std::vector<product::Signal>& signals) const;
  /// "input0", "analog_input0" and so on.
  void append_inputs(std::vector<product::Input>& inputs);

 private:
  static constexpr std::uint16_t kFullScale = 65535;  ///< counts of an analog input
  static constexpr std::uint16_t kThreshold = 32768;  ///< from which on it is high

  /// The n-th of everything, so that signals and inputs can be bound to it.
  struct Channel {
    std::uint16_t counts = 0;  ///< what is at the input, as 270Eh has it
    bool switched_on = false;  ///< by 2703h
    std::uint8_t output = 0;   ///< 0..255

    [[nodiscard]] bool level() const { return counts >= kThreshold; }
    [[nodiscard]] double read_level() const { return level() ? 1.0 : 0.0; }
    [[nodiscard]] double read_counts() const { return counts; }
    [[nodiscard]] double duty() const { return output / 255.0; }
    void set_level(double value) { counts = value >= 0.5 ? kFullScale : std::uint16_t{0}; }
    void set_counts(double value) { counts = static_cast<std::uint16_t>(std::lround(value)); }
  };

  dictionary::Variable<std::uint32_t> digital_inputs_;                        // 2702h
  dictionary::Variable<std::uint32_t> physical_outputs_;                      // 2703h:01
  dictionary::Variable<std::uint32_t> output_mask_;                           // 2703h:02
  std::array<dictionary::Variable<std::uint32_t>, kChannels> analog_inputs_;  // 270Eh
  std::array<Channel, kChannels> channels_;
  product::AnalogNoise noise_{3315};
};

}  // namespace stator::devices::tmcm_3315
