#include "devices/tmcm_142/eeprom.hpp"

#include <span>

#include "base/byte_order.hpp"

namespace stator::devices::tmcm_142 {

namespace {

constexpr std::uint8_t kParameters = 0;
constexpr std::uint8_t kProgram = 1;
constexpr std::size_t kCellSize = 4;
constexpr std::size_t kCommandSize = 7;

constexpr base::EventRule kForeign{
    "tmcm142-eeprom", base::Severity::warning,
    "the kept {0} do not fit this module, {1} bytes: it starts with the factory's; delete the file "
    "to get rid of this"};

}  // namespace

void Eeprom::connect(canopen::NonVolatileMemory& memory) {
  memory_ = &memory;
  restore_parameters();
  restore_program();
  parameter_writes_ = module_.eeprom_write_count();
  program_writes_ = firmware_.memory().write_count();
}

void Eeprom::restore_parameters() {
  const std::span<const std::byte> image = memory_->image(kParameters);
  if (image.empty()) {
    return;
  }
  std::vector<std::int32_t> cells(image.size() / kCellSize);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i] = base::load_le<std::int32_t>(image, i * kCellSize);
  }
  if (image.size() % kCellSize != 0 || !module_.load_eeprom(cells)) {
    reporter_.report({}, kForeign, {"parameters", image.size()});
  }
}

void Eeprom::restore_program() {
  const std::span<const std::byte> image = memory_->image(kProgram);
  const std::size_t length = image.size() / kCommandSize;
  if (image.empty()) {
    return;
  }
  if (image.size() % kCommandSize != 0 || length > firmware_.memory().size()) {
    reporter_.report({}, kForeign, {"program", image.size()});
    return;
  }
  std::vector<tmcl::Instruction> program(length);
  for (std::size_t i = 0; i < length; ++i) {
    const std::size_t place = i * kCommandSize;
    program[i] = {.command = static_cast<std::uint8_t>(image[place]),
                  .type = static_cast<std::uint8_t>(image[place + 1]),
                  .motor = static_cast<std::uint8_t>(image[place + 2]),
                  .value = base::load_le<std::int32_t>(image, place + 3)};
  }
  firmware_.load_program(program);
}

void Eeprom::hand_on() {
  if (memory_ == nullptr) {
    return;
  }
  if (const std::uint64_t writes = module_.eeprom_write_count(); writes != parameter_writes_) {
    parameter_writes_ = writes;
    cells_.clear();
    module_.append_eeprom(cells_);
    image_.resize(cells_.size() * kCellSize);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      base::store_le(image_, i * kCellSize, cells_[i]);
    }
    memory_->store(kParameters, image_);
  }
  const tmcl::ProgramMemory& memory = firmware_.memory();
  if (memory.write_count() != program_writes_) {
    program_writes_ = memory.write_count();
    std::size_t length = memory.size();
    while (length > 0 && memory[length - 1] == tmcl::Instruction{}) {
      --length;
    }
    image_.resize(length * kCommandSize);
    for (std::size_t i = 0; i < length; ++i) {
      const std::size_t place = i * kCommandSize;
      image_[place] = std::byte{memory[i].command};
      image_[place + 1] = std::byte{memory[i].type};
      image_[place + 2] = std::byte{memory[i].motor};
      base::store_le(image_, place + 3, memory[i].value);
    }
    memory_->store(kProgram, image_);
  }
}

}  // namespace stator::devices::tmcm_142
