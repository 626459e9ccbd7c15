#include "devices/drive_sequences/can_drives.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "devices/drive_sequences/cia402_axis.hpp"
#include "devices/drive_sequences/object_access.hpp"
#include "devices/drive_sequences/three_phase_sample.hpp"
#include "devices/tmcc160_module.hpp"
#include "devices/tmcm_142_module.hpp"
#include "stator/control/motion_controller/motion_controller_units.hpp"

namespace stator::tests {

namespace {

using namespace base::literals;

constexpr double kTurn = 2.0 * std::numbers::pi;

class Tmcc160Drive final : public DriveUnderTest {
 public:
  explicit Tmcc160Drive(bool encoder)
      : motor_(plant::ServoAxisParameters().motor), inertia_(motor_.rotor_inertia) {
    surround(*module_.device);
    module_.boot(true);
    // 7 finds the angle of the encoder with the Hall sensors.
    module_.write(0x2055, 0, encoder ? 7 : 6);
    traits_ = {.standstill = encoder ? 0.5 : 1.5,
               .settle = encoder ? 0.05 : 0.25,
               .reaction = encoder ? 0.03 : 0.1,
               .reversal = encoder ? 6e-3 : 0.03,  // Hall sensors see nothing within a step
               .lag = 0.25,                        // with the gains as delivered
               .bandwidth = 20.0,
               .inertia = inertia_,
               .integral_time = 0.5,
               .follows_within = encoder ? 0.02 : 0.1,
               .position_error = encoder ? 0.005 : 0.06,
               .velocity_error = encoder ? 1.0 : 2.0,
               .no_load_velocity = 3.5,
               .overvoltage = 28.5,
               .current_allowance = 2.0};
  }

  Sample sample() override {
    const plant::ServoAxis& plant = module_.device->world().plant();
    const drive::ServoAxis& axis = module_.device->axis();
    Sample sample = three_phase_sample(plant, module_.now, motor_, inertia_, surroundings(),
                                       axis.settings().reference.switches);
    sample.current_limit =
        1e-3 * static_cast<double>(module_.device->dictionary().find(0x2020, 1)->value());
    sample.torque_limit = sample.current_limit * motor_.torque_constant();
    observer_.observe(axis,
                      {.counts = static_cast<double>(axis.controller().increments_per_revolution()),
                       .halts_homing = false,
                       .halt_releases_torque = true},
                      sample);
    sample.shown_torque = 1e-3 * axis.controller().actual_current() * motor_.torque_constant();
    return sample;
  }
  double shaft_velocity() override {
    return module_.device->world().plant().observe().speed / kTurn;
  }
  double shaft_position() override {
    return module_.device->world().plant().observe().shaft_revolutions;
  }
  std::int64_t actual_position() override {
    return module_.device->axis().objects().position_actual.get();
  }

 private:
  void write(const DriveStep& step) override {
    if (module_.device->node().state() != canopen::NmtState::stopped) {
      write_object(*module_.device, step, module_.device->network_state(), module_.now);
    }
  }
  void go_to_network_state(int command) override { module_.nmt(static_cast<unsigned>(command)); }
  void pass_cycle(int /*times*/) override { module_.wait(1.0); }

  Tmcc160Module module_;
  plant::ThreePhaseMotorParameters motor_;
  double inertia_;
  Cia402Observer observer_;
};

class Tmcm142Drive final : public DriveUnderTest {
 public:
  Tmcm142Drive() {
    surround(*module_.device);
    module_.run(10_ms);
    module_.sap(devices::tmcm_142::AxisParameter::unit_conversion_mode, 1);
    traits_ = {.standstill = 0.002,
               .settle = 1e-4,
               .reaction = 0.002,
               .lag = 0.0,
               .bandwidth = 1000.0,
               .inertia = 2e-5,
               .velocity_error = 0.002,
               .current_allowance = 1.5,
               .has_statusword = false,
               .shaft_is_counter = true};
  }

  Sample sample() override {
    namespace mc = control::motion_controller;
    devices::tmcm_142::MotionAxis& axis = module_.device->module().axis();
    const auto& controller = axis.controller();
    const auto& settings = controller.settings();
    const double counts = 200.0 * (2048 >> controller.microstep_resolution());
    const auto velocity = [&](double units) { return units * mc::kVelocityUnit / counts; };
    const auto acceleration = [&](double units) { return units * mc::kAccelerationUnit / counts; };
    Sample sample{.time = module_.now,
                  .position = controller.position() / counts,
                  .velocity = velocity(controller.velocity()),
                  .inertia = traits_.inertia,
                  .torque_limit = 1e9,
                  .supply = axis.plant().sensing().supply_voltage,
                  .source = surroundings().source,
                  .jammed = surroundings().jammed};
    const std::array<double, 2>& coils = axis.plant().sensing().coil_current;
    sample.current = std::hypot(coils[0], coils[1]);
    sample.current_limit = 7.0;
    sample.power = !module_.device->module().shut_down() && !axis.stage().error();
    sample.power_off = PowerOff::switched_off;  // the stage is off for a pin or a fault only
    sample.searching = axis.search().active();
    sample.negative_switch = controller.left_switch() && !settings.switches.left_disabled;
    sample.positive_switch = controller.right_switch() && !settings.switches.right_disabled;
    sample.mode = controller.mode() == mc::Mode::velocity ? 3 : 1;
    sample.demand = sample.position;
    sample.demand_velocity = sample.velocity;
    sample.shown_position = controller.position() / counts;
    sample.shown_velocity = sample.velocity;
    sample.enabled = sample.power;
    if (controller.mode() == mc::Mode::velocity && controller.target_velocity() == 0) {
      sample.stop = {.cause = StopCause::command,
                     .deceleration = acceleration(
                         std::min(settings.ramp.deceleration, settings.ramp.stop_deceleration))};
    }
    sample.acceleration = acceleration(std::max(
        {settings.ramp.acceleration, settings.ramp.deceleration, settings.ramp.stop_deceleration}));
    sample.switch_deceleration = acceleration(settings.ramp.stop_deceleration);
    sample.limit_deceleration =
        acceleration(std::min(settings.ramp.stop_deceleration, settings.ramp.deceleration));
    if (settings.limits.left_enabled) {
      sample.lower_limit = settings.limits.left / counts;
    }
    if (settings.limits.right_enabled) {
      sample.upper_limit = settings.limits.right / counts;
    }
    // Hard stops are steps (AP 14, T-60), and so is what the pin or a fault ends.
    const bool at_limit = sample.shown_position >= sample.upper_limit - 0.01 ||
                          sample.shown_position <= sample.lower_limit + 0.01;
    const bool hard = (settings.switches.mode & mc::switch_mode::kSoftStop) == 0 &&
                      (controller.left_switch() || controller.right_switch() || at_limit);
    sample.reference_changed = hard || hard_ || !sample.power || !powered_ ||
                               module_.device->module().shut_down() || sample.searching ||
                               searched_ || position_named_;
    hard_ = hard;
    searched_ = sample.searching;
    powered_ = sample.power;
    position_named_ = false;
    sample.target = controller.target_position() / counts;
    sample.target_velocity = velocity(controller.target_velocity());
    return sample;
  }
  double shaft_velocity() override {
    return module_.device->module().axis().plant().observe().speed / kTurn;
  }
  double shaft_position() override {
    return module_.device->module().axis().plant().observe().shaft_revolutions;
  }
  std::int64_t actual_position() override {
    return module_.device->module().axis().controller().position();
  }

 private:
  void write(const DriveStep& /*step*/) override {}
  void go_to_network_state(int /*state*/) override {}
  void command(const DriveStep& step) override {
    if (step.command == tmcl::Command::set_axis_parameter && step.index == 1) {
      position_named_ = true;
    }
    module_.execute(step.command, step.index, 0, step.value);
  }
  void pass_cycle(int /*times*/) override { module_.run(1_ms); }

  Tmcm142Module module_;
  bool hard_ = false;
  bool searched_ = false;
  bool powered_ = true;
  bool position_named_ = false;
};

}  // namespace

std::unique_ptr<DriveUnderTest> make_tmcc160_drive(bool encoder) {
  return std::make_unique<Tmcc160Drive>(encoder);
}

std::unique_ptr<DriveUnderTest> make_tmcm_142_drive() {
  return std::make_unique<Tmcm142Drive>();
}

}  // namespace stator::tests
