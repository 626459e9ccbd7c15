#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/control/foc/foc_block.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/product/catalogue/tuning.hpp"

namespace stator::devices::tmc8670 {

/// The FOC block with what a board puts around it: power stage, motor with load, converters,
/// encoders. Each converter is wired to both of its inputs, delta sigma and SPI, so that it does
/// not matter which of them the registers choose. Copy it to take a snapshot.
class ServoStage {
 public:
  explicit ServoStage(const plant::PwmAxisParameters& parameters);

  /// Length of the PWM period that the next step() lets pass.
  [[nodiscard]] base::SimDuration period() const {
    return base::SimDuration(block_.period() * kNanosecondsPerTick);
  }
  /// One PWM period: the block samples what the sensors tell as it begins.
  void step();

  /// The power stage enable of the drive.
  void set_enable(bool enable) { inputs_.enable = enable; }
  /// The brake's coil has power.
  void set_brake_released(bool released) { brake_released_ = released; }
  /// Levels of the inputs that no sensor of the plant drives: GPI, step and direction, PWM_IN.
  [[nodiscard]] control::foc::PinLevels& pins() { return inputs_; }

  /// What the block sampled last, or will sample if the plant is touched no more.
  [[nodiscard]] control::foc::Inputs inputs() const;

  [[nodiscard]] control::foc::FocBlock& block() { return block_; }
  [[nodiscard]] const control::foc::FocBlock& block() const { return block_; }
  [[nodiscard]] plant::PwmAxis& plant() { return plant_; }
  [[nodiscard]] const plant::PwmAxis& plant() const { return plant_; }
  /// The chip starts anew: registers as after power-on; the world goes on.
  void restart_block() { block_ = control::foc::FocBlock(); }

 private:
  static constexpr std::int64_t kNanosecondsPerTick = 10;

  /// Takes into `inputs` what the sensors tell; the pins they do not drive stay.
  void sample(control::foc::Inputs& inputs) const;

  control::foc::FocBlock block_;
  plant::PwmAxis plant_;
  control::foc::Inputs inputs_;
  bool brake_released_ = false;
};

/// A stage of its own as a tuning tool has it.
class TunableStage final : public product::TuningStage {
 public:
  explicit TunableStage(const plant::PwmAxisParameters& parameters) : stage_(parameters) {}

  [[nodiscard]] std::int32_t get(const control::foc::Field& field) const override {
    return stage_.block().get(field);
  }
  void set(const control::foc::Field& field, std::int64_t value) override {
    stage_.block().set(field, value);
  }
  void write(std::uint8_t address, std::uint32_t value) override {
    stage_.block().write(address, value);
  }
  void step() override { stage_.step(); }
  void set_enable(bool enable) override { stage_.set_enable(enable); }
  void set_brake_released(bool released) override { stage_.set_brake_released(released); }

  [[nodiscard]] ServoStage& stage() { return stage_; }

 private:
  ServoStage stage_;
};

}  // namespace stator::devices::tmc8670
