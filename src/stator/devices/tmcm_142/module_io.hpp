#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stator/product/device/analog_noise.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::devices::tmcm_142 {

/// The general-purpose inputs and outputs of connector 3 (L254-L300) and the shutdown pin.
///
/// IN_0 to IN_2 are voltages, read as levels and by the converter at the same time; IN_3 to IN_6
/// are TTL levels; IN_7 and IN_8 opto-couplers that are on while current flows, hence active low.
/// No input has a resistor: what is left open reads as 0 V and as no current here.
class ModuleIo {
 public:
  static constexpr std::size_t kInputs = 9;
  static constexpr std::size_t kAnalogInputs = 3;
  static constexpr std::size_t kHomeInput = 8;
  static constexpr std::size_t kFirstOptoInput = 7;
  static constexpr double kReferenceVoltage = 5.0;  ///< V, of the converter
  static constexpr int kConverterCounts = 1024;     ///< 10 bits (L3692-L3698)
  static constexpr double kTtlThreshold = 1.4;      ///< V
  static constexpr std::uint32_t kOutputs = 0x87;   ///< OUT_0 to OUT_2 and the internal line 7

  /// `opto_bias`: pin 15 is fed.
  explicit ModuleIo(bool opto_bias) : opto_bias_(opto_bias) {}
  ModuleIo(const ModuleIo&) = delete;
  ModuleIo& operator=(const ModuleIo&) = delete;
  ~ModuleIo() = default;

  /// The firmware starts anew: its outputs are off.
  void restart() { outputs_ = 0; }

  /// Bit n: IN_n is on. `home_contact`: a switch at IN_8 is closed.
  [[nodiscard]] std::uint32_t inputs(bool home_contact) const;
  /// 0..1023.
  [[nodiscard]] std::int32_t converter(std::size_t channel) const;
  [[nodiscard]] std::uint32_t outputs() const { return outputs_; }
  void set_outputs(std::uint32_t outputs) { outputs_ = outputs & kOutputs; }
  /// Level of the shutdown pin, which a resistor pulls down (A61).
  [[nodiscard]] bool shutdown_level() const { return shutdown_; }

  void append_signals(std::vector<product::Signal>& signals) const;
  void append_inputs(std::vector<product::Input>& inputs);

 private:
  template <std::size_t N>
  void set_voltage(double voltage) {
    voltages_[N] = voltage;
  }
  template <std::size_t N>
  void set_level(double level) {
    levels_[N] = level >= 0.5;
  }
  void set_shutdown(double level) { shutdown_ = level >= 0.5; }
  template <std::size_t N>
  [[nodiscard]] double output() const {
    return static_cast<double>(outputs_ >> N & 1U);
  }

  bool opto_bias_;
  std::array<double, kAnalogInputs> voltages_{};
  std::array<bool, kInputs> levels_{};  ///< of those that are no voltages
  std::uint32_t outputs_ = 0;
  bool shutdown_ = false;
  mutable product::AnalogNoise noise_{142};  ///< every reading is another one
};

}  // namespace stator::devices::tmcm_142
