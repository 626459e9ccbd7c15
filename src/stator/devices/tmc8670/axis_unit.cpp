#include "stator/devices/tmc8670/axis_unit.hpp"

#include "stator/devices/tmc8670/emergencies.hpp"

namespace stator::devices::tmc8670 {

namespace {

// Bits of 60FDh and 60FEh (CiA 402-2 §12.2; the general-purpose outputs are the maker's).
constexpr std::uint32_t kNegativeLimit = 1U << 0;
constexpr std::uint32_t kPositiveLimit = 1U << 1;
constexpr std::uint32_t kHome = 1U << 2;
constexpr unsigned kFirstProbeBit = 16;
constexpr std::uint32_t kSetBrake = 1U << 0;

}  // namespace

AxisUnit::AxisUnit(dictionary::Dictionary& dictionary, const plant::PwmAxisParameters& parameters,
                   base::EventReporter reporter)
    : dictionary_(dictionary),
      reporter_(reporter),
      stage_(parameters),
      world_(stage_),
      registers_(dictionary, stage_.block()),
      objects_(dictionary),
      demand_(dictionary.variable<std::int32_t>(0x6062)),
      velocity_demand_(dictionary.variable<std::int32_t>(0x606B)),
      torque_demand_(dictionary.variable<std::int16_t>(0x6074)),
      following_error_(dictionary.variable<std::int32_t>(0x60F4)),
      digital_inputs_(dictionary.variable<std::uint32_t>(0x60FD)),
      digital_outputs_(dictionary.variable<std::uint32_t>(0x60FE, 1)),
      output_mask_(dictionary.variable<std::uint32_t>(0x60FE, 2)) {
  restart();
}

void AxisUnit::restart() {
  stage_.restart_block();
  stage_.set_enable(false);
  stage_.set_brake_released(false);
  registers_.write_all();
  axis_.emplace(dictionary_,
                drive::AxisConfiguration{.reactions = drive::reactions_of(kEmergencies),
                                         .control_period = kControlPeriod},
                reporter_, stage_.block());
  objects_.configure(*axis_);
}

bool AxisUnit::apply(base::SimTime now) {
  if (!axis_->has_commands()) {
    return false;
  }
  objects_.configure(*axis_);
  axis_->apply(now);
  drive_pins();
  return true;
}

void AxisUnit::tick(base::SimTime now) {
  objects_.configure(*axis_);
  axis_->tick(now);
  drive_pins();
  show_pins();
}

void AxisUnit::step(base::SimTime now) {
  stage_.step();
  axis_->observe({.probe = world_.probes(), .now = now});
}

void AxisUnit::set_network_operational(bool operational, base::SimTime now) {
  objects_.configure(*axis_);
  if (operational) {
    axis_->conditions().network_operational = true;
  } else if (axis_->conditions().network_operational) {
    axis_->network_left_operational(now);
    drive_pins();
  }
}

// ENABLE_OUT follows the power stage enable of the drive (L448); as long as no master has the drive
// it is also set while the PWM is switched on over a UART (L286, F-86). Bit 0 of 60FEh, if its mask
// lets it, sets the brake whatever the drive wants.
void AxisUnit::drive_pins() {
  constexpr auto kCentred = static_cast<std::int32_t>(control::foc::Chopper::centred);
  const bool tried_by_uart = !axis_->conditions().network_operational &&
                             stage_.block().get(control::foc::field("PWM_CHOP")) == kCentred;
  stage_.set_enable(axis_->bridge_enabled() || tried_by_uart);
  const bool held = (digital_outputs_.get() & output_mask_.get() & kSetBrake) != 0;
  stage_.set_brake_released(axis_->brake_released() && !held);
}

void AxisUnit::show_pins() {
  const drive::SwitchStates pressed = axis_->switches();
  std::uint32_t bits = (pressed.negative_limit ? kNegativeLimit : 0U) |
                       (pressed.positive_limit ? kPositiveLimit : 0U) | (pressed.home ? kHome : 0U);
  for (unsigned probe = 0; probe < world_.probes().size(); ++probe) {
    bits |= world_.probes()[probe] ? 1U << (kFirstProbeBit + probe) : 0U;
  }
  digital_inputs_.set(bits);
}

double AxisUnit::position_actual() const {
  return static_cast<double>(axis_->actual_position());
}

double AxisUnit::torque_actual() const {
  return static_cast<double>(axis_->objects().torque_actual.get());
}

void AxisUnit::append_signals(std::vector<product::Signal>& signals) const {
  const auto add = [&](const char* name, const char* unit, base::SignalReader read) {
    signals.push_back({std::string("axis0.") + name, unit, read});
  };
  using Read = base::SignalReader;
  add("position_demand", "increment", Read::bind<&AxisUnit::position_demand>(*this));
  add("position_actual", "increment", Read::bind<&AxisUnit::position_actual>(*this));
  add("velocity_demand", "rpm", Read::bind<&AxisUnit::velocity_demand>(*this));
  add("velocity_actual", "rpm", Read::bind<&AxisUnit::velocity_actual>(*this));
  add("following_error", "increment", Read::bind<&AxisUnit::following_error>(*this));
  add("torque_demand", "per mille", Read::bind<&AxisUnit::torque_demand>(*this));
  add("torque_actual", "per mille", Read::bind<&AxisUnit::torque_actual>(*this));
  add("controlword", "", Read::bind<&AxisUnit::controlword>(*this));
  add("statusword", "", Read::bind<&AxisUnit::statusword>(*this));
  add("mode", "", Read::bind<&AxisUnit::mode>(*this));
  world_.append_signals(signals);
}

}  // namespace stator::devices::tmc8670
