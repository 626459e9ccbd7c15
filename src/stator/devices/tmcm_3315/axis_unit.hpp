#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stator/base/axis_signals.hpp"
#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/devices/tmcm_3315/closed_loop_objects.hpp"
#include "stator/devices/tmcm_3315/driver_objects.hpp"
#include "stator/devices/tmcm_3315/ramp_objects.hpp"
#include "stator/devices/tmcm_3315/reference_objects.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/stepper/stepper_axis.hpp"
#include "stator/plant/axes/axis_fault_inputs.hpp"
#include "stator/plant/axes/stepper_axis.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::devices::tmcm_3315 {

/// Handles to the manufacturer objects of one axis that have behaviour.
struct AxisManufacturerObjects {
  AxisManufacturerObjects(dictionary::Dictionary& dictionary, std::uint16_t index_offset,
                          std::uint16_t profile_index_offset);

  dictionary::Variable<std::uint8_t> microstep_resolution;          // 2000h
  dictionary::Variable<std::uint16_t> full_steps;                   // 2001h
  dictionary::Variable<std::uint16_t> brake_apply_delay;            // 2002h:01, ms
  dictionary::Variable<std::uint16_t> brake_release_delay;          // 2002h:02, ms
  dictionary::Variable<std::uint8_t> run_current;                   // 2003h
  dictionary::Variable<std::uint8_t> standby_current;               // 2004h
  dictionary::Variable<std::uint16_t> enable_delay;                 // 200Ah, ms
  dictionary::Variable<std::uint8_t> encoder_reversed;              // 200Bh:02
  dictionary::Variable<std::uint8_t> position_from_encoder;         // 200Bh:03
  dictionary::Variable<std::uint8_t> brake_apply_current;           // 200Ch:01
  dictionary::Variable<std::uint8_t> brake_release_current;         // 200Ch:02
  dictionary::Variable<std::uint8_t> boost_current;                 // 204Eh
  dictionary::Variable<std::uint16_t> standby_delay;                // 2089h, 10 ms
  dictionary::Variable<std::uint8_t> velocity_dimension;            // 208Ch
  dictionary::Variable<std::uint8_t> acceleration_dimension;        // 208Eh
  dictionary::Variable<std::uint8_t> chopper_off_time;              // 2097h
  dictionary::Variable<std::int32_t> home_offset_display;           // 2100h
  dictionary::Variable<std::uint8_t> microstep_resolution_display;  // 2107h
  dictionary::Variable<std::uint32_t> step_counter_low;             // 210Bh:01
  dictionary::Variable<std::uint32_t> step_counter_high;            // 210Bh:02
  dictionary::Variable<std::uint64_t> step_counter;                 // 210Bh:03
  dictionary::Variable<std::uint32_t> digital_inputs;               // 60FDh
};

/// The choices of Tmcm3315Configuration that concern an axis.
struct AxisUnitConfiguration {
  double full_scale_current = 3.0;  ///< A
  drive::DriverLimits driver_limits;
  bool home_offset_is_position = false;
};

/// One axis of the module: its firmware, its objects, and the motor wired to it.
class AxisUnit {
 public:
  AxisUnit(dictionary::Dictionary& dictionary, std::uint8_t number,
           const plant::StepperAxisParameters& plant, const AxisUnitConfiguration& configuration,
           base::EventReporter reporter);
  AxisUnit(const AxisUnit&) = delete;
  AxisUnit& operator=(const AxisUnit&) = delete;
  ~AxisUnit() = default;

  /// The firmware starts anew; the world goes on.
  void restart(base::SimTime now);

  /// Obeys what was written since the last call; cheap when nothing was, which it returns as false.
  bool apply(base::SimTime now);
  /// One control period of the firmware. `general_inputs`: bits 16..19 of 60FDh.
  void tick(base::SimTime now, std::uint32_t general_inputs);
  /// One step of driver and plant.
  void step(base::SimDuration duration) {
    base::AxisActuation actuation = axis_->step(duration, sensing_);
    actuation.brake_released = brake_coil_releases_;
    plant_.step(actuation, duration);
  }
  void set_network_operational(bool operational, base::SimTime now);

  /// What the automatic brake control (200Ch) feeds, 0..255; none: it is switched off.
  [[nodiscard]] std::optional<std::uint8_t> brake_feed() const;
  /// The duty (0 to 1) of the output that the holding brake is wired to.
  void set_brake_coil(double duty) {
    brake_coil_releases_ = plant_.parameters().brake.releases(duty);
  }

  [[nodiscard]] drive::StepperAxis& axis() { return *axis_; }
  [[nodiscard]] const drive::StepperAxis& axis() const { return *axis_; }
  [[nodiscard]] plant::StepperAxis& plant() { return plant_; }
  [[nodiscard]] const plant::StepperAxis& plant() const { return plant_; }

  /// Appends "axis<n>.<name>" for everything worth recording.
  void append_signals(std::vector<product::Signal>& signals) const;
  /// Appends "axis<n>.<name>" for what can be set around the axis.
  void append_inputs(std::vector<product::Input>& inputs);

 private:
  void configure();
  void mirror_objects(const dictionary::Entry& entry);
  void place_position(const dictionary::Entry& entry);
  void latch_step_counter(dictionary::Entry& entry);
  [[nodiscard]] dictionary::Verdict check_positioning_option(const dictionary::Entry& entry,
                                                             std::uint64_t bits);
  [[nodiscard]] std::int64_t microsteps_per_revolution() const;

  [[nodiscard]] double position_demand() const;
  [[nodiscard]] double position_actual() const;
  [[nodiscard]] double velocity_demand() const { return axis_->motion().velocity(); }
  [[nodiscard]] double velocity_actual() const { return axis_->actual_velocity(); }
  [[nodiscard]] double following_error() const;
  [[nodiscard]] double shaft_position() const { return plant_.observe().shaft_revolutions; }
  [[nodiscard]] double shaft_speed() const;
  [[nodiscard]] double coil_current_a() const { return sensing_.coil_current[0]; }
  [[nodiscard]] double coil_current_b() const { return sensing_.coil_current[1]; }
  [[nodiscard]] double closed_loop() const { return axis_->closed_loop().active() ? 1.0 : 0.0; }
  [[nodiscard]] double current_scale() const;
  [[nodiscard]] double torque() const { return plant_.observe().electromagnetic_torque; }
  [[nodiscard]] double load_torque() const { return plant_.observe().load_torque; }
  [[nodiscard]] double load_angle() const;
  [[nodiscard]] double encoder_count() const;
  [[nodiscard]] double brake_open() const;
  [[nodiscard]] double supply_voltage() const { return sensing_.supply_voltage; }
  [[nodiscard]] double controlword() const { return axis_->objects().controlword.get(); }
  [[nodiscard]] double statusword() const { return axis_->objects().statusword.get(); }
  [[nodiscard]] double mode() const { return static_cast<double>(axis_->mode()); }

  [[nodiscard]] double stall_guard() const { return axis_->driver().stall_guard(); }
  [[nodiscard]] double driver_flags() const { return driver_objects_.flags(); }
  [[nodiscard]] control::ChopperCycle chopper_cycle() const;
  [[nodiscard]] double chopper_frequency() const { return chopper_cycle().frequency; }
  [[nodiscard]] double current_ripple() const { return chopper_cycle().ripple; }
  [[nodiscard]] double winding_temperature() const {
    return plant_.state().motor_temperature.inner;
  }
  [[nodiscard]] double driver_temperature() const { return sensing_.driver_temperature; }

  template <bool plant::StepperAxisFaults::*Fault>
  void set_fault(double level) {
    plant::StepperAxisFaults faults = plant_.state().faults;
    faults.*Fault = level >= 0.5;
    plant_.set_faults(faults);
  }
  template <std::array<bool, 2> plant::StepperAxisFaults::*Fault, std::size_t Phase>
  void set_phase_fault(double level) {
    plant::StepperAxisFaults faults = plant_.state().faults;
    (faults.*Fault)[Phase] = level >= 0.5;
    plant_.set_faults(faults);
  }
  void lose_counts(double counts) { plant_.lose_encoder_counts(static_cast<std::int64_t>(counts)); }
  void set_ambient_temperature(double celsius) { plant_.set_ambient_temperature(celsius); }
  void set_load_torque(double torque) { plant_.set_external_torque(torque); }
  void set_supply_voltage(double voltage) { plant_.set_supply_voltage(voltage); }
  void press_left_switch(double pressed) { plant_.press_left_switch(pressed != 0.0); }
  void press_right_switch(double pressed) { plant_.press_right_switch(pressed != 0.0); }
  void press_home_switch(double pressed) { plant_.press_home_switch(pressed != 0.0); }

  dictionary::Dictionary& dictionary_;
  std::uint8_t number_;
  AxisUnitConfiguration configuration_;
  base::EventReporter reporter_;
  AxisManufacturerObjects objects_;
  ReferenceObjects reference_;
  ClosedLoopObjects closed_loop_objects_;
  DriverObjects driver_objects_;
  RampObjects ramp_objects_;
  plant::StepperAxis plant_;
  plant::AxisFaultInputs<plant::StepperAxis> fault_inputs_;
  const base::AxisSensing& sensing_;
  bool brake_coil_releases_ = false;  ///< set_brake_coil() says it with the first duty
  std::optional<drive::StepperAxis> axis_;
};

}  // namespace stator::devices::tmcm_3315
