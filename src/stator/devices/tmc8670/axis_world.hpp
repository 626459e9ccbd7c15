#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stator/devices/tmc8670/junction.hpp"
#include "stator/devices/tmc8670/servo_stage.hpp"
#include "stator/plant/axes/axis_fault_inputs.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::devices::tmc8670 {

/// Motor, load and sensors that fit the defaults of the objects: four pole pairs, an encoder with
/// 65536 positions, reference switches that are open.
[[nodiscard]] plant::PwmAxisParameters default_axis();

/// What can be recorded of the world around the chip and what can be set in it.
class AxisWorld {
 public:
  /// `stage` outlives the world.
  explicit AxisWorld(ServoStage& stage)
      : stage_(stage),
        fault_inputs_(stage.plant(), {plant::AxisPart::limit_switches, plant::AxisPart::home_switch,
                                      plant::AxisPart::brake, plant::AxisPart::encoder,
                                      plant::AxisPart::second_encoder}) {}
  AxisWorld(const AxisWorld&) = delete;
  AxisWorld& operator=(const AxisWorld&) = delete;
  ~AxisWorld() = default;

  /// Appends "axis0.<name>" for everything worth recording of the world.
  void append_signals(std::vector<product::Signal>& signals) const;
  /// Appends "axis0.<name>" for what can be set around the axis.
  void append_inputs(std::vector<product::Input>& inputs);

  /// Levels of the touch probe inputs, which are virtual: the chip has no pins for them (F-80).
  [[nodiscard]] const std::array<bool, 2>& probes() const { return probes_; }
  /// Degree Celsius of the junction; without supply it has the temperature of the air.
  [[nodiscard]] double junction_temperature() const {
    return tmc8670::junction_temperature(ambient_temperature_,
                                         powered_ ? kStaticPower + kDynamicPower : 0.0, air_speed_);
  }
  void set_power(bool on) { powered_ = on; }

 private:
  using Faults = plant::PwmAxisFaults;

  [[nodiscard]] plant::PwmAxis& plant() { return stage_.plant(); }
  [[nodiscard]] const plant::PwmSensing& sensing() const { return stage_.plant().sensing(); }
  [[nodiscard]] plant::PwmAxisObservation observe() const { return stage_.plant().observe(); }

  void append_stage_signals(std::vector<product::Signal>& signals) const;
  void append_fault_inputs(std::vector<product::Input>& inputs);

  template <typename Change>
  void change_faults(Change change) {
    Faults faults = plant().faults();
    change(faults);
    plant().set_faults(faults);
  }
  template <std::size_t Terminal>
  void set_open(double level) {
    change_faults([=](Faults& f) { f.terminals.open[Terminal] = level >= 0.5; });
  }
  template <std::size_t Terminal>
  void set_short(double level) {
    change_faults([=](Faults& f) { f.terminals.grounded[Terminal] = level >= 0.5; });
  }
  template <std::size_t Sensor>
  void set_hall_fault(double kind) {
    change_faults([=](Faults& f) {
      f.halls[Sensor] = static_cast<plant::HallFault>(static_cast<int>(kind));
    });
  }
  template <std::size_t Encoder>
  void lose_counts(double counts) {
    plant().lose_encoder_counts(Encoder, static_cast<std::int64_t>(counts));
  }
  void set_high_side(double level) {
    change_faults([=](Faults& f) { f.high_side = level >= 0.5; });
  }
  void set_halls_swapped(double level) {
    change_faults([=](Faults& f) { f.halls_swapped = level >= 0.5; });
  }
  void set_converter_noise(double counts) {
    change_faults([=](Faults& f) { f.converter_noise = counts; });
  }
  void set_load_torque(double torque) { plant().set_external_torque(torque); }
  void set_supply_voltage(double voltage) { plant().set_supply_voltage(voltage); }
  void set_ambient_temperature(double celsius) {
    ambient_temperature_ = celsius;
    plant().set_ambient_temperature(celsius);
  }
  void set_air_speed(double metres_per_second) { air_speed_ = metres_per_second; }
  void press_left_switch(double pressed) { plant().press_left_switch(pressed >= 0.5); }
  void press_right_switch(double pressed) { plant().press_right_switch(pressed >= 0.5); }
  void press_home_switch(double pressed) { plant().press_home_switch(pressed >= 0.5); }
  template <std::size_t Probe>
  void set_probe(double level) {
    probes_[Probe] = level >= 0.5;
  }

  [[nodiscard]] double shaft_position() const { return observe().shaft_revolutions; }
  [[nodiscard]] double shaft_speed() const;
  [[nodiscard]] double torque() const { return observe().electromagnetic_torque; }
  [[nodiscard]] double load_torque() const { return observe().load_torque; }
  [[nodiscard]] double direct_current() const { return observe().direct_current; }
  [[nodiscard]] double quadrature_current() const { return observe().quadrature_current; }
  template <std::size_t Terminal>
  [[nodiscard]] double current() const {
    return observe().terminal_current[Terminal];
  }
  template <std::size_t Encoder>
  [[nodiscard]] double encoder() const {
    return static_cast<double>(sensing().encoders[Encoder].count);
  }
  [[nodiscard]] double halls() const { return sensing().halls; }
  [[nodiscard]] double supply_voltage() const { return observe().supply_voltage; }
  [[nodiscard]] double supply_power() const { return observe().supply_power; }
  [[nodiscard]] double winding_temperature() const { return observe().winding_temperature; }
  [[nodiscard]] double driver_temperature() const { return observe().driver_temperature; }
  template <std::size_t Bridge>
  [[nodiscard]] double duty() const {
    const control::foc::PwmPeriod& pwm = stage_.block().outputs().pwm;
    return static_cast<double>(pwm.on_time[Bridge]) / pwm.period;
  }
  [[nodiscard]] double enable_out() const { return stage_.block().outputs().enable ? 1.0 : 0.0; }
  [[nodiscard]] double brake_chopper() const {
    return stage_.block().outputs().brake_chopper ? 1.0 : 0.0;
  }
  [[nodiscard]] double status_out() const { return stage_.block().outputs().status ? 1.0 : 0.0; }

  ServoStage& stage_;
  plant::AxisFaultInputs<plant::PwmAxis> fault_inputs_;
  std::array<bool, 2> probes_{};
  bool powered_ = true;
  double air_speed_ = 0.0;  ///< m/s around the chip
  double ambient_temperature_ = stage_.plant().parameters().ambient_temperature;
};

}  // namespace stator::devices::tmc8670
