#include "stator/product/shell/standard_objects.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "stator/canopen/pdo/pdo_rules.hpp"
#include "stator/dictionary/data_type.hpp"

namespace stator::product {

namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::Default;
using dictionary::Entry;
using dictionary::EntryDeclaration;
using dictionary::hex;
using dictionary::ObjectCode;
using dictionary::PdoMapping;

EntryDeclaration constant(std::uint16_t index, std::uint8_t subindex, std::string_view name,
                          DataType type, Default value) {
  return {.index = index,
          .subindex = subindex,
          .name = name,
          .type = type,
          .access = Access::constant,
          .default_value = value};
}

/// What a PDO mapping entry says of an object (ETG.1000.6 §5.6.7.4.7).
std::uint32_t mapped(const Entry& entry) {
  return std::uint32_t{entry.index()} << 16 | std::uint32_t{entry.subindex()} << 8 |
         static_cast<std::uint32_t>(dictionary::bit_length(entry.type()));
}

/// A row of an array or record.
struct Row {
  std::string_view name;
  Default value;
};

constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

/// Collects the rows that are missing.
class Missing {
 public:
  Missing(const dictionary::Dictionary& objects, std::vector<EntryDeclaration>& rows)
      : objects_(objects), rows_(rows) {}

  [[nodiscard]] bool lacks(std::uint16_t index) const {
    return std::ranges::none_of(objects_.entries(),
                                [&](const Entry& entry) { return entry.index() == index; });
  }
  void add(const EntryDeclaration& row) {
    if (lacks(row.index)) {
      rows_.push_back(row);
    }
  }
  /// A variable that masters may write.
  void add_writable(std::uint16_t index, std::string_view name, DataType type, Default value,
                    bool counts_from_node_id = false) {
    add({.index = index,
         .name = name,
         .type = type,
         .default_value = value,
         .node_id_relative = counts_from_node_id});
  }
  void add_list(std::uint16_t index, std::string_view name, ObjectCode code, DataType type,
                const std::vector<Row>& list) {
    if (!lacks(index)) {
      return;
    }
    EntryDeclaration count =
        constant(index, 0, name, DataType::unsigned8, static_cast<unsigned>(list.size()));
    count.object_code = code;
    count.object_name = name;
    rows_.push_back(count);
    for (const Row& row : list) {
      const auto subindex = static_cast<std::uint8_t>(rows_.back().subindex + 1);
      rows_.push_back(constant(index, subindex, row.name, type, row.value));
      rows_.back().object_code = code;
    }
  }
  /// The rows that all objects in one direction make in PDOs of `most_bits` at most.
  [[nodiscard]] std::vector<std::vector<Row>> mappings(PdoMapping direction,
                                                       std::size_t most_bits) const {
    std::vector<std::vector<Row>> pdos;
    std::size_t room = 0;
    for (const Entry& entry : objects_.entries()) {
      const PdoMapping allowed = entry.declaration().mapping;
      if (allowed != direction && allowed != PdoMapping::both) {
        continue;
      }
      const std::size_t bits = dictionary::bit_length(entry.type());
      if (pdos.empty() || bits > room) {
        pdos.emplace_back();
        room = most_bits;
      }
      pdos.back().push_back({"Mapped object", hex(mapped(entry))});
      room -= std::min(bits, room);
    }
    return pdos;
  }
  /// A PDO of CANopen: communication parameters, which masters may write, and fixed mapping.
  void add_pdo(std::uint16_t communication, std::uint16_t mapping, std::uint32_t identifier,
               bool transmits, const std::vector<Row>& rows) {
    if (!lacks(communication) || !lacks(mapping)) {
      return;
    }
    constexpr unsigned kReceiveRows = 2;
    constexpr unsigned kTransmitRows = 5;
    EntryDeclaration row = constant(
        communication, 0,
        transmits ? "Transmit PDO communication parameter" : "Receive PDO communication parameter",
        DataType::unsigned8, transmits ? kTransmitRows : kReceiveRows);
    row.object_code = ObjectCode::record;
    row.object_name = row.name;
    rows_.push_back(row);
    const auto add_row = [&](std::uint8_t subindex, std::string_view name, DataType type,
                             Default value) {
      rows_.push_back({.index = communication,
                       .subindex = subindex,
                       .name = name,
                       .object_code = ObjectCode::record,
                       .type = type,
                       .default_value = value});
    };
    add_row(1, "COB-ID used by PDO", DataType::unsigned32, hex(identifier));
    rows_.back().node_id_relative = true;
    add_row(2, "Transmission type", DataType::unsigned8, canopen::kEventDrivenProfile);
    if (transmits) {
      add_row(3, "Inhibit time", DataType::unsigned16, 0);
      rows_.back().unit = "100 us";
      add_row(kTransmitRows, "Event timer", DataType::unsigned16, 0);
      rows_.back().unit = "ms";
    }
    add_list(mapping,
             transmits ? "Transmit PDO mapping parameter" : "Receive PDO mapping parameter",
             ObjectCode::record, DataType::unsigned32, rows);
  }
  /// The PDO with all that can be mapped in one direction, and its assignment.
  void add_process_data(std::uint16_t mapping, std::uint16_t assignment, PdoMapping direction,
                        std::string_view mapping_name, std::string_view assignment_name) {
    const auto pdos = mappings(direction, kNoLimit);
    const std::vector<Row> mapping_rows = pdos.empty() ? std::vector<Row>() : pdos.front();
    add_list(mapping, mapping_name, ObjectCode::record, DataType::unsigned32, mapping_rows);
    std::vector<Row> assignment_rows;
    if (!mapping_rows.empty()) {
      assignment_rows.push_back({"Assigned PDO", hex(mapping)});
    }
    add_list(assignment, assignment_name, ObjectCode::array, DataType::unsigned16, assignment_rows);
  }

 private:
  const dictionary::Dictionary& objects_;
  std::vector<EntryDeclaration>& rows_;
};

}  // namespace

void StandardObjects::add_missing(dictionary::Dictionary& objects,
                                  const ethercat::DeviceDescription& description) {
  Missing missing(objects, rows_);
  missing.add(constant(0x1000, 0, "Device type", DataType::unsigned32, hex(0)));
  missing.add({.index = 0x1001,
               .name = "Error register",
               .type = DataType::unsigned8,
               .access = Access::read_only});
  missing.add(constant(0x1008, 0, "Manufacturer device name", DataType::visible_string,
                       description.name.c_str()));
  missing.add_list(0x1018, "Identity object", ObjectCode::record, DataType::unsigned32,
                   {{"Vendor ID", hex(description.vendor_id)},
                    {"Product code", hex(description.product_code)},
                    {"Revision number", hex(description.revision)},
                    {"Serial number", description.serial_number}});
  missing.add_process_data(0x1600, 0x1C12, PdoMapping::receive, "Receive PDO mapping",
                           "Sync manager 2 PDO assignment");
  missing.add_process_data(0x1A00, 0x1C13, PdoMapping::transmit, "Transmit PDO mapping",
                           "Sync manager 3 PDO assignment");
  missing.add_list(0x1C00, "Sync manager communication type", ObjectCode::array,
                   DataType::unsigned8,
                   {{"Mailbox receive", 1},
                    {"Mailbox send", 2},
                    {"Process data outputs", 3},
                    {"Process data inputs", 4}});
  objects.add(rows_);
}

void CanOpenStandardObjects::add_missing(dictionary::Dictionary& objects,
                                         const CanOpenIdentity& identity) {
  // Of the predefined connection set; those of the four PDOs lie 100h apart.
  constexpr std::uint32_t kSync = 0x80;
  constexpr std::uint32_t kEmergency = 0x80;
  constexpr std::uint32_t kFirstTransmitPdo = 0x180;
  constexpr std::uint32_t kFirstReceivePdo = 0x200;
  constexpr std::uint32_t kBetweenPdos = 0x100;
  constexpr std::size_t kPdos = 4;

  name_ = identity.name;
  Missing missing(objects, rows_);
  missing.add(constant(0x1000, 0, "Device type", DataType::unsigned32, hex(0)));
  missing.add({.index = 0x1001,
               .name = "Error register",
               .type = DataType::unsigned8,
               .access = Access::read_only,
               .live = true});
  missing.add_writable(0x1005, "COB-ID SYNC message", DataType::unsigned32, hex(kSync));
  missing.add(
      constant(0x1008, 0, "Manufacturer device name", DataType::visible_string, name_.c_str()));
  missing.add_writable(0x1014, "COB-ID emergency object", DataType::unsigned32, hex(kEmergency),
                       true);
  if (missing.lacks(0x1016)) {
    missing.add_list(0x1016, "Consumer heartbeat time", ObjectCode::array, DataType::unsigned32,
                     {{"Consumer heartbeat time", 0}});
    rows_.back().access = Access::read_write;
  }
  missing.add_writable(0x1017, "Producer heartbeat time", DataType::unsigned16, 0);
  missing.add_list(0x1018, "Identity object", ObjectCode::record, DataType::unsigned32,
                   {{"Vendor ID", hex(identity.vendor)},
                    {"Product code", hex(identity.code)},
                    {"Revision number", hex(identity.revision)},
                    {"Serial number", identity.serial_number}});
  for (const bool transmits : {false, true}) {
    const auto pdos = missing.mappings(transmits ? PdoMapping::transmit : PdoMapping::receive,
                                       canopen::kMaximumPdoBits);
    if (pdos.size() > kPdos) {
      throw std::logic_error(
          "more can be mapped than four PDOs take; declare 1600h and 1A00h, with 1400h and 1800h");
    }
    std::uint16_t number = 0;
    for (const std::vector<Row>& rows : pdos) {
      const auto in_place = [&](std::uint16_t first) {
        return static_cast<std::uint16_t>(first + number);
      };
      missing.add_pdo(
          in_place(transmits ? canopen::kTransmitPdoCommunication
                             : canopen::kReceivePdoCommunication),
          in_place(transmits ? canopen::kTransmitPdoMapping : canopen::kReceivePdoMapping),
          (transmits ? kFirstTransmitPdo : kFirstReceivePdo) + kBetweenPdos * number, transmits,
          rows);
      ++number;
    }
  }
  objects.add(rows_);
}

}  // namespace stator::product
