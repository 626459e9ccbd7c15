// A stepper motor behind a driver with step and direction inputs.

#include <array>
#include <stdexcept>

#include "stator/board/parts/stepper_peripheral.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"
#include "stator/control/stepper/microstep_sequencer.hpp"

namespace stator::board {

namespace {

// Pins.
constexpr std::size_t kStep = 0;
constexpr std::size_t kDirection = 1;
constexpr std::size_t kEnable = 2;

constexpr double kFullSteps = 4.0;  // per electrical period

std::uint8_t resolution_of(std::int64_t microsteps) {
  for (std::uint8_t resolution = 0; resolution <= 8; ++resolution) {
    if (microsteps == std::int64_t{1} << resolution) {
      return resolution;
    }
  }
  throw std::invalid_argument("\"microsteps\" must be a power of two, 1 to 256");
}

/// Each rising edge of STEP moves the current vector by one microstep, against the usual direction
/// while DIR is high: the step generators of the chip set it for negative rates.
class StepDirMotor final : public StepperPeripheral {
 public:
  explicit StepDirMotor(const Settings& settings)
      : StepperPeripheral(settings),
        current_(settings.number("current") * 1.41421356237309504880),
        both_edges_(settings.flag("both_edges")),
        reversed_(settings.flag("reversed")),
        enable_active_high_(settings.flag("enable_active_high")) {
    sequencer_.set_resolution(resolution_of(settings.integer("microsteps")));
  }

  void line_changed(base::SimTime now, std::size_t pin, bool level) override {
    if (pin == kStep && (level || both_edges_)) {
      steps_ += this->level(kDirection) != reversed_ ? -1 : 1;
    } else if (pin != kEnable) {
      return;
    }
    wake(now);
  }

  std::vector<base::Signal> signals() const override {
    using Read = base::SignalReader;
    std::vector<base::Signal> result = StepperPeripheral::signals();
    result.push_back({"steps", "microstep", Read::bind<&StepDirMotor::steps>(*this)});
    result.push_back({"lost_steps", "full step", Read::bind<&StepDirMotor::lost_steps>(*this)});
    return result;
  }

  [[nodiscard]] bool needs_edges() const override { return both_edges_; }

 private:
  void make_steps(base::SimTime /*now*/, std::int64_t steps) override {
    steps_ += reversed_ ? -steps : steps;
  }
  [[nodiscard]] double steps() const { return static_cast<double>(steps_); }
  /// How far the shaft has fallen behind its steps: whole electrical periods, as a rotor locks in
  /// again only there.
  [[nodiscard]] double lost_steps() const {
    const auto microsteps = static_cast<double>(std::int64_t{1} << sequencer_.resolution());
    const double wanted = static_cast<double>(steps_) / microsteps / kFullSteps;
    const plant::StepperAxis& axis = world().axis();
    const double periods =
        wanted - plant::electrical_radians(axis.state().motor.angle) / base::kTwoPi;
    const auto whole = static_cast<std::int64_t>(periods + (periods < 0.0 ? -0.5 : 0.5));
    return kFullSteps * static_cast<double>(whole);
  }

  base::AxisActuation actuation(base::SimTime /*now*/) override {
    base::AxisActuation result;
    result.bridge_enabled = !wired(kEnable) || level(kEnable) == enable_active_high_;
    if (result.bridge_enabled) {
      result.coil_current_target = sequencer_.coil_currents(steps_, current_);
    }
    return result;
  }

  double current_;  ///< A, peak
  bool both_edges_;
  bool reversed_;
  bool enable_active_high_;
  control::MicrostepSequencer sequencer_;
  std::int64_t steps_ = 0;
};

constexpr std::array<PinDeclaration, 3> kPins{
    {{"step", PinUse::watches, false, "each rising edge is one microstep"},
     {"dir", PinUse::watches, false, "high: backward"},
     {"enable", PinUse::watches, true, "low: the coils have current; not wired: always"}}};

constexpr std::array<ParameterDeclaration, 12> kParameters{
    {kStepperMotor,
     {"microsteps", "", 1.0, 256.0, 256.0, "per full step, a power of two"},
     {"current", "A", 0.0, 20.0, 2.0, "rms per phase"},
     {"both_edges", "", 0.0, 1.0, 0.0, "1: falling edges of STEP step too"},
     {"reversed", "", 0.0, 1.0, 0.0, "1: high DIR is forward"},
     {"enable_active_high", "", 0.0, 1.0, 0.0, "1: current while ENABLE is high"},
     kMotorSupply,
     kLoadInertia,
     kLoadFriction,
     kLoadTorque,
     kMinimumStop,
     kMaximumStop}};

}  // namespace

constinit const PeripheralType kStepDirMotor{
    "step-dir-motor",
    "stepper motor behind a driver with step and direction inputs",
    kPins,
    kParameters,
    {},
    [](const Settings& settings) -> std::unique_ptr<Peripheral> {
      return std::make_unique<StepDirMotor>(settings);
    }};

}  // namespace stator::board
