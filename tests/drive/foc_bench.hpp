#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "drive/object_bench.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/control/foc/foc_block.hpp"
#include "stator/drive/foc/foc_axis.hpp"
#include "stator/plant/axes/pwm_axis.hpp"

namespace stator::drive {

/// A motor of four pole pairs with an encoder of 4096 counts, 1000 counts per A and per V at the
/// converters, on a stiff 24 V supply. Friction lets it come to rest by itself.
[[nodiscard]] plant::PwmAxisParameters foc_plant();
/// The same without friction and without the errors of a bridge: what formulas describe.
[[nodiscard]] plant::PwmAxisParameters linear_foc_plant();

/// A CiA 402 axis on a FOC block with a motor behind it: PWM at 40 kHz, five periods for each of
/// the axis, the objects that a TMC8670 has. Torque 1000 is 1 A RMS.
class FocBench : public ObjectBench {
 public:
  static constexpr std::int64_t kTurn = 65536;                ///< position units
  static constexpr std::int64_t kPwmPeriod = 25'000;          ///< ns
  static constexpr double kPeakCurrent = 1.4142135623730951;  ///< A, torque 1000

  explicit FocBench(const plant::PwmAxisParameters& parameters = foc_plant());

  void step();
  void pass(base::SimDuration duration) override;
  /// 6060h, then 6, 7, 15.
  void enable(ModeCode mode);
  [[nodiscard]] double rpm() const;
  [[nodiscard]] double revolutions() const { return plant.revolutions(); }
  [[nodiscard]] std::int64_t position() const { return read(0x6064); }
  [[nodiscard]] std::int32_t get(const control::foc::Field& f) const { return block.get(f); }
  /// Electrical degrees by which PHI_E is ahead of the rotor.
  [[nodiscard]] double commutation_error() const;

  control::foc::FocBlock block;
  plant::PwmAxis plant;
  std::unique_ptr<FocAxis> axis;

  /// Pressed (low) at and beyond these revolutions, home between two of them.
  std::optional<double> left_switch;
  std::optional<double> right_switch;
  std::optional<std::array<double, 2>> home_switch;
  std::array<bool, 2> probe{};
  std::optional<std::uint8_t> halls;  ///< instead of what the sensors tell

 private:
  void obey() override { axis->apply(now); }
  void configure_block();
  [[nodiscard]] control::foc::Inputs inputs() const;
  std::int64_t periods_ = 0;
};

}  // namespace stator::drive
