#pragma once

#include <cstdint>

namespace stator::control {

/// Registers of the load-adaptive current (CoolStep), as the TMCM-3315 has them in 2098h..209Ch.
struct CoolStepSettings {
  std::uint8_t minimum = 0;           ///< 0: half, 1: a quarter of the run current
  std::uint8_t down_step = 0;         ///< 32, 8, 2, 1 measurements per step down
  std::uint8_t up_step = 0;           ///< 1, 2, 4, 8 steps up per measurement
  std::uint8_t hysteresis = 0;        ///< width between the thresholds: (value + 1) * 32
  std::uint8_t hysteresis_start = 0;  ///< lower threshold: value * 32; 0 switches CoolStep off

  [[nodiscard]] constexpr int lower_threshold() const { return hysteresis_start * 32; }
  [[nodiscard]] constexpr int upper_threshold() const {
    return (hysteresis_start + hysteresis + 1) * 32;
  }
};

/// Takes current away while the load measurement is high and gives it back when it is low, in steps
/// of the 32 current scales.
class CoolStep {
 public:
  /// A load measurement is there. `run_current`: setting 0..255 of the run current.
  void measured(const CoolStepSettings& settings, std::uint8_t run_current, int stall_guard);
  /// Full run current at once.
  void reset() { *this = CoolStep(); }

  /// Current scales below the run current.
  [[nodiscard]] std::uint8_t reduction() const { return reduction_; }

 private:
  std::uint8_t reduction_ = 0;
  int high_measurements_ = 0;  ///< in a row, since the latest step down
};

}  // namespace stator::control
