#include "stator/devices/generic/slave.hpp"

#include <algorithm>
#include <utility>

#include "stator/devices/generic/signals.hpp"
#include "stator/devices/tmc8670/axis_unit.hpp"
#include "stator/devices/tmc8670/axis_world.hpp"
#include "stator/product/shell/coe_stack.hpp"

namespace stator::devices::generic {

namespace {

using base::SimTime;
using dictionary::Entry;
using ethercat::ImportedSlave;

constexpr std::uint16_t kMemoryStart = 0x1000;
constexpr std::uint16_t kMemoryEnd = 0x5000;  // of the controller, 16 KB
/// ESCs with a larger memory are rare: what such a file has behind is not reached.
constexpr std::uint16_t kUsualMailbox = 128;
constexpr std::uint16_t kLargestImage = 512;  // kbit

/// Mailboxes, memory and EEPROM that the file leaves open.
ethercat::DeviceDescription description_of(const ImportedSlave& file,
                                           const SlaveConfiguration& configuration) {
  ethercat::DeviceDescription description = file.description;
  description.serial_number = configuration.serial_number;
  description.station_alias = configuration.coe.station_alias;
  description.eoe = description.eoe || configuration.coe.ethernet_over_ethercat;
  // It has a firmware, whatever interface that has; one without any would answer nothing.
  constexpr std::uint16_t kEmulation = 0x0100;
  constexpr std::uint16_t kType = 0x00FF;
  constexpr std::uint16_t kSpiSlave = 0x0005;
  description.pdi_control &= static_cast<std::uint16_t>(~kEmulation);
  if ((description.pdi_control & kType) == 0) {
    description.pdi_control |= kSpiSlave;
  }
  // No file says what a device does with files or with Ethernet frames.
  description.foe = false;
  for (const ethercat::ImportedSyncManager& manager : file.sync_managers) {
    if (manager.type == ethercat::kProcessOutputs && description.output_offset == 0) {
      description.output_offset = manager.start;
    } else if (manager.type == ethercat::kProcessInputs && description.input_offset == 0) {
      description.input_offset = manager.start;
    }
  }
  if (description.receive_mailbox.length == 0) {
    description.receive_mailbox = {kMemoryStart, kUsualMailbox};
    description.transmit_mailbox = {kMemoryStart + kUsualMailbox, kUsualMailbox};
  }
  return description;
}

product::EtherCatFirmwareParts parts_of(const ImportedSlave& file,
                                        const SlaveConfiguration& configuration) {
  ethercat::SlaveStackOptions stack =
      product::coe_stack_options(configuration.coe, configuration.quirks);
  stack.process_memory_end = kMemoryEnd;
  stack.distributed_clocks.sync0 = !file.clock_modes.empty();
  stack.distributed_clocks.sync1 = stack.distributed_clocks.sync0;
  ethercat::DeviceDescription description = description_of(file, configuration);
  description.distributed_clocks = stack.distributed_clocks.sync0;
  description.sii_grows = true;  // the size of many files is that of a template
  description.sii_size_kbit =
      std::clamp<std::uint16_t>(description.sii_size_kbit, 16, kLargestImage);
  ethercat::SlaveControllerConfiguration controller;
  controller.host_interface = static_cast<std::uint8_t>(description.pdi_control);
  controller.port_descriptor = 0;
  for (std::size_t port = 0; port < description.port_physics.size(); ++port) {
    const unsigned code = description.port_physics[port] == 'Y'   ? 3U
                          : description.port_physics[port] == ' ' ? 0U
                                                                  : 2U;
    controller.port_descriptor |= static_cast<std::uint8_t>(code << (2 * port));
  }
  const bool drives = count_drives(file) != 0;
  return {
      .description = description,
      .controller = controller,
      .stack = stack,
      .coe = configuration.coe,
      .quirks = configuration.quirks,
      .rules = {.control_period = drives ? tmc8670::AxisUnit::kControlPeriod : kPeriodWithoutDrives,
                .step_before_tick = !drives,
                .periods_follow_sync0 = drives}};
}

/// The rows of the file; what StandardObjects adds comes after them.
void declare(dictionary::Dictionary& objects, const ImportedSlave& file) {
  objects.add(file.objects.rows());
}

}  // namespace

unsigned count_drives(const ImportedSlave& file) {
  dictionary::Dictionary objects;
  objects.add(file.objects.rows());
  objects.finish();
  unsigned count = 0;
  while (count < kMostAxes && is_drive(objects, count)) {
    ++count;
  }
  return count;
}

Slave::Slave(const ImportedSlave& file, const SlaveConfiguration& configuration,
             base::EventReporter reporter, dictionary::ImportReport* report)
    : EtherCatFirmware(
          parts_of(file, configuration),
          [&file](dictionary::Dictionary& objects) { declare(objects, file); }, reporter) {
  for (unsigned number = 0; number < kMostAxes && is_drive(objects(), number); ++number) {
    const plant::PwmAxisParameters axis =
        number < configuration.axes.size() ? configuration.axes[number] : tmc8670::default_axis();
    drives_.emplace_back(objects(), number, configuration.units, axis, reporter, report);
  }
  if (objects().find(0x1018, 4) != nullptr) {
    objects().set_default(0x1018, 4, configuration.serial_number);
  }
  inputs_.bind(objects(),
               [this](const Entry& entry) { return is_of_drive(entry, drives_.size()); });
  objects().reset_values();
  restart(SimTime());
}

void Slave::restart(SimTime now) {
  for (Drive& drive : drives_) {
    drive.restart(now);
  }
  inputs_.restore();
}

void Slave::run_drives(SimTime now) {
  for (Drive& drive : drives_) {
    drive.tick(now);
  }
  report_errors(now);
}

void Slave::tick(SimTime now) {
  run_drives(now);
}

void Slave::step_world(SimTime until) {
  for (Drive& drive : drives_) {
    drive.step_world(until);
  }
}

void Slave::apply(SimTime now) {
  if (stack().synchronous()) {
    return;
  }
  bool obeyed = false;
  for (Drive& drive : drives_) {
    obeyed |= drive.apply(now);
  }
  if (obeyed) {
    report_errors(now);
  }
}

void Slave::network_operational(bool operational, SimTime now) {
  for (Drive& drive : drives_) {
    drive.set_network_operational(operational, now);
  }
}

void Slave::before_inputs(SimTime /*now*/) {
  for (Drive& drive : drives_) {
    drive.show();
  }
}

void Slave::report_errors(SimTime now) {
  std::uint8_t bits = 0;
  for (Drive& drive : drives_) {
    drive.report_errors([&](const drive::AxisEmergency& row) {
      send_emergency(row.code, row.register_bits, {row.detail}, now);
    });
    bits |= drive.error_register();
  }
  error_register().set(bits);
}

std::vector<product::Signal> Slave::signals() const {
  return device_signals(dictionary(), drives_);
}

std::vector<product::Input> Slave::inputs() {
  std::vector<product::Input> all;
  inputs_.append(all);
  for (Drive& drive : drives_) {
    drive.append_inputs(all);
  }
  all.push_back(clock_deviation_input());
  return all;
}

}  // namespace stator::devices::generic
