#include "stator/product/shell/standard_objects.hpp"

#include <algorithm>
#include <cstdint>
#include <string_view>

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
  /// The PDO with all that can be mapped in one direction, and its assignment.
  void add_process_data(std::uint16_t mapping, std::uint16_t assignment, PdoMapping direction,
                        std::string_view mapping_name, std::string_view assignment_name) {
    std::vector<Row> mapping_rows;
    for (const Entry& entry : objects_.entries()) {
      const PdoMapping allowed = entry.declaration().mapping;
      if (allowed == direction || allowed == PdoMapping::both) {
        mapping_rows.push_back({"Mapped object", hex(mapped(entry))});
      }
    }
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

}  // namespace stator::product
