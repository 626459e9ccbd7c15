#pragma once

#include "stator/board/parts/stepper_world.hpp"
#include "stator/board/peripheral/peripheral.hpp"
#include "stator/plant/axes/axis_fault_inputs.hpp"

namespace stator::board {

/// What peripherals with a stepper motor share: its plant sleeps while nothing changes, and has
/// the signals and inputs of a motor.
class StepperPeripheral : public Peripheral, public StepFollower {
 public:
  explicit StepperPeripheral(const Settings& settings) : world_(settings) {}

  void begin(base::SimTime now) override { wake(now); }
  void advance(base::SimTime now) override;
  StepFollower* step_follower() override { return this; }
  void steps_come(base::SimTime now) override { wake(now); }
  Shaft* shaft() override { return &world_.shaft(); }
  std::vector<base::Signal> signals() const override;
  std::vector<base::Input> inputs() override;

  [[nodiscard]] const plant::StepperAxisFaults& faults() const { return world_.axis().faults(); }
  void set_faults(const plant::StepperAxisFaults& faults) {
    world_.set_faults(faults);
    wake(now());
  }

 protected:
  /// Steps that came by STEP and DIR without edges.
  virtual void make_steps(base::SimTime now, std::int64_t steps) = 0;
  /// What the driver wants of the coils from `now` on, for one period of the plant.
  [[nodiscard]] virtual base::AxisActuation actuation(base::SimTime now) = 0;
  /// Set-points, settings or inputs have changed.
  void wake(base::SimTime now) {
    if (!awake_) {
      awake_ = true;
      schedule(world_.grid().at_or_after(now));
    }
  }
  [[nodiscard]] StepperWorld& world() { return world_; }
  [[nodiscard]] const StepperWorld& world() const { return world_; }

 private:
  void set_load_torque(double torque) {
    world_.set_load_torque(torque);
    wake(now());
  }
  void set_supply(double voltage) {
    world_.set_supply(voltage);
    wake(now());
  }
  void open_a(double open) { set_open(0, open); }
  void open_b(double open) { set_open(1, open); }
  void short_a(double shorted) { set_short_of(0, shorted); }
  void short_b(double shorted) { set_short_of(1, shorted); }
  void set_open(std::size_t phase, double open) {
    plant::StepperAxisFaults changed = faults();
    changed.open[phase] = open >= 0.5;
    set_faults(changed);
  }
  void set_short_of(std::size_t phase, double shorted) {
    plant::StepperAxisFaults changed = faults();
    changed.shorted[phase] = shorted >= 0.5;
    set_faults(changed);
  }

  StepperWorld world_;
  plant::AxisFaultInputs<StepperPeripheral> fault_inputs_{*this,
                                                          {plant::AxisPart::driver_thermometer}};
  bool awake_ = false;
};

}  // namespace stator::board
