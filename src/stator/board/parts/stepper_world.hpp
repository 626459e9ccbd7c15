#pragma once

#include <string>
#include <vector>

#include "stator/base/axis_signals.hpp"
#include "stator/base/input.hpp"
#include "stator/base/signal.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/board/parts/plant_grid.hpp"
#include "stator/board/peripheral/declaration.hpp"
#include "stator/board/peripheral/settings.hpp"
#include "stator/board/peripheral/shaft.hpp"
#include "stator/plant/axes/stepper_axis.hpp"

namespace stator::board {

/// Parameters that every peripheral with a load on its motor's shaft has.
inline constexpr ParameterDeclaration kLoadInertia{
    "load_inertia", "kg m^2", 0.0, 1e3, 0.0, "on the shaft, beside the rotor's"};
inline constexpr ParameterDeclaration kLoadFriction{"load_friction",           "Nm", 0.0, 1e3, 0.0,
                                                    "dry friction of the load"};
inline constexpr ParameterDeclaration kLoadTorque{
    "load_torque", "Nm", -1e3, 1e3, 0.0, "constant, positive drives the shaft forward"};
inline constexpr ParameterDeclaration kMinimumStop{"end_stop_minimum",     "rev", -1e6, 1e6, -1e6,
                                                   "hard stop; -1e6: none"};
inline constexpr ParameterDeclaration kMaximumStop{"end_stop_maximum",    "rev", -1e6, 1e6, 1e6,
                                                   "hard stop; 1e6: none"};
inline constexpr ParameterDeclaration kMotorSupply{"supply_voltage", "V", 0.0, 100.0, 24.0,
                                                   "of the motor"};
inline constexpr ParameterDeclaration kStepperMotor{.name = "motor",
                                                    .unit = "",
                                                    .description = "name of a stepper motor",
                                                    .is_text = true,
                                                    .text = "QSH5718-55-30-098"};

/// The load as these parameters say.
[[nodiscard]] plant::MechanicalLoad load_of(const Settings& settings);

/// A stepper motor with supply and load behind a driver of a board. It computes each step of
/// 50 us ahead, with the currents wanted at its begin: what sits on the shaft knows the moments of
/// its edges before they come.
class StepperWorld {
 public:
  static constexpr base::SimDuration kPeriod{50'000};

  /// Throws std::invalid_argument for an unknown motor.
  explicit StepperWorld(const Settings& settings);

  /// Makes the step that begins at `now`, and before it those it has slept through: a shaft that
  /// has settled stays as it is. Returns false when nothing changed: it may sleep until something
  /// else is wanted of it.
  bool step(const base::AxisActuation& actuation, base::SimTime now);

  [[nodiscard]] const base::AxisSensing& sensing() const { return axis_.sensing(); }
  [[nodiscard]] Shaft& shaft() { return shaft_; }
  [[nodiscard]] const PlantGrid& grid() const { return grid_; }
  [[nodiscard]] const plant::StepperAxis& axis() const { return axis_; }

  void append_signals(std::vector<base::Signal>& signals) const;

  /// What people can set.
  void set_load_torque(double torque);
  void set_supply(double voltage);
  void set_faults(const plant::StepperAxisFaults& faults) { axis_.set_faults(faults); }

 private:
  [[nodiscard]] ShaftPosition position() const;
  [[nodiscard]] double revolutions() const { return axis_.observe().shaft_revolutions; }
  [[nodiscard]] double speed() const;
  [[nodiscard]] double load_angle() const;
  [[nodiscard]] double current_a() const { return axis_.sensing().coil_current[0]; }
  [[nodiscard]] double current_b() const { return axis_.sensing().coil_current[1]; }

  plant::StepperAxis axis_;
  PlantGrid grid_{kPeriod};
  Shaft shaft_;
  base::SimTime computed_to_;
  base::AxisActuation latest_;
};

}  // namespace stator::board
