#include "own_product/own_stepper.hpp"

#include <utility>

#include "own_product/objects.hpp"
#include "stator/product/shell/coe_stack.hpp"

namespace own_product {

namespace {

using namespace stator;
using ethercat::AlState;

// The controller is the default of ethercat::SlaveControllerConfiguration, which has the registers
// of a TMC8461: 8 sync managers, process memory from 1000h on.
constexpr ethercat::MailboxArea kReceiveMailbox{0x1000, 256};
constexpr ethercat::MailboxArea kTransmitMailbox{0x1100, 256};
constexpr std::uint16_t kOutputs = 0x1200;
constexpr std::uint16_t kInputs = 0x1400;

// drive::StepperSettings has 256 microsteps per full step, of which a pair of poles makes four.
constexpr std::int64_t kMicrostepsPerPolePair = 4 * 256;
constexpr double kFullCurrent = 255.0;  ///< of control::CoilCurrentSettings

ethercat::DeviceDescription describe(const OwnStepperConfiguration& configuration) {
  ethercat::DeviceDescription description;
  description.vendor_id = kVendorId;
  description.vendor_name = "Example";
  description.product_code = kProductCode;
  description.revision = kRevision;
  description.order_code = "OWN-STEPPER";
  description.name = "Own stepper";
  description.group = "Drives";
  description.station_alias = configuration.coe.station_alias;
  description.receive_mailbox = kReceiveMailbox;
  description.transmit_mailbox = kTransmitMailbox;
  description.output_offset = kOutputs;
  description.input_offset = kInputs;
  description.coe = true;
  description.sdo_information = true;
  description.complete_access = true;
  return description;
}

}  // namespace

OwnStepper::OwnStepper(const OwnStepperConfiguration& configuration, base::EventReporter reporter)
    : configuration_(configuration),
      reporter_(reporter),
      description_(describe(configuration)),
      controller_(ethercat::SlaveControllerConfiguration{}),
      stack_(controller_, add_objects(dictionary_), description_, *this, reporter,
             product::coe_stack_options(configuration.coe, configuration.quirks)),
      error_report_(dictionary_, kErrors),
      plant_(configuration.axis),
      instruments_(plant_, {plant::AxisPart::limit_switches, plant::AxisPart::home_switch,
                            plant::AxisPart::brake, plant::AxisPart::encoder,
                            plant::AxisPart::driver_thermometer}) {
  controller_.set_event_reporter(reporter);
  controller_.load_sii(
      product::coe_sii_image(description_, dictionary_, configuration.coe, configuration.quirks));
  restart(SimTime());
}

/// The firmware starts; motor and load go on.
void OwnStepper::restart(SimTime now) {
  dictionary_.reset_values();
  error_report_.restart();
  outputs_came_ = false;
  axis_.emplace(dictionary_, drive::AxisConfiguration{.reactions = drive::reactions_of(kErrors)},
                reporter_);
  drive::StepperSettings& settings = axis_->stepper_settings();
  settings.microsteps_per_revolution =
      kMicrostepsPerPolePair * configuration_.axis.motor.pole_pairs;
  settings.full_scale_current = configuration_.run_current;
  settings.currents = {
      .run = static_cast<std::uint8_t>(kFullCurrent),
      .standby = static_cast<std::uint8_t>(kFullCurrent * configuration_.standby_current /
                                           configuration_.run_current),
      .standby_delay = base::SimDuration(100'000'000)};
  axis_->tick(now);
  stack_.reset(now);
}

void OwnStepper::advance(SimTime now) {
  while (now_ + kPlantStep <= now) {
    plant_.step(axis_->step(kPlantStep, plant_.sensing()), kPlantStep);
    now_ += kPlantStep;
    if (now_ >= next_tick_) {
      next_tick_ += kControlPeriod;
      if (powered_) {
        tick(now_);
      }
    }
  }
  controller_.advance(now);
}

/// One period of the firmware.
void OwnStepper::tick(SimTime now) {
  controller_.advance(now);
  stack_.process(now);
  const drive::SwitchInputs& inputs = axis_->settings().reference.switches;
  axis_->conditions().set_switches(inputs.pressed(drive::switch_levels(plant_.sensing())));
  axis_->tick(now);
  report_errors(now);
  outputs_came_ = false;
  stack_.publish_inputs(now);
}

/// A frame has passed: what it brought is obeyed at once, as by an interrupt.
void OwnStepper::handle_bus_events(SimTime now) {
  if (!powered_) {
    return;
  }
  if (controller_.take_reset_request()) {
    restart(now);
  }
  stack_.process(now);
  axis_->apply(now);
  report_errors(now);
  if (std::exchange(outputs_came_, false)) {
    stack_.publish_inputs(now);
  }
}

void OwnStepper::set_power(bool on, SimTime now) {
  powered_ = on;
  // Without power the axis is what it is before the firmware has started: switched off.
  restart(now);
  static_cast<void>(controller_.take_reset_request());
}

void OwnStepper::on_state(AlState from, AlState to, SimTime now) {
  if (to == AlState::operational) {
    axis_->conditions().network_operational = true;
  } else if (from == AlState::operational) {
    axis_->network_left_operational(now);
  }
}

void OwnStepper::report_errors(SimTime now) {
  error_report_.update(*axis_, [&](const drive::AxisEmergency& row) {
    stack_.send_emergency(row.code, error_report_.error_register(), {row.detail}, now);
  });
}

std::vector<product::Signal> OwnStepper::signals() {
  std::vector<product::Signal> signals{
      {"axis0.position_actual", "microstep",
       base::Delegate<double()>::bind<&OwnStepper::position_actual>(*this)}};
  instruments_.append_signals(signals, "axis0.");
  return signals;
}

std::vector<product::Input> OwnStepper::inputs() {
  std::vector<product::Input> inputs{clock_deviation_input()};
  instruments_.append_inputs(inputs, "axis0.");
  return inputs;
}

}  // namespace own_product
