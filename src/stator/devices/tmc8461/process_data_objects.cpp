#include "stator/devices/tmc8461/process_data_objects.hpp"

#include <cstdint>
#include <stdexcept>

namespace stator::devices::tmc8461 {

namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::EntryDeclaration;
using dictionary::ObjectCode;
using dictionary::PdoMapping;

/// Objects of one direction, in the places the modular device profile gives them (ETG.5001).
struct Direction {
  std::uint16_t values;
  std::uint16_t mapping;
  std::uint16_t assignment;
  PdoMapping way;
  const char* name;
  const char* mapping_name;
  const char* assignment_name;
};
constexpr Direction kOutputs{0x7000,    0x1600,    0x1C12,        PdoMapping::receive,
                             "Outputs", "Outputs", "RxPDO assign"};
constexpr Direction kInputs{0x6000,   0x1A00,   0x1C13,        PdoMapping::transmit,
                            "Inputs", "Inputs", "TxPDO assign"};

EntryDeclaration entry(std::uint16_t index, std::size_t subindex, std::string_view name,
                       DataType type, std::uint64_t value) {
  EntryDeclaration declaration;
  declaration.index = index;
  declaration.subindex = static_cast<std::uint8_t>(subindex);
  declaration.name = name;
  declaration.object_code = ObjectCode::record;
  declaration.type = type;
  declaration.access = Access::read_only;
  declaration.default_value = dictionary::Default(value);
  return declaration;
}

}  // namespace

ProcessDataObjects::ProcessDataObjects(std::size_t output_bytes, std::size_t input_bytes) {
  if (output_bytes > kMaximumBytes || input_bytes > kMaximumBytes) {
    throw std::logic_error("process data of a TMC8461: more than 128 bytes in one direction");
  }
  names_.reserve(kMaximumBytes);
  for (std::size_t i = 0; i < kMaximumBytes; ++i) {
    names_.push_back("Byte " + std::to_string(i));
  }
  declare(output_bytes, true);
  declare(input_bytes, false);
  dictionary_.add(declarations_);
  dictionary_.finish();
}

void ProcessDataObjects::declare(std::size_t bytes, bool outputs) {
  if (bytes == 0) {
    return;
  }
  const Direction& direction = outputs ? kOutputs : kInputs;
  const auto count = [&](std::uint16_t index, const char* name, std::size_t number) {
    EntryDeclaration head =
        entry(index, 0, "Number of entries", DataType::unsigned8, std::uint64_t{number});
    head.object_name = name;
    declarations_.push_back(head);
  };
  count(direction.assignment, direction.assignment_name, 1);
  declarations_.push_back(
      entry(direction.assignment, 1, "PDO", DataType::unsigned16, direction.mapping));
  count(direction.mapping, direction.mapping_name, bytes);
  for (std::size_t i = 1; i <= bytes; ++i) {
    const std::uint64_t mapped = std::uint64_t{direction.values} << 16U | i << 8U | 8U;
    declarations_.push_back(
        entry(direction.mapping, i, names_[i - 1], DataType::unsigned32, mapped));
  }
  count(direction.values, direction.name, bytes);
  for (std::size_t i = 1; i <= bytes; ++i) {
    EntryDeclaration value =
        entry(direction.values, i, names_[i - 1], DataType::unsigned8, std::uint64_t{0});
    value.mapping = direction.way;
    declarations_.push_back(value);
  }
}

}  // namespace stator::devices::tmc8461
