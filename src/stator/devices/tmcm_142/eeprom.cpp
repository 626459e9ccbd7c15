#include "stator/devices/tmcm_142/eeprom.hpp"

#include "stator/base/byte_order.hpp"

namespace stator::devices::tmcm_142 {

namespace {

using Memory = canopen::NonVolatileMemory;

constexpr std::size_t kCellSize = 4;
constexpr std::size_t kCommandSize = 7;

constexpr base::EventRule kForeign{
    "tmcm142-eeprom", base::Severity::warning,
    "the kept {0} do not fit this module, {1} bytes: it starts with the factory's; delete the file "
    "to get rid of this"};
constexpr base::EventRule kTriedAgain{
    "tmcm142-eeprom-retry", base::Severity::fault,
    "what the module wrote to its EEPROM could not be kept, and there is nobody whom a reply could "
    "tell: it holds until the module's end and is written again every {0} s until it is kept; see "
    "what the state directory lacks"};

}  // namespace

void Eeprom::connect(Memory& memory) {
  memory_ = &memory;
  firmware_.connect(*this);
  for (const Group group : kGroups) {
    restore(group);
    copy(group, images_[group].accepted);
    images_[group].writes = writes(group);
  }
}

tmcl::EepromKeeper::Outcome Eeprom::keep(bool refusable, base::SimTime now) {
  if (!changed()) {
    module_.accept_writes();
    return Outcome::kept;
  }
  return write(refusable, now);
}

tmcl::EepromKeeper::Outcome Eeprom::write(bool refusable, base::SimTime now) {
  refusable_ = refusable;
  retry_ = base::SimTime::never();
  std::array<Memory::GroupImage, kGroups.size()> orders;
  std::size_t count = 0;
  for (const Group group : kGroups) {
    Image& image = images_[group];
    image.ordered = image.owed || writes(group) != image.writes;
    if (image.ordered) {
      image.writes = writes(group);
      copy(group, image.wanted);
      orders[count++] = {group, image.wanted};
    }
  }
  memory_->store(std::span(orders).first(count));
  const Memory::Status status = memory_->status();
  if (status != Memory::Status::busy) {
    return end(status == Memory::Status::ready, now);
  }
  outcome_ = Outcome::busy;
  poll_ = now + kWriteTime;
  return outcome_;
}

void Eeprom::poll(base::SimTime now, base::SimTime next) {
  const Memory::Status status = memory_->status();
  if (status == Memory::Status::busy) {
    poll_ = next;
    return;
  }
  poll_ = base::SimTime::never();
  static_cast<void>(end(status == Memory::Status::ready, now));
}

tmcl::EepromKeeper::Outcome Eeprom::end(bool kept, base::SimTime now) {
  if (!kept && refusable_) {
    take_back();
    outcome_ = Outcome::failed;
  } else {
    for (Image& image : images_) {
      if (image.ordered) {
        image.accepted.swap(image.wanted);
        image.owed = !kept;
      }
    }
    module_.accept_writes();
    outcome_ = Outcome::kept;
    if (!kept && !reported_) {
      reporter_.report(now, kTriedAgain, {kRetryTime.nanoseconds() / 1'000'000'000});
    }
    reported_ = !kept;
  }
  if (images_[parameters_group].owed || images_[program_group].owed) {
    retry_ = now + kRetryTime;
  }
  return outcome_;
}

void Eeprom::take_back() {
  for (const Group group : kGroups) {
    Image& image = images_[group];
    if (image.ordered) {
      static_cast<void>(load(group, image.accepted));
      image.writes = writes(group);
    }
  }
  module_.take_back_writes();
}

void Eeprom::restore(Group group) {
  const std::span<const std::byte> image = memory_->image(group);
  if (!image.empty() && !load(group, image)) {
    const base::StaticText what =
        group == parameters_group ? base::StaticText("parameters") : base::StaticText("program");
    reporter_.report({}, kForeign, {what, image.size()});
  }
}

bool Eeprom::load(Group group, std::span<const std::byte> image) {
  return group == parameters_group ? load_parameters(image) : load_program(image);
}

void Eeprom::copy(Group group, std::vector<std::byte>& image) {
  if (group == parameters_group) {
    copy_parameters(image);
  } else {
    copy_program(image);
  }
}

bool Eeprom::load_parameters(std::span<const std::byte> image) {
  if (image.size() % kCellSize != 0) {
    return false;
  }
  cells_.resize(image.size() / kCellSize);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    cells_[i] = base::load_le<std::int32_t>(image, i * kCellSize);
  }
  return module_.load_eeprom(cells_);
}

bool Eeprom::load_program(std::span<const std::byte> image) {
  const std::size_t length = image.size() / kCommandSize;
  if (image.size() % kCommandSize != 0 || length > firmware_.memory().size()) {
    return false;
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
  return true;
}

void Eeprom::copy_parameters(std::vector<std::byte>& image) {
  cells_.clear();
  module_.append_eeprom(cells_);
  image.resize(cells_.size() * kCellSize);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    base::store_le(image, i * kCellSize, cells_[i]);
  }
}

void Eeprom::copy_program(std::vector<std::byte>& image) const {
  const tmcl::ProgramMemory& memory = firmware_.memory();
  // One at least: no image at all stands for the program as delivered.
  std::size_t length = memory.size();
  while (length > 1 && memory[length - 1] == tmcl::Instruction{}) {
    --length;
  }
  image.resize(length * kCommandSize);
  for (std::size_t i = 0; i < length; ++i) {
    const std::size_t place = i * kCommandSize;
    image[place] = std::byte{memory[i].command};
    image[place + 1] = std::byte{memory[i].type};
    image[place + 2] = std::byte{memory[i].motor};
    base::store_le(image, place + 3, memory[i].value);
  }
}

}  // namespace stator::devices::tmcm_142
