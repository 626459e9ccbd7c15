// A DC motor behind an H-bridge and a three-phase motor behind three half bridges, driven by PWM.

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "stator/board/parts/numbered.hpp"
#include "stator/board/parts/plant_grid.hpp"
#include "stator/board/parts/stepper_world.hpp"
#include "stator/board/peripheral/peripheral.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"
#include "stator/plant/axes/axis_fault_inputs.hpp"
#include "stator/plant/axes/pwm_axis.hpp"

namespace stator::board {

namespace {

constexpr base::SimDuration kPeriod{50'000};

plant::PwmAxisParameters surroundings_of(const Settings& settings) {
  plant::PwmAxisParameters result;
  result.load = load_of(settings);
  result.supply_voltage = settings.number("supply_voltage");
  result.inverter.on_resistance = settings.number("on_resistance");
  result.encoders[0].counts_per_revolution = 0;
  return result;
}

plant::PwmAxisParameters dc_axis_of(const Settings& settings) {
  plant::PwmAxisParameters result = surroundings_of(settings);
  plant::DcMotorParameters motor;
  motor.resistance = settings.number("resistance");
  motor.inductance = settings.number("inductance") * 1e-3;
  motor.torque_constant = settings.number("torque_constant");
  motor.rotor_inertia = settings.number("rotor_inertia");
  result.motor = motor;
  return result;
}

plant::PwmAxisParameters three_phase_axis_of(const Settings& settings) {
  plant::PwmAxisParameters result = surroundings_of(settings);
  const auto motor = plant::find_three_phase_motor(settings.text("motor"));
  if (!motor) {
    std::string names;
    for (const plant::ThreePhaseMotorSheet& sheet : plant::three_phase_motor_sheets()) {
      names += (names.empty() ? "" : ", ") + std::string(sheet.name);
    }
    throw std::invalid_argument("there is no three-phase motor \"" + settings.text("motor") +
                                "\"; there are: " + names);
  }
  result.motor = *motor;
  return result;
}

/// `kBridges` half bridges with a motor. Pins 2 k and 2 k + 1 are the gates of half bridge k; a low
/// side that is not wired follows the high side, as in drivers with one input. The plant takes the
/// mean of each period: in the time in which neither transistor is on the current chooses its
/// diode.
template <std::size_t kBridges>
class BridgeMotor final : public Peripheral {
 public:
  explicit BridgeMotor(const plant::PwmAxisParameters& parameters) : axis_(parameters) {
    shaft_.place(position());
  }

  void begin(base::SimTime now) override { wake(now); }
  void mean_changed(base::SimTime now, std::size_t /*pin*/, double /*mean*/) override { wake(now); }

  void advance(base::SimTime now) override {
    const auto currents = axis_.currents();
    const double speed = axis_.speed();
    const double revolutions = axis_.revolutions();
    const double supply = axis_.supply_voltage();
    axis_.step(actuation(), kPeriod);
    const bool turned = axis_.revolutions() != revolutions;
    if (turned) {
      shaft_.move({now, kPeriod, shaft_.position(), position()});
    }
    // A plant that a step leaves as it is stays so: nothing but its inputs and its state moves it.
    awake_ = turned || axis_.currents() != currents || axis_.speed() != speed ||
             axis_.supply_voltage() != supply;
    if (awake_) {
      schedule(now + kPeriod);
    }
  }

  Shaft* shaft() override { return &shaft_; }

  std::vector<base::Signal> signals() const override {
    using Read = base::SignalReader;
    return {{"position", "rev", Read::bind<&BridgeMotor::revolutions>(*this)},
            {"speed", "1/min", Read::bind<&BridgeMotor::speed>(*this)},
            {"torque", "Nm", Read::bind<&BridgeMotor::torque>(*this)},
            {"current", "A", Read::bind<&BridgeMotor::current>(*this)}};
  }
  std::vector<base::Input> inputs() override {
    using Group = base::InputGroup;
    using Set = base::Delegate<void(double)>;
    std::vector<base::Input> result{
        {"load_torque", "Nm", -1e3, 1e3, Set::bind<&BridgeMotor::set_load_torque>(*this),
         Group::load},
        {"supply_voltage", "V", 0.0, 100.0, Set::bind<&BridgeMotor::set_supply>(*this),
         Group::supply, axis_.parameters().supply_voltage}};
    open_terminals_.append_inputs(result, {.name = "open_", .group = Group::driver});
    fault_inputs_.append(result, "");
    return result;
  }

  [[nodiscard]] const plant::PwmAxisFaults& faults() const { return axis_.faults(); }
  void set_faults(const plant::PwmAxisFaults& faults) {
    axis_.set_faults(faults);
    wake(now());
  }
  /// The cable of a terminal is broken, for open_terminals_.
  [[nodiscard]] double number_value(std::size_t terminal) const {
    return faults().terminals.open[terminal] ? 1.0 : 0.0;
  }
  void set_number(std::size_t terminal, double open) {
    plant::PwmAxisFaults changed = faults();
    changed.terminals.open[terminal] = open >= 0.5;
    set_faults(changed);
  }

 private:
  [[nodiscard]] double revolutions() const { return axis_.revolutions(); }
  [[nodiscard]] double speed() const { return axis_.speed() * (60.0 / base::kTwoPi); }
  [[nodiscard]] double torque() const { return axis_.electromagnetic_torque(); }
  [[nodiscard]] double current() const { return axis_.currents()[0]; }
  void set_load_torque(double torque) {
    axis_.set_external_torque(torque);
    wake(now());
  }
  void set_supply(double voltage) {
    axis_.set_supply_voltage(voltage);
    wake(now());
  }
  void wake(base::SimTime now) {
    if (!awake_) {
      awake_ = true;
      schedule(grid_.at_or_after(now));
    }
  }
  [[nodiscard]] ShaftPosition position() const {
    const double revolutions = axis_.revolutions();
    const double turns = std::floor(revolutions);
    return {static_cast<std::int64_t>(turns), revolutions - turns};
  }

  [[nodiscard]] plant::PwmActuation actuation() const {
    plant::PwmActuation result;
    const auto currents = axis_.currents();
    for (std::size_t k = 0; k < kBridges; ++k) {
      const double high = mean(2 * k);
      const double low = wired(2 * k + 1) ? mean(2 * k + 1) : 1.0 - high;
      const double open = std::fmax(0.0, 1.0 - high - low);
      // A current into the motor comes from ground, one out of it goes to the supply.
      result.duty[k] = high + (currents[k] < 0.0 ? open : 0.0);
      result.bridge_enabled = result.bridge_enabled || open < 1.0;
    }
    return result;
  }

  plant::PwmAxis axis_;
  Numbered<BridgeMotor> open_terminals_{*this, kBridges};
  plant::AxisFaultInputs<BridgeMotor> fault_inputs_{*this, {}};
  PlantGrid grid_{kPeriod};
  Shaft shaft_;
  bool awake_ = false;
};

constexpr ParameterDeclaration kOnResistance{
    "on_resistance", "ohm", 0.0, 100.0, 0.05, "of a transistor of the bridge"};

constexpr std::array<PinDeclaration, 4> kBridgePins{
    {{"a_high", PinUse::averages, false, "high: terminal A is at the supply"},
     {"a_low", PinUse::averages, true, "high: A is at ground; not wired: while a_high is low"},
     {"b_high", PinUse::averages, false, "the same of terminal B"},
     {"b_low", PinUse::averages, true, ""}}};
constexpr std::array<ParameterDeclaration, 11> kBridgeParameters{
    {{"resistance", "ohm", 0.01, 1e4, 0.6, "of the winding"},
     {"inductance", "mH", 0.01, 1e4, 0.2, "of the winding"},
     {"torque_constant", "Nm/A", 1e-5, 10.0, 0.035, ""},
     {"rotor_inertia", "kg m^2", 1e-9, 1.0, 7e-6, ""},
     kOnResistance,
     kMotorSupply,
     kLoadInertia,
     kLoadFriction,
     kLoadTorque,
     kMinimumStop,
     kMaximumStop}};

constexpr std::array<PinDeclaration, 6> kThreePhasePins{
    {{"u_high", PinUse::averages, false, "high: terminal U is at the supply"},
     {"u_low", PinUse::averages, true, "high: U is at ground; not wired: while u_high is low"},
     {"v_high", PinUse::averages, false, ""},
     {"v_low", PinUse::averages, true, ""},
     {"w_high", PinUse::averages, false, ""},
     {"w_low", PinUse::averages, true, ""}}};
constexpr std::array<ParameterDeclaration, 8> kThreePhaseParameters{
    {{.name = "motor",
      .unit = "",
      .description = "name of a three-phase motor",
      .is_text = true,
      .text = "QBL4208-61-04-013"},
     kOnResistance,
     kMotorSupply,
     kLoadInertia,
     kLoadFriction,
     kLoadTorque,
     kMinimumStop,
     kMaximumStop}};

}  // namespace

constinit const PeripheralType kBridgeMotor{
    "dc-motor",
    "brushed motor behind an H-bridge of two PWM channels",
    kBridgePins,
    kBridgeParameters,
    {},
    [](const Settings& settings) -> std::unique_ptr<Peripheral> {
      return std::make_unique<BridgeMotor<2>>(dc_axis_of(settings));
    }};

constinit const PeripheralType kThreePhaseMotor{
    "three-phase-motor",
    "three-phase motor behind the half bridges of three PWM channels",
    kThreePhasePins,
    kThreePhaseParameters,
    {},
    [](const Settings& settings) -> std::unique_ptr<Peripheral> {
      return std::make_unique<BridgeMotor<3>>(three_phase_axis_of(settings));
    }};

}  // namespace stator::board
