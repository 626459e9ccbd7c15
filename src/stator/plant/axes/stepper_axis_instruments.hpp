#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "stator/base/input.hpp"
#include "stator/base/signal.hpp"
#include "stator/base/trigonometry.hpp"
#include "stator/plant/axes/axis_fault_inputs.hpp"
#include "stator/plant/axes/stepper_axis.hpp"

namespace stator::plant {

/// What can be measured at a stepper axis, and set around it while it runs, whatever drives it.
class StepperAxisInstruments {
 public:
  /// Of an axis that has `parts` beside its shaft. It and the instruments must outlive the signals
  /// and inputs.
  StepperAxisInstruments(StepperAxis& axis, std::initializer_list<AxisPart> parts)
      : axis_(axis), parts_(parts), fault_inputs_(axis, parts) {}

  void append_signals(std::vector<base::Signal>& signals, const std::string& prefix) const;
  void append_inputs(std::vector<base::Input>& inputs, const std::string& prefix);

 private:
  using Faults = StepperAxisFaults;

  [[nodiscard]] double shaft_position() const { return axis_.observe().shaft_revolutions; }
  [[nodiscard]] double shaft_speed() const { return axis_.observe().speed / base::kTwoPi; }
  template <std::size_t Phase>
  [[nodiscard]] double coil_current() const {
    return axis_.sensing().coil_current[Phase];
  }
  [[nodiscard]] double torque() const { return axis_.observe().electromagnetic_torque; }
  [[nodiscard]] double load_torque() const { return axis_.observe().load_torque; }
  [[nodiscard]] double load_angle() const { return axis_.observe().load_angle; }
  [[nodiscard]] double supply_voltage() const { return axis_.sensing().supply_voltage; }
  [[nodiscard]] double winding_temperature() const { return axis_.observe().winding_temperature; }
  [[nodiscard]] double driver_temperature() const { return axis_.sensing().driver_temperature; }

  void set_load_torque(double torque) { axis_.set_external_torque(torque); }
  void set_supply_voltage(double voltage) { axis_.set_supply_voltage(voltage); }
  void set_ambient_temperature(double celsius) { axis_.set_ambient_temperature(celsius); }
  void press_left_switch(double level) { axis_.press_left_switch(level >= 0.5); }
  void press_right_switch(double level) { axis_.press_right_switch(level >= 0.5); }
  void press_home_switch(double level) { axis_.press_home_switch(level >= 0.5); }
  void lose_counts(double counts) { axis_.lose_encoder_counts(static_cast<std::int64_t>(counts)); }
  template <std::array<bool, 2> Faults::*Fault, std::size_t Phase>
  void set_phase_fault(double level) {
    Faults faults = axis_.faults();
    (faults.*Fault)[Phase] = level >= 0.5;
    axis_.set_faults(faults);
  }
  void set_high_side_short(double level) {
    Faults faults = axis_.faults();
    faults.high_side = level >= 0.5;
    axis_.set_faults(faults);
  }

  [[nodiscard]] bool has(AxisPart part) const {
    return std::find(parts_.begin(), parts_.end(), part) != parts_.end();
  }

  StepperAxis& axis_;
  std::vector<AxisPart> parts_;
  AxisFaultInputs<StepperAxis> fault_inputs_;
};

}  // namespace stator::plant
