#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

#include <span>
#include <utility>

#include "stator/devices/tmcm_3315/controller.hpp"
#include "stator/product/shell/coe_stack.hpp"

namespace stator::devices {

namespace {

using ethercat::AlState;
using tmcm_3315::AxisUnit;
using tmcm_3315::Emergency;

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

ethercat::SlaveStackOptions stack_options(const Tmcm3315Configuration& configuration,
                                          ethercat::FileStore& files) {
  ethercat::SlaveStackOptions options =
      product::coe_stack_options(configuration.coe, configuration.quirks);
  options.files = &files;
  options.foe.bootstrap_only = true;
  options.process_memory_end = kProcessMemoryEnd;
  options.distributed_clocks.sync0 = true;
  options.distributed_clocks.shortest_cycle = kShortestCycle;
  options.distributed_clocks.longest_cycle = kLongestCycle;
  return options;
}

}  // namespace

Tmcm3315::Tmcm3315(const Tmcm3315Configuration& configuration, base::EventReporter reporter)
    : configuration_(configuration),
      reporter_(reporter),
      description_(describe(configuration)),
      controller_(tmcm_3315::kController.configuration),
      axes_([&] {
        tmcm_3315::add_objects(dictionary_, configuration.firmware);
        std::array<std::unique_ptr<AxisUnit>, tmcm_3315::kAxisCount> axes;
        for (std::uint8_t n = 0; n < tmcm_3315::kAxisCount; ++n) {
          axes[n] = std::make_unique<AxisUnit>(
              dictionary_, n, configuration.axes[n],
              tmcm_3315::AxisUnitConfiguration{configuration.full_scale_current,
                                               configuration.driver_limits,
                                               configuration.home_offset_is_position},
              reporter);
        }
        return axes;
      }()),
      stack_(controller_, dictionary_, description_, *this, reporter,
             stack_options(configuration, firmware_)),
      error_register_(dictionary_.variable<std::uint8_t>(0x1001)),
      io_(dictionary_),
      usb_(dictionary_, io_, configuration.firmware, kFirmwareCapacity, reporter) {
  using Query = dictionary::Dictionary::DriveStateQuery;
  dictionary_.set_drive_state_query(Query::bind<&Tmcm3315::drive_state>(*this));
  set_identity(configuration);
  controller_.set_event_reporter(reporter);
  controller_.load_sii(
      product::coe_sii_image(description_, dictionary_, configuration.coe, configuration.quirks));
  feed_brakes();
}

void Tmcm3315::set_identity(const Tmcm3315Configuration& configuration) {
  dictionary_.find(0x1018, 2)->set_value(configuration.product_code);
  dictionary_.find(0x1018, 3)->set_value(description_.revision);
}

base::StaticText Tmcm3315::drive_state(std::uint8_t axis) {
  const drive::PowerState state = axes_[axis]->axis().power_state();
  return state == drive::PowerState::switch_on_disabled ? base::StaticText()
                                                        : drive::to_text(state);
}

void Tmcm3315::advance(base::SimTime now) {
  while (true) {
    const base::SimTime step_end = now_ + kPlantStep;
    const base::SimTime sync0 = controller_.next_sync_edge(0);
    if (sync0 <= now && sync0 <= step_end && sync0 >= sync0_earliest_) {
      sync0_earliest_ = sync0 + kPlantStep;
      controller_.advance(sync0);
      take_sync0(sync0);
      continue;
    }
    if (step_end > now) {
      break;
    }
    for (const auto& axis : axes_) {
      axis->step(kPlantStep);
    }
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

void Tmcm3315::tick(base::SimTime now) {
  controller_.advance(now);
  if (usb_.in_boot_loader()) {
    run_boot_loader(now);
    return;
  }
  process_bus(now);
  io_.read_inputs();
  for (const auto& axis : axes_) {
    axis->axis().conditions().shutdown_switch = shutdown_switch_;
    axis->tick(now, io_.input_bits());
  }
  switch_outputs();
  usb_.serve(now);
  report_errors(now);
  if (!stack_.synchronous()) {
    outputs_came_ = false;
    stack_.publish_inputs(now);
  }
}

void Tmcm3315::run_boot_loader(base::SimTime now) {
  if (usb_.take_boot_request()) {
    stop_firmware(now);
  }
  usb_.serve(now);
  if (!usb_.start_requested()) {
    return;
  }
  if (const std::span<const std::byte> image = usb_.loaded_image(); !image.empty()) {
    // It fits, since the boot loader has no more memory; what cannot be kept leaves the old one.
    static_cast<void>(firmware_.open_for_writing("usb"));
    static_cast<void>(firmware_.append(image));
    static_cast<void>(firmware_.commit());
    reporter_.report(now, kNewFirmware, {base::EventArgument(image.size())});
  }
  restart_firmware(now);
}

void Tmcm3315::take_sync0(base::SimTime now) {
  const std::uint64_t pulses = controller_.sync_pulse_count(0);
  if (std::exchange(sync0_pulses_, pulses) != pulses) {
    stack_.sync0(now);
  }
}

void Tmcm3315::on_sync0(base::SimTime now) {
  apply_commands(now);
  outputs_came_ = false;
  switch_outputs();
  stack_.publish_inputs(now);
}

bool Tmcm3315::connect_serial(std::string_view interface, tmcl::SerialPort* port) {
  if (interface != kSerialInterfaces[0]) {
    return false;
  }
  usb_.connect(port);
  return true;
}

void Tmcm3315::set_power(bool on, base::SimTime now) {
  powered_ = on;
  // Without power the axes are what they are before the firmware has started: switched off.
  restart_firmware(now);
  static_cast<void>(controller_.take_reset_request());
}

void Tmcm3315::handle_bus_events(base::SimTime now) {
  if (!powered_ || usb_.in_boot_loader()) {
    return;
  }
  if (controller_.take_reset_request()) {
    restart_firmware(now);
  }
  take_sync0(now);  // one that the frame has overtaken
  process_bus(now);
  apply_commands(now);
  if (outputs_came_) {
    outputs_came_ = false;
    switch_outputs();
    stack_.publish_inputs(now);
  }
}

void Tmcm3315::process_bus(base::SimTime now) {
  stack_.process(now);
  if (restart_due_) {
    reporter_.report(now, kNewFirmware, {base::EventArgument(firmware_.size())});
    restart_firmware(now);
  }
}

void Tmcm3315::restart_firmware(base::SimTime now) {
  downloads_in_force_ = firmware_.downloads();
  usb_.restart();
  stop_firmware(now);
}

void Tmcm3315::stop_firmware(base::SimTime now) {
  restart_due_ = false;
  dictionary_.reset_values();
  set_identity(configuration_);
  io_.restart();
  reported_errors_ = {};
  reported_resets_ = {};
  for (const auto& axis : axes_) {
    axis->restart(now);
  }
  feed_brakes();
  stack_.reset(now);
}

void Tmcm3315::apply_commands(base::SimTime now) {
  bool obeyed = false;
  for (const auto& axis : axes_) {
    obeyed |= axis->apply(now);
  }
  if (obeyed) {
    switch_outputs();
  }
  report_errors(now);
}

void Tmcm3315::on_state(AlState from, AlState to, base::SimTime now) {
  if (from == AlState::bootstrap) {
    restart_due_ = firmware_.downloads() != downloads_in_force_;
  }
  const bool operational = to == AlState::operational;
  if (!operational && from != AlState::operational) {
    return;
  }
  for (const auto& axis : axes_) {
    axis->set_network_operational(operational, now);
  }
  switch_outputs();
}

void Tmcm3315::on_outputs(base::SimTime /*now*/) {
  outputs_came_ = true;
}

void Tmcm3315::before_inputs(base::SimTime /*now*/) {}

void Tmcm3315::on_output_refused(const dictionary::Entry& /*entry*/,
                                 const dictionary::Refusal& /*refusal*/, base::SimTime now) {
  send_emergency(tmcm_3315::kParameterError, kWholeModule, now);
}

void Tmcm3315::switch_outputs() {
  tmcm_3315::BrakeFeeds brakes;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    brakes[i] = axes_[i]->brake_feed();
  }
  io_.switch_outputs(stack_.state() == AlState::operational, brakes);
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
    const drive::AxisErrors before = reported_errors_[motor];
    if (axis.fault_resets() == reported_resets_[motor] && axis.errors() == before) {
      continue;
    }
    reported_errors_[motor] = axis.errors();
    error_register_.set(error_register());
    if (axis.fault_resets() != reported_resets_[motor]) {
      reported_resets_[motor] = axis.fault_resets();
      send_emergency(tmcm_3315::kFaultReset, motor, now);
    }
    for (const tmcm_3315::AxisEmergency& row : tmcm_3315::kAxisEmergencies) {
      if (!axis.errors().has(row.error) || before.has(row.error)) {
        continue;
      }
      if (!row.whole_module) {
        send_emergency(row.emergency, motor, now);
      } else if (!told_by_another(motor, row.error)) {
        send_emergency(row.emergency, kWholeModule, now);
      }
    }
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

std::uint8_t Tmcm3315::error_register() const {
  unsigned bits = 0;
  for (const drive::AxisErrors& errors : reported_errors_) {
    for (const tmcm_3315::AxisEmergency& row : tmcm_3315::kAxisEmergencies) {
      bits |= errors.has(row.error) ? row.emergency.register_bits : 0U;
    }
  }
  return static_cast<std::uint8_t>(bits);
}

void Tmcm3315::send_emergency(const Emergency& emergency, std::uint8_t motor, base::SimTime now) {
  const auto bits = static_cast<std::uint8_t>(error_register_.get() | emergency.register_bits);
  stack_.send_emergency(emergency.code, bits, {emergency.detail, motor, 0, 0, 0}, now);
}

std::vector<product::Signal> Tmcm3315::signals() {
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
  inputs.push_back({"shutdown_switch", "", 0.0, 1.0,
                    base::Delegate<void(double)>::bind<&Tmcm3315::input_shutdown_switch>(*this)});
  inputs.push_back(clock_deviation_input());
  return inputs;
}

}  // namespace stator::devices
