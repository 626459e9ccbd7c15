#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/devices/tmc8670/axis_world.hpp"
#include "stator/devices/tmc8670/drive_objects.hpp"
#include "stator/devices/tmc8670/register_objects.hpp"
#include "stator/devices/tmc8670/servo_stage.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/foc/foc_axis.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::devices::tmc8670 {

/// The axis of the chip: FOC block with the world behind it, the firmware's drive above it, and the
/// objects of both.
class AxisUnit {
 public:
  /// Of the firmware loop.
  static constexpr base::SimDuration kControlPeriod{125'000};

  AxisUnit(dictionary::Dictionary& dictionary, const plant::PwmAxisParameters& parameters,
           base::EventReporter reporter);
  AxisUnit(const AxisUnit&) = delete;
  AxisUnit& operator=(const AxisUnit&) = delete;
  ~AxisUnit() = default;

  /// Firmware and FOC block start anew with the values of the objects; the world goes on.
  void restart();

  /// Obeys what was written since the last call; cheap when nothing was, which it returns as false.
  bool apply(base::SimTime now);
  /// One period of the firmware.
  void tick(base::SimTime now);
  /// Length of the PWM period that step() lets pass.
  [[nodiscard]] base::SimDuration pwm_period() const { return stage_.period(); }
  /// The PWM period that begins at `now`.
  void step(base::SimTime now);
  void set_network_operational(bool operational, base::SimTime now);
  /// See DriveObjects.
  void set_velocity_units(double units) { objects_.set_velocity_units(units); }
  /// Brings up to date what process data may carry.
  void refresh_objects() { registers_.refresh(); }

  [[nodiscard]] drive::FocAxis& axis() { return *axis_; }
  [[nodiscard]] const drive::FocAxis& axis() const { return *axis_; }
  [[nodiscard]] ServoStage& stage() { return stage_; }
  [[nodiscard]] const ServoStage& stage() const { return stage_; }
  [[nodiscard]] AxisWorld& world() { return world_; }

  /// Appends "axis0.<name>" for everything worth recording.
  void append_signals(std::vector<product::Signal>& signals) const;
  /// Appends "axis0.<name>" for what can be set around the axis.
  void append_inputs(std::vector<product::Input>& inputs) { world_.append_inputs(inputs); }

 private:
  void drive_pins();
  void show_pins();

  [[nodiscard]] double position_demand() const { return static_cast<double>(demand_.get()); }
  [[nodiscard]] double position_actual() const;
  [[nodiscard]] double velocity_demand() const { return velocity_demand_.get(); }
  [[nodiscard]] double velocity_actual() const { return axis_->objects().velocity_actual.get(); }
  [[nodiscard]] double following_error() const { return following_error_.get(); }
  [[nodiscard]] double torque_demand() const { return torque_demand_.get(); }
  [[nodiscard]] double torque_actual() const;
  [[nodiscard]] double controlword() const { return axis_->objects().controlword.get(); }
  [[nodiscard]] double statusword() const { return axis_->objects().statusword.get(); }
  [[nodiscard]] double mode() const { return static_cast<double>(axis_->mode()); }

  dictionary::Dictionary& dictionary_;
  base::EventReporter reporter_;
  ServoStage stage_;
  AxisWorld world_;
  RegisterObjects registers_;
  DriveObjects objects_;
  dictionary::Variable<std::int32_t> demand_;            // 6062h
  dictionary::Variable<std::int32_t> velocity_demand_;   // 606Bh
  dictionary::Variable<std::int16_t> torque_demand_;     // 6074h
  dictionary::Variable<std::int32_t> following_error_;   // 60F4h
  dictionary::Variable<std::uint32_t> digital_inputs_;   // 60FDh
  dictionary::Variable<std::uint32_t> digital_outputs_;  // 60FEh:01
  dictionary::Variable<std::uint32_t> output_mask_;      // 60FEh:02
  std::optional<drive::FocAxis> axis_;
};

}  // namespace stator::devices::tmc8670
