#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stator/base/servo_signals.hpp"
#include "stator/plant/axes/axis_fault_inputs.hpp"
#include "stator/plant/axes/servo_axis.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::devices::tmcc160 {

/// Motor, load and sensors as a TMCC160 leaves its box with: they fit the defaults of its objects.
[[nodiscard]] plant::ServoAxisParameters default_axis();

/// The world of the axis with what can be recorded of it and what can be set around it.
class AxisWorld {
 public:
  explicit AxisWorld(const plant::ServoAxisParameters& parameters)
      : plant_(parameters),
        fault_inputs_(plant_, {plant::AxisPart::limit_switches, plant::AxisPart::brake,
                               plant::AxisPart::encoder, plant::AxisPart::driver_thermometer}) {}
  AxisWorld(const AxisWorld&) = delete;
  AxisWorld& operator=(const AxisWorld&) = delete;
  ~AxisWorld() = default;

  [[nodiscard]] plant::ServoAxis& plant() { return plant_; }
  [[nodiscard]] const plant::ServoAxis& plant() const { return plant_; }
  [[nodiscard]] const base::ServoSensing& sensing() const { return plant_.sensing(); }

  /// Appends "axis0.<name>" for everything worth recording of the world.
  void append_signals(std::vector<product::Signal>& signals) const;
  /// Appends "axis0.<name>" for what can be set around the axis.
  void append_inputs(std::vector<product::Input>& inputs);

 private:
  using Faults = plant::ServoAxisFaults;

  template <bool Faults::*Fault>
  void set_fault(double level) {
    Faults faults = plant_.state().faults;
    faults.*Fault = level >= 0.5;
    plant_.set_faults(faults);
  }
  template <std::array<bool, 3> Faults::*Fault, std::size_t Phase>
  void set_phase_fault(double level) {
    Faults faults = plant_.state().faults;
    (faults.*Fault)[Phase] = level >= 0.5;
    plant_.set_faults(faults);
  }
  template <std::size_t Sensor>
  void set_hall_fault(double kind) {
    Faults faults = plant_.state().faults;
    faults.halls[Sensor] = static_cast<plant::HallFault>(static_cast<int>(kind));
    plant_.set_faults(faults);
  }
  void set_current_noise(double ampere) {
    Faults faults = plant_.state().faults;
    faults.current_noise = ampere;
    plant_.set_faults(faults);
  }
  void lose_counts(double counts) { plant_.lose_encoder_counts(static_cast<std::int64_t>(counts)); }
  void set_load_torque(double torque) { plant_.set_external_torque(torque); }
  void set_supply_voltage(double voltage);
  void set_ambient_temperature(double celsius) { plant_.set_ambient_temperature(celsius); }
  void press_left_switch(double pressed) { plant_.press_left_switch(pressed >= 0.5); }
  void press_right_switch(double pressed) { plant_.press_right_switch(pressed >= 0.5); }

  [[nodiscard]] double shaft_position() const { return plant_.observe().shaft_revolutions; }
  [[nodiscard]] double shaft_speed() const;
  [[nodiscard]] double phase_current_u() const { return sensing().phase_current[0]; }
  [[nodiscard]] double phase_current_v() const { return sensing().phase_current[1]; }
  [[nodiscard]] double phase_current_w() const { return sensing().phase_current[2]; }
  [[nodiscard]] double direct_current() const { return plant_.observe().direct_current; }
  [[nodiscard]] double quadrature_current() const { return plant_.observe().quadrature_current; }
  [[nodiscard]] double torque() const { return plant_.observe().electromagnetic_torque; }
  [[nodiscard]] double load_torque() const { return plant_.observe().load_torque; }
  [[nodiscard]] double encoder() const { return static_cast<double>(sensing().encoder_count); }
  [[nodiscard]] double halls() const { return sensing().halls; }
  [[nodiscard]] double supply_voltage() const { return sensing().supply_voltage; }
  [[nodiscard]] double supply_power() const { return plant_.observe().supply_power; }
  [[nodiscard]] double winding_temperature() const { return plant_.observe().winding_temperature; }
  [[nodiscard]] double driver_temperature() const { return sensing().driver_temperature; }

  plant::ServoAxis plant_;
  plant::AxisFaultInputs<plant::ServoAxis> fault_inputs_;
};

}  // namespace stator::devices::tmcc160
