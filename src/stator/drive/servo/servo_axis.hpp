#pragma once

#include <cstdint>

#include "stator/base/servo_signals.hpp"
#include "stator/control/servo/servo_controller.hpp"
#include "stator/drive/axis/axis.hpp"
#include "stator/drive/servo/servo_flags.hpp"
#include "stator/drive/servo/servo_settings.hpp"

namespace stator::drive {

/// A CiA 402 axis with a three-phase servo motor, commutated by hall sensors or an encoder. See
/// Axis for the calls.
///
/// Positions are increments of the sensor that commutates: encoder counts, or 6 hall steps per
/// electrical turn. The ramp makes a set-point once per control period; in between step() runs the
/// controller alone. Which loop is closed: position in pp, hm and wherever the motor stands still
/// after them; velocity in pv and for every stop, whatever mode it ends; torque in cst. Outside the
/// position loop the demand position follows the shaft.
///
/// Settings that follow from others are made here: settings().units, position_end and
/// velocity_window come from servo_settings(), behaviour starts as kServoBehaviour.
class ServoAxis final : public Axis {
 public:
  /// Binds the axis to its objects. Throws std::logic_error if one is missing.
  ServoAxis(dictionary::Dictionary& dictionary, const AxisConfiguration& configuration,
            base::EventReporter reporter);

  /// To be brought up to date before apply() and tick(), with settings().
  [[nodiscard]] ServoSettings& servo_settings() { return servo_settings_; }
  [[nodiscard]] const ServoSettings& servo_settings() const { return servo_settings_; }

  /// One period of the current loop; `sensing` is what the sensors told at its end.
  base::ServoActuation step(const base::ServoSensing& sensing) {
    supply_voltage_ = sensing.supply_voltage;
    driver_temperature_ = sensing.driver_temperature;
    if (sensing.overcurrent[0] || sensing.overcurrent[1] || sensing.overcurrent[2] ||
        sensing.overcurrent_high_side) [[unlikely]] {
      switch_off_on_overcurrent(sensing);
    }
    base::ServoActuation actuation = controller_.step(set_point_, sensing);
    actuation.brake_released = power_.brake_released();
    if (switches_changed(sensing.left_switch, sensing.right_switch)) [[unlikely]] {
      follow_limit_switches(switch_levels(sensing));
    }
    if (homing()) [[unlikely]] {
      observe_homing(sensing);
    }
    return actuation;
  }
  /// Between two control periods, while switched off and with sensors that tell what they told in
  /// the latest step(): as good as `periods` calls of it.
  void rest(int periods, const base::ServoSensing& sensing) { controller_.rest(periods, sensing); }
  [[nodiscard]] bool switched_off() const {
    return set_point_.loop == control::ServoLoop::off && controller_.switched_off();
  }

  /// Names the present position (2050h:01); not while the motor is positioned or moves.
  void set_position(std::int64_t increments);
  /// Sensor counts minus position as homing left it; 0 before (2100h).
  [[nodiscard]] std::int64_t home_offset_display() const { return home_offset_display_; }
  /// Scaled increments per increment as homing methods -5 and -6 leave it, 1 otherwise; the device
  /// keeps and gives back what outlives a reset.
  [[nodiscard]] double position_scale() const { return motion_.position_scale(); }
  void set_position_scale(double scale) { motion_.set_position_scale(scale); }

  /// Conditions of the status flags (200Dh) as of the latest control period. The flag of I2t stays
  /// until clear_i2t_exceeded().
  [[nodiscard]] ServoFlags flags() const { return flags_; }
  [[nodiscard]] const control::ServoController& controller() const { return controller_; }
  void set_i2t_counter(std::uint32_t value) { controller_.set_i2t_counter(value); }
  void clear_i2t_exceeded() { controller_.clear_i2t_exceeded(); }
  /// What the controller works at since the latest control period.
  [[nodiscard]] const control::ServoSetPoint& set_point() const { return set_point_; }
  [[nodiscard]] double actual_velocity() const override;                           ///< pps
  [[nodiscard]] double supply_voltage() const { return supply_voltage_; }          ///< V
  [[nodiscard]] double driver_temperature() const { return driver_temperature_; }  ///< degree C

 private:
  void begin_period(base::SimTime now) override;
  void supervise_stage(base::SimTime now) override;
  void end_period() override;
  [[nodiscard]] StageStatus stage_status() const override;
  void fault_was_reset() override;
  [[nodiscard]] double torque_current() const override;
  [[nodiscard]] bool voltage_enabled() const override;
  [[nodiscard]] double shown_velocity() const override;

  void configure();
  void observe_homing(const base::ServoSensing& sensing);
  void switch_off_on_overcurrent(const base::ServoSensing& sensing);
  void update_conditions();
  void update_flags();
  [[nodiscard]] bool commutation_known() const;
  [[nodiscard]] bool at_target() const;

  ServoSettings servo_settings_;
  control::ServoController controller_;
  control::ServoSetPoint set_point_;
  ServoFlags flags_;
  AxisErrors stage_errors_;  ///< as the sensors tell them; shorts until the fault reset
  double supply_voltage_ = 24.0;
  double driver_temperature_ = 25.0;
  double filtered_current_ = 0.0;  ///< A
  std::uint32_t homings_ = 0;      ///< finished, as last seen
  std::uint32_t takeovers_ = 0;    ///< of stops, as last seen
  std::int64_t home_offset_display_ = 0;
};

}  // namespace stator::drive
