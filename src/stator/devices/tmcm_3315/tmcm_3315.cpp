#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

#include <utility>

#include "stator/devices/tmcm_3315/controller.hpp"
#include "stator/product/shell/coe_stack.hpp"

namespace stator::devices {

namespace {

using ethercat::AlState;
using tmcm_3315::AxisUnit;

constexpr std::uint32_t kVendorId = 0x00000286;
constexpr std::uint8_t kWholeModule = 255;  // motor number of module-wide emergencies

// The document says nothing of the slave controller. Taken: 8 FMMUs, 8 sync managers and 16 KB of
// process memory as in the maker's own TMC8461; mailboxes of 512 bytes, which take the object list
// in two messages; 1 KB for each direction of process data, three buffers included.
constexpr std::uint16_t kProcessMemoryEnd = 0x5000;
constexpr ethercat::MailboxArea kReceiveMailbox{0x1000, 512};
constexpr ethercat::MailboxArea kTransmitMailbox{0x1200, 512};
constexpr std::uint16_t kOutputs = 0x1800;
constexpr std::uint16_t kInputs = 0x1C00;

/// Argument: {0} bytes.
constexpr base::EventRule kNewFirmware{
    "tmcm-3315-new-firmware", base::Severity::information,
    "restarting with a new firmware image, {0} bytes; the virtual module keeps the image and "
    "behaves as before, it does not run it"};
// Nor of SYNC0. Taken: wired to an interrupt of the firmware, which takes over outputs and gives
// inputs then; cycle times of up to a second; no supervision but of SYNC0 itself.
constexpr std::uint16_t kPdiControl = 0x0C05;  // SPI; SYNC and latch units switched on
constexpr std::uint8_t kSyncOutputs = 0x66;    // push-pull, active high, no AL events
constexpr std::uint16_t kSyncPulse = 1000;     // 10 us
constexpr base::SimDuration kShortestCycle{125'000};
constexpr base::SimDuration kLongestCycle{1'000'000'000};

ethercat::DeviceDescription describe(const Tmcm3315Configuration& configuration) {
  ethercat::DeviceDescription description;
  description.vendor_id = kVendorId;
  description.vendor_name = "TRINAMIC Motion Control GmbH & Co. KG";
  description.product_code = configuration.product_code;
  description.revision =
      configuration.revision.value_or(tmcm_3315::revision_of(configuration.firmware));
  description.serial_number = configuration.serial_number;
  description.order_code = "TMCM-3315";
  description.name = "TMCM-3315";
  description.group = "Drives";
  description.station_alias = configuration.coe.station_alias;
  description.receive_mailbox = kReceiveMailbox;
  description.transmit_mailbox = kTransmitMailbox;
  description.output_offset = kOutputs;
  description.input_offset = kInputs;
  description.bootstrap_receive_mailbox = kReceiveMailbox;
  description.bootstrap_transmit_mailbox = kTransmitMailbox;
  description.coe = true;
  description.foe = true;
  description.eoe = configuration.coe.ethernet_over_ethercat;
  description.sdo_information = true;
  description.complete_access = true;
  description.pdo_assign = true;
  description.pdo_configuration = true;
  description.distributed_clocks = true;
  description.pdi_control = kPdiControl;
  description.sync_latch_configuration = kSyncOutputs;
  description.sync_pulse_length = kSyncPulse;
  return description;
}

ethercat::SlaveStackOptions stack_options(const Tmcm3315Configuration& configuration) {
  ethercat::SlaveStackOptions options =
      product::coe_stack_options(configuration.coe, configuration.quirks);
  options.foe.bootstrap_only = true;
  options.process_memory_end = kProcessMemoryEnd;
  options.distributed_clocks.sync0 = true;
  options.distributed_clocks.shortest_cycle = kShortestCycle;
  options.distributed_clocks.longest_cycle = kLongestCycle;
  return options;
}

product::EtherCatFirmwareParts parts(const Tmcm3315Configuration& configuration) {
  return {.description = describe(configuration),
          .controller = tmcm_3315::kController.configuration,
          .stack = stack_options(configuration),
          .coe = configuration.coe,
          .quirks = configuration.quirks,
          .rules = {.sync0_until_stopped = true,
                    .refused_output_bytes = {0, kWholeModule},
                    .firmware_capacity = Tmcm3315::kFirmwareCapacity,
                    .new_firmware = &kNewFirmware}};
}

}  // namespace

Tmcm3315::Tmcm3315(const Tmcm3315Configuration& configuration, base::EventReporter reporter)
    : EtherCatFirmware(
          parts(configuration),
          [&](dictionary::Dictionary& objects) {
            tmcm_3315::add_objects(objects, configuration.firmware);
          },
          reporter),
      product_code_(configuration.product_code),
      io_(objects()),
      usb_(objects(), io_, configuration.firmware, kFirmwareCapacity, reporter) {
  set_boot_loader(usb_);
  for (std::uint8_t n = 0; n < tmcm_3315::kAxisCount; ++n) {
    axes_[n] = std::make_unique<AxisUnit>(
        objects(), n, configuration.axes[n],
        tmcm_3315::AxisUnitConfiguration{configuration.full_scale_current,
                                         configuration.driver_limits,
                                         configuration.home_offset_is_position},
        reporter);
  }
  using Query = dictionary::Dictionary::DriveStateQuery;
  objects().set_drive_state_query(Query::bind<&Tmcm3315::drive_state>(*this));
  set_identity();
  feed_brakes();
}

void Tmcm3315::set_identity() {
  objects().find(0x1018, 2)->set_value(product_code_);
  objects().find(0x1018, 3)->set_value(description().revision);
}

base::StaticText Tmcm3315::drive_state(std::uint8_t axis) {
  const drive::PowerState state = axes_[axis]->axis().power_state();
  return state == drive::PowerState::switch_on_disabled ? base::StaticText()
                                                        : drive::to_text(state);
}

void Tmcm3315::step_world(base::SimTime until) {
  while (now_ + kPlantStep <= until) {
    for (const auto& axis : axes_) {
      axis->step(kPlantStep);
    }
    now_ += kPlantStep;
  }
}

void Tmcm3315::tick(base::SimTime now) {
  io_.read_inputs();
  for (const auto& axis : axes_) {
    axis->axis().conditions().shutdown_switch = shutdown_switch_;
    axis->tick(now, io_.input_bits());
  }
  switch_outputs();
  usb_.serve(now);
  report_errors(now);
}

void Tmcm3315::at_sync0(base::SimTime now) {
  apply(now);
  switch_outputs();
}

bool Tmcm3315::connect_serial(std::string_view interface, tmcl::SerialPort* port) {
  if (interface != kSerialInterfaces[0]) {
    return false;
  }
  usb_.connect(port);
  return true;
}

void Tmcm3315::restart(base::SimTime now) {
  set_identity();
  io_.restart();
  reported_errors_ = {};
  reported_resets_ = {};
  for (const auto& axis : axes_) {
    axis->restart(now);
  }
  feed_brakes();
}

void Tmcm3315::apply(base::SimTime now) {
  bool obeyed = false;
  for (const auto& axis : axes_) {
    obeyed |= axis->apply(now);
  }
  if (obeyed) {
    switch_outputs();
  }
  report_errors(now);
}

void Tmcm3315::network_operational(bool operational, base::SimTime now) {
  for (const auto& axis : axes_) {
    axis->set_network_operational(operational, now);
  }
  switch_outputs();
}

void Tmcm3315::switch_outputs() {
  tmcm_3315::BrakeFeeds brakes;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    brakes[i] = axes_[i]->brake_feed();
  }
  io_.switch_outputs(stack().state() == AlState::operational, brakes);
  feed_brakes();
}

void Tmcm3315::feed_brakes() {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const std::size_t output = axes_[i]->plant().parameters().brake.output.value_or(i);
    axes_[i]->set_brake_coil(io_.output_duty(output));
  }
}

void Tmcm3315::report_errors(base::SimTime now) {
  for (std::uint8_t motor = 0; motor < tmcm_3315::kAxisCount; ++motor) {
    const drive::StepperAxis& axis = axes_[motor]->axis();
    if (axis.fault_resets() == reported_resets_[motor] &&
        axis.errors() == reported_errors_[motor]) {
      continue;
    }
    const drive::AxisErrors before = std::exchange(reported_errors_[motor], axis.errors());
    show_errors();
    if (std::exchange(reported_resets_[motor], axis.fault_resets()) != axis.fault_resets()) {
      send(drive::AxisEmergency{}, motor, now);
    }
    drive::for_each_row_only_in(tmcm_3315::kEmergencies, axis.errors(), before,
                                [&](const drive::AxisEmergency& row) {
                                  if (!row.of_device || !told_by_another(motor, row.error)) {
                                    send(row, row.of_device ? kWholeModule : motor, now);
                                  }
                                });
  }
}

bool Tmcm3315::told_by_another(std::uint8_t motor, drive::AxisError error) const {
  for (std::uint8_t other = 0; other < tmcm_3315::kAxisCount; ++other) {
    if (other != motor && reported_errors_[other].has(error)) {
      return true;
    }
  }
  return false;
}

void Tmcm3315::show_errors() {
  unsigned bits = 0;
  for (const drive::AxisErrors& errors : reported_errors_) {
    bits |= drive::register_bits_of(tmcm_3315::kEmergencies, errors);
  }
  error_register().set(static_cast<std::uint8_t>(bits));
}

void Tmcm3315::send(const drive::AxisEmergency& row, std::uint8_t motor, base::SimTime now) {
  send_emergency(row.code, row.register_bits, {row.detail, motor}, now);
}

std::vector<product::Signal> Tmcm3315::signals() const {
  std::vector<product::Signal> signals;
  for (const auto& axis : axes_) {
    axis->append_signals(signals);
  }
  io_.append_signals(signals);
  return signals;
}

std::vector<product::Input> Tmcm3315::inputs() {
  std::vector<product::Input> inputs;
  for (const auto& axis : axes_) {
    axis->append_inputs(inputs);
  }
  io_.append_inputs(inputs);
  inputs.emplace_back("shutdown_switch", "", 0.0, 1.0,
                      base::Delegate<void(double)>::bind<&Tmcm3315::input_shutdown_switch>(*this),
                      product::InputGroup::switches);
  inputs.push_back(clock_deviation_input());
  return inputs;
}

}  // namespace stator::devices
