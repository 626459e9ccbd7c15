#include "own_product/own_stepper.hpp"

#include "own_product/objects.hpp"
#include "stator/product/shell/coe_stack.hpp"

namespace own_product {

namespace {

using namespace stator;

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

product::EtherCatFirmwareParts parts(const OwnStepperConfiguration& configuration) {
  return {.description = describe(configuration),
          .stack = product::coe_stack_options(configuration.coe, configuration.quirks),
          .coe = configuration.coe,
          .quirks = configuration.quirks};
}

}  // namespace

OwnStepper::OwnStepper(const OwnStepperConfiguration& configuration, base::EventReporter reporter)
    : EtherCatFirmware(parts(configuration), add_objects, reporter),
      configuration_(configuration),
      error_report_(objects(), kErrors),
      plant_(configuration.axis),
      instruments_(plant_, {plant::AxisPart::limit_switches, plant::AxisPart::home_switch,
                            plant::AxisPart::brake, plant::AxisPart::encoder,
                            plant::AxisPart::driver_thermometer}) {
  restart_firmware(SimTime());
}

/// The firmware starts; motor and load go on.
void OwnStepper::restart(SimTime now) {
  error_report_.restart();
  axis_.emplace(objects(), drive::AxisConfiguration{.reactions = drive::reactions_of(kErrors)},
                reporter());
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
}

void OwnStepper::step_world(SimTime until) {
  for (; now_ + kPlantStep <= until; now_ += kPlantStep) {
    plant_.step(axis_->step(kPlantStep, plant_.sensing()), kPlantStep);
  }
}

/// One period of the firmware.
void OwnStepper::tick(SimTime now) {
  const drive::SwitchInputs& inputs = axis_->settings().reference.switches;
  axis_->conditions().set_switches(inputs.pressed(drive::switch_levels(plant_.sensing())));
  axis_->tick(now);
  report_errors(now);
}

/// A frame has passed: what it brought is obeyed at once, as by an interrupt.
void OwnStepper::apply(SimTime now) {
  axis_->apply(now);
  report_errors(now);
}

void OwnStepper::network_operational(bool operational, SimTime now) {
  if (operational) {
    axis_->conditions().network_operational = true;
  } else {
    axis_->network_left_operational(now);
  }
}

void OwnStepper::report_errors(SimTime now) {
  error_report_.update(*axis_, [&](const drive::AxisEmergency& row) {
    send_emergency(row.code, row.register_bits, {row.detail}, now);
  });
}

std::vector<product::Signal> OwnStepper::signals() const {
  std::vector<product::Signal> signals{
      {"axis0.position_actual", "microstep",
       base::SignalReader::bind<&OwnStepper::position_actual>(*this)}};
  instruments_.append_signals(signals, "axis0.");
  return signals;
}

std::vector<product::Input> OwnStepper::inputs() {
  std::vector<product::Input> inputs{clock_deviation_input()};
  instruments_.append_inputs(inputs, "axis0.");
  return inputs;
}

}  // namespace own_product
