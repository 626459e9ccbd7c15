#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/base/servo_signals.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/product/device/analog_noise.hpp"

namespace stator::devices::tmcc160 {

/// The inputs of the module: limit switches and enable (2702h, 60FDh), analog channels (270Eh).
/// They are levels at the pins, whatever 2005h makes of them.
class ModuleInputs {
 public:
  static constexpr std::size_t kAnalogInputs = 2;

  /// `sensing` is what the sensors tell; it must outlive the object.
  ModuleInputs(dictionary::Dictionary& dictionary, const base::ServoSensing& sensing);
  ModuleInputs(const ModuleInputs&) = delete;
  ModuleInputs& operator=(const ModuleInputs&) = delete;
  ~ModuleInputs() = default;

  /// Level of the enable input; without it the power stage is off.
  void set_enable(bool high) { enable_ = high; }
  [[nodiscard]] bool enable() const { return enable_; }
  /// Reading of analog input IN_0 or IN_1, counts of 12 bits.
  void set_analog(std::size_t input, std::uint16_t counts) { analog_.at(input) = counts; }
  /// Of both.
  [[nodiscard]] product::AnalogNoise& noise() { return noise_; }

 private:
  void show_digital(dictionary::Entry& entry);
  void show_limit_switches(dictionary::Entry& entry);
  void show_analog(dictionary::Entry& entry);
  [[nodiscard]] std::uint32_t limit_switches() const;

  const base::ServoSensing& sensing_;
  bool enable_ = true;
  std::array<std::uint16_t, kAnalogInputs> analog_{};
  product::AnalogNoise noise_{160};
};

}  // namespace stator::devices::tmcc160
