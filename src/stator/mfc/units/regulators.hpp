#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::mfc {

/// Settings of one switching regulator in BUCK_CONV_CFG (TMC8461 datasheet L7967-L8091).
struct RegulatorSettings {
  std::uint16_t saw_kilohertz = 250;         ///< nominal: 250, 125, 500, 1000
  std::uint16_t oscillator_kilohertz = 240;  ///< as measured: 240, 130, 470, 890 (L10697-L10707)
  std::uint8_t amplification_code = 0;       ///< 0 to 3: 100, 150, 200, 50 %
  std::uint8_t damping_code = 0;             ///< likewise
  bool over_current_protection = true;
  bool enabled = true;
};

/// Per cent of an amplification or damping code.
[[nodiscard]] std::uint16_t regulator_percent(std::uint8_t code);

/// The two switching regulators as far as a board notices them (L307-L315, L10379-L10435): their
/// settings, voltages with soft start, and faults from outside.
class Regulators {
 public:
  static constexpr base::SimDuration kSoftStart{1'000'000};
  static constexpr std::int32_t kFixedOutput = 3300;      ///< mV
  static constexpr std::int32_t kLeastAdjustable = 1200;  ///< mV
  static constexpr std::int32_t kOverCurrent = 1200;      ///< mA at which a cycle ends (L10687)

  /// BUCK_CONV_CFG.
  void configure(base::SimTime time, std::uint16_t configuration);
  [[nodiscard]] std::uint16_t configuration() const { return configuration_; }
  [[nodiscard]] RegulatorSettings fixed() const;
  [[nodiscard]] RegulatorSettings adjustable() const;

  /// What the board's feedback divider and supply make of the adjustable regulator, mV.
  void set_adjustable_target(std::int32_t millivolts, std::int32_t supply_millivolts);
  /// mV at the output at `time`. A shorted or overheated regulator gives 0.
  [[nodiscard]] std::int32_t fixed_voltage(base::SimTime time) const;
  [[nodiscard]] std::int32_t adjustable_voltage(base::SimTime time) const;

  void set_fixed_short(bool shorted) { fixed_short_ = shorted; }
  void set_adjustable_short(bool shorted) { adjustable_short_ = shorted; }
  void set_adjustable_overheated(base::SimTime time, bool overheated);

  // Flags of HV_ANA_STATUS; without its over-current protection a regulator sees no short.
  [[nodiscard]] bool fixed_short_flag() const {
    return fixed_short_ && fixed().over_current_protection;
  }
  [[nodiscard]] bool adjustable_short_flag() const {
    return adjustable_short_ && adjustable().enabled && adjustable().over_current_protection;
  }
  [[nodiscard]] bool adjustable_overheated_flag() const { return overheated_; }

 private:
  std::uint16_t configuration_ = 0;
  bool fixed_short_ = false;
  bool adjustable_short_ = false;
  bool overheated_ = false;
  std::int32_t target_ = 0;
  base::SimTime adjustable_on_since_;
};

}  // namespace stator::mfc
