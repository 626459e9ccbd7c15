#include "stator/product/shell/ethercat_firmware.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "stator/product/shell/boot_loading.hpp"
#include "stator/product/shell/coe_stack.hpp"

namespace stator::product {

namespace {

using base::SimDuration;
using base::SimTime;
using ethercat::AlState;

constexpr SimDuration kInstant{1};

constexpr SimDuration half(SimDuration duration) {
  return SimDuration(duration.nanoseconds() / 2);
}

ethercat::SlaveStackOptions with_files(ethercat::SlaveStackOptions options,
                                       FirmwareMemory& firmware) {
  if (firmware.capacity() != 0) {
    options.files = &firmware;
  }
  return options;
}

// Of an outline: two mailboxes at the begin of the process memory, then three buffers for each
// direction.
constexpr ethercat::MailboxArea kReceiveMailbox{0x1000, 256};
constexpr ethercat::MailboxArea kTransmitMailbox{0x1100, 256};
constexpr std::uint16_t kOutputs = 0x1200;
constexpr std::uint16_t kInputs = 0x3000;
constexpr std::uint16_t kMemoryEnd = 0x5000;

/// A sync manager of one byte that masters write and that triggers the watchdog does nothing else
/// (see ethercat::SyncManager), a mistake that is hard to find.
void require_room_for_outputs(const EtherCatOutline& outline) {
  using dictionary::PdoMapping;
  constexpr std::size_t kByte = 8;
  std::size_t bits = 0;
  for (const dictionary::EntryDeclaration& each : outline.objects) {
    if (each.mapping == PdoMapping::receive || each.mapping == PdoMapping::both) {
      bits += dictionary::bit_length(each.type);
    }
  }
  if (bits != 0 && bits <= kByte) {
    throw std::logic_error("outputs of one byte would only trigger the watchdog; map two at least");
  }
}

EtherCatFirmwareParts parts_of(const EtherCatOutline& outline) {
  require_room_for_outputs(outline);
  ethercat::DeviceDescription description;
  description.vendor_id = outline.vendor;
  description.product_code = outline.code;
  description.revision = outline.revision;
  description.order_code = outline.name;
  description.name = outline.name;
  description.group = "Devices";
  description.station_alias = outline.coe.station_alias;
  description.receive_mailbox = kReceiveMailbox;
  description.transmit_mailbox = kTransmitMailbox;
  description.output_offset = kOutputs;
  description.input_offset = kInputs;
  description.coe = true;
  description.sdo_information = true;
  description.complete_access = true;
  ethercat::SlaveStackOptions stack = coe_stack_options(outline.coe, outline.quirks);
  stack.process_memory_end = kMemoryEnd;
  return {.description = description,
          .stack = stack,
          .coe = outline.coe,
          .quirks = outline.quirks,
          .rules = {.control_period = outline.period}};
}

}  // namespace

EtherCatFirmware::EtherCatFirmware(const EtherCatOutline& outline, base::EventReporter reporter)
    : EtherCatFirmware(
          parts_of(outline),
          [&outline](dictionary::Dictionary& objects) { objects.add(outline.objects); }, reporter) {
}

EtherCatFirmware::EtherCatFirmware(const EtherCatFirmwareParts& parts,
                                   const std::function<void(dictionary::Dictionary&)>& declare,
                                   base::EventReporter reporter)
    : rules_(parts.rules),
      reporter_(reporter),
      description_(parts.description),
      controller_(parts.controller),
      firmware_(parts.rules.firmware_capacity),
      stack_(controller_, declared(declare), description_, *this, reporter,
             with_files(parts.stack, firmware_)),
      error_register_(dictionary_.variable<std::uint8_t>(0x1001)),
      next_tick_(SimTime() + rules_.control_period) {
  controller_.set_event_reporter(reporter);
  controller_.load_sii(coe_sii_image(description_, dictionary_, parts.coe, parts.quirks));
}

dictionary::Dictionary& EtherCatFirmware::declared(
    const std::function<void(dictionary::Dictionary&)>& declare) {
  declare(dictionary_);
  if (!dictionary_.finished()) {
    standard_objects_.add_missing(dictionary_, description_);
    dictionary_.finish();
  }
  return dictionary_;
}

SimTime EtherCatFirmware::next_sync0() {
  const SimTime edge = controller_.next_sync_edge(0);
  return edge >= sync0_earliest_ ? edge : SimTime::never();
}

void EtherCatFirmware::advance(SimTime now) {
  while (true) {
    const SimTime sync0 = next_sync0();
    const SimTime next = std::min(sync0, next_tick_);
    if (next > now) {
      break;
    }
    const bool steps_end_first = next != sync0 && rules_.step_before_tick;
    step_world(steps_end_first ? next : next - kInstant);
    if (next == sync0) {
      sync0_earliest_ = sync0 + rules_.sync0_interrupt;
      controller_.advance(sync0);
      if (runs() || rules_.sync0_until_stopped) {
        take_sync0(sync0);
      }
    } else {
      next_tick_ += rules_.control_period;
      if (powered_) {
        begin_period(next);
      }
    }
  }
  step_world(now);
  controller_.advance(now);
}

void EtherCatFirmware::begin_period(SimTime now) {
  controller_.advance(now);
  if (in_boot_loader()) {
    run_boot_loader(now);
    return;
  }
  process_bus(now);
  if (rules_.periods_follow_sync0 && stack_.synchronous() && --ticks_to_sync_ == 0) {
    next_tick_ += half(rules_.control_period);
  }
  tick(now);
  if (!stack_.synchronous()) {
    outputs_came_ = false;
    stack_.publish_inputs(now);
  }
}

void EtherCatFirmware::run_boot_loader(SimTime now) {
  if (boot_loader_->take_boot_request()) {
    stop_firmware(now);
  }
  tick_without_firmware(now);
  boot_loader_->serve(now);
  if (boot_loader_->start_requested()) {
    keep_loaded_image(*boot_loader_, firmware_, rules_.new_firmware, reporter_, now);
    restart_firmware(now);
  }
}

void EtherCatFirmware::take_sync0(SimTime now) {
  const std::uint64_t pulses = controller_.sync_pulse_count(0);
  if (std::exchange(sync0_pulses_, pulses) != pulses) {
    stack_.sync0(now);
  }
}

void EtherCatFirmware::on_sync0(SimTime now) {
  if (rules_.periods_follow_sync0) {
    next_tick_ = now + rules_.control_period;
    ticks_to_sync_ = std::max<std::int64_t>(stack_.clocks().cycle() / rules_.control_period - 1, 0);
    if (ticks_to_sync_ == 0) {
      next_tick_ += half(rules_.control_period);
    }
  }
  outputs_came_ = false;
  at_sync0(now);
  stack_.publish_inputs(now);
}

void EtherCatFirmware::handle_bus_events(SimTime now) {
  if (!runs()) {
    return;
  }
  if (controller_.take_reset_request()) {
    restart_firmware(now);
  }
  take_sync0(now);  // one that the frame has overtaken
  process_bus(now);
  apply(now);
  if (std::exchange(outputs_came_, false)) {
    outputs_obeyed();
    stack_.publish_inputs(now);
  }
}

void EtherCatFirmware::process_bus(SimTime now) {
  before_bus();
  stack_.process(now);
  if (restart_due_) {
    report_new_firmware(firmware_.size(), rules_.new_firmware, reporter_, now);
    restart_firmware(now);
  }
}

void EtherCatFirmware::set_power(bool on, SimTime now) {
  powered_ = on;
  // Without power everything is what it is before the firmware has started: drives are off.
  restart_firmware(now);
  if (rules_.periods_follow_sync0) {
    next_tick_ = now + rules_.control_period;
  }
  static_cast<void>(controller_.take_reset_request());
}

void EtherCatFirmware::restart_firmware(SimTime now) {
  downloads_in_force_ = firmware_.downloads();
  if (boot_loader_ != nullptr) {
    boot_loader_->restart();
  }
  stop_firmware(now);
}

void EtherCatFirmware::stop_firmware(SimTime now) {
  restart_due_ = false;
  dictionary_.reset_values();
  restart(now);
  stack_.reset(now);
}

void EtherCatFirmware::on_state(AlState from, AlState to, SimTime now) {
  if (from == AlState::bootstrap) {
    restart_due_ = firmware_.downloads() != downloads_in_force_;
  }
  const bool operational = to == AlState::operational;
  if (operational || from == AlState::operational) {
    network_operational(operational, now);
  }
}

void EtherCatFirmware::on_output_refused(const dictionary::Entry& /*entry*/,
                                         const dictionary::Refusal& /*refusal*/, SimTime now) {
  send_emergency(kRefusedOutput, kRefusedOutputBits, rules_.refused_output_bytes, now);
}

void EtherCatFirmware::send_emergency(std::uint16_t code, std::uint8_t register_bits,
                                      const std::array<std::uint8_t, 5>& additional, SimTime now) {
  const auto bits = static_cast<std::uint8_t>(error_register_.get() | register_bits);
  stack_.send_emergency(code, bits, additional, now);
}

}  // namespace stator::product
