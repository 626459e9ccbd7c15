#include "stator/devices/generic/node.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "stator/canopen/eds/eds.hpp"
#include "stator/devices/generic/signals.hpp"
#include "stator/devices/generic/slave.hpp"
#include "stator/devices/tmc8670/axis_unit.hpp"
#include "stator/devices/tmc8670/axis_world.hpp"

namespace stator::devices::generic {

namespace {

using base::SimDuration;
using base::SimTime;
using canopen::EdsFile;
using dictionary::Access;
using dictionary::DataType;
using dictionary::Entry;
using dictionary::EntryDeclaration;
using dictionary::ImportKind;
using dictionary::ImportReport;
using dictionary::ObjectCode;

// Of the predefined connection set (CiA 301 §7.2.4).
constexpr std::uint32_t kSyncCobId = 0x80;
constexpr std::uint32_t kEmergencyCobId = 0x80;

canopen::NodeConfiguration node_of(const EdsFile& file, const NodeConfiguration& configuration) {
  canopen::NodeConfiguration node;
  node.node_id = configuration.node_id;
  node.boot_time = SimDuration(1'000'000);
  node.sdo.block_transfer = file.block_transfer;
  node.quirks = configuration.quirks;
  if (file.lss) {
    node.lss = canopen::LssConfiguration{};
  }
  return node;
}

product::CanOpenFirmwareRules rules_of(const EdsFile& file,
                                       const NodeConfiguration& configuration) {
  dictionary::Dictionary objects;
  objects.add(file.objects.rows());
  objects.finish();
  const bool drives = is_drive(objects, 0);
  return {.control_period = drives ? tmc8670::AxisUnit::kControlPeriod : kPeriodWithoutDrives,
          .bit_rate = configuration.bit_rate,
          .pdos = canopen::with_quirks(canopen::PdoRules{}, configuration.quirks)};
}

EntryDeclaration number(std::uint16_t index, std::string_view name, DataType type, Access access,
                        dictionary::Default value) {
  return {.index = index, .name = name, .type = type, .access = access, .default_value = value};
}

void insert(std::vector<EntryDeclaration>& rows, const EntryDeclaration& row) {
  const auto place = std::ranges::upper_bound(
      rows, std::pair(row.index, row.subindex), {},
      [](const EntryDeclaration& each) { return std::pair(each.index, each.subindex); });
  rows.insert(place, row);
}

bool has(const EdsFile& file, std::uint16_t index) {
  return std::ranges::any_of(file.objects.rows(),
                             [index](const EntryDeclaration& row) { return row.index == index; });
}

void add_missing(EdsFile& file, const EntryDeclaration& row, ImportReport& report) {
  if (!has(file, row.index)) {
    insert(file.objects.rows(), row);
    report.add(ImportKind::assumed, 0, "mandatory-object",
               "the file has no object \"" + std::string(row.name) +
                   "\", which no node is without; the device has it");
  }
}

void add_identity(EdsFile& file, ImportReport& report) {
  constexpr std::uint16_t kIdentity = 0x1018;
  if (has(file, kIdentity)) {
    return;
  }
  report.add(ImportKind::assumed, 0, "mandatory-object",
             "the file has no identity 1018h; the device has what [DeviceInfo] says");
  const std::array<std::pair<std::string_view, std::uint32_t>, 4> rows{
      {{"Vendor ID", file.vendor},
       {"Product code", file.code},
       {"Revision number", file.revision},
       {"Serial number", 0}}};
  EntryDeclaration count =
      number(kIdentity, "Identity object", DataType::unsigned8, Access::constant, 4);
  count.object_code = ObjectCode::record;
  count.object_name = count.name;
  insert(file.objects.rows(), count);
  std::uint8_t subindex = 0;
  for (const auto& [name, value] : rows) {
    EntryDeclaration row =
        number(kIdentity, name, DataType::unsigned32, Access::constant, dictionary::hex(value));
    row.subindex = ++subindex;
    row.object_code = ObjectCode::record;
    insert(file.objects.rows(), row);
  }
}

}  // namespace

void complete(EdsFile& file, ImportReport& report) {
  add_missing(
      file,
      number(0x1000, "Device type", DataType::unsigned32, Access::constant, dictionary::hex(0)),
      report);
  EntryDeclaration error_register =
      number(0x1001, "Error register", DataType::unsigned8, Access::read_only, 0);
  error_register.live = true;
  add_missing(file, error_register, report);
  add_missing(
      file, number(0x1017, "Producer heartbeat time", DataType::unsigned16, Access::read_write, 0),
      report);
  // What takes SYNC and sends emergencies is in every node here.
  add_missing(file,
              number(0x1005, "COB-ID SYNC message", DataType::unsigned32, Access::read_write,
                     dictionary::hex(kSyncCobId)),
              report);
  EntryDeclaration emergency = number(0x1014, "COB-ID emergency object", DataType::unsigned32,
                                      Access::read_write, dictionary::hex(kEmergencyCobId));
  emergency.node_id_relative = true;
  add_missing(file, emergency, report);
  add_identity(file, report);
}

Node::Node(const EdsFile& file, const NodeConfiguration& configuration,
           base::EventReporter reporter, ImportReport* report)
    : CanOpenFirmware(
          node_of(file, configuration), rules_of(file, configuration),
          [&file](dictionary::Dictionary& objects) {
            objects.add(file.objects.rows());
            objects.finish();
          },
          reporter) {
  for (unsigned axis = 0; axis < kMostAxes && is_drive(objects(), axis); ++axis) {
    const plant::PwmAxisParameters around =
        axis < configuration.axes.size() ? configuration.axes[axis] : tmc8670::default_axis();
    drives_.emplace_back(objects(), axis, configuration.units, around, reporter, report);
  }
  if (const Entry* serial = objects().find(0x1018, 4); serial != nullptr) {
    objects().set_default(0x1018, 4, configuration.serial_number);
  }
  inputs_.bind(objects(),
               [this](const Entry& entry) { return is_of_drive(entry, drives_.size()); });
  const std::array<std::int64_t, 1> bit_rates{configuration.bit_rate / 1000};
  eds_ = canopen::eds_text(objects(), {.file_name = "device.eds",
                                       .title = file.product_name,
                                       .date = "01-01-2026",
                                       .vendor_name = file.vendor_name,
                                       .product_name = file.product_name,
                                       .order_code = file.order_code,
                                       .bit_rates = bit_rates,
                                       .lss = file.lss});
  start_firmware(SimTime());
}

void Node::restart(SimTime now) {
  for (Drive& drive : drives_) {
    drive.restart(now);
  }
  inputs_.restore();
}

void Node::tick(SimTime now) {
  for (Drive& drive : drives_) {
    drive.tick(now);
  }
  report_errors(now);
  pdos().values_may_have_changed(now);
}

void Node::step_world(SimTime until) {
  for (Drive& drive : drives_) {
    drive.step_world(until);
  }
}

void Node::apply(SimTime now) {
  bool obeyed = false;
  for (Drive& drive : drives_) {
    obeyed |= drive.apply(now);
  }
  if (obeyed) {
    report_errors(now);
    pdos().values_may_have_changed(now);
  }
}

// Controlwords come by SDO as well, before the node is Operational.
void Node::state_changed(canopen::NmtState state, SimTime now) {
  for (Drive& drive : drives_) {
    drive.set_network_operational(
        state == canopen::NmtState::operational || state == canopen::NmtState::pre_operational,
        now);
  }
}

void Node::report_errors(SimTime now) {
  for (Drive& drive : drives_) {
    drive.report_errors([&](const drive::AxisEmergency& row) {
      if (row.code == 0) {
        emergency_producer().forget();
        emergency_producer().report_reset(now);
      } else {
        emergency_producer().raise(
            {.code = row.code, .error_register = row.register_bits, .information = {row.detail}},
            now);
      }
    });
  }
}

std::vector<product::Signal> Node::signals() const {
  return device_signals(dictionary(), drives_);
}

std::vector<product::Input> Node::inputs() {
  std::vector<product::Input> all;
  inputs_.append(all);
  for (Drive& drive : drives_) {
    drive.append_inputs(all);
  }
  return all;
}

}  // namespace stator::devices::generic
