#include "stator/ethercat/units/sii_interface.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

using base::load_le;
using base::store_le;

// Bits of 0x0502.
constexpr std::uint16_t kWriteEnable = 0x0001;
constexpr std::uint16_t kEightByteRead = 0x0040;
constexpr std::uint16_t kTwoAddressBytes = 0x0080;
constexpr std::uint16_t kCommandMask = 0x0700;
constexpr std::uint16_t kChecksumError = 0x0800;
constexpr std::uint16_t kNotLoaded = 0x1000;
constexpr std::uint16_t kCommandError = 0x2000;
constexpr std::uint16_t kWriteEnableError = 0x4000;
constexpr std::uint16_t kBusy = 0x8000;

constexpr std::size_t kSmallestEeprom = 128;
/// Largest EEPROM that takes one address byte (16 kbit).
constexpr std::size_t kOneAddressByte = 2048;

}  // namespace

std::uint8_t sii_checksum(std::span<const std::byte> image) {
  unsigned crc = 0xFF;
  for (const std::byte byte : image.first(14)) {
    crc ^= std::to_integer<unsigned>(byte);
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x80) != 0 ? (crc << 1 ^ 0x07) & 0xFF : crc << 1;
    }
  }
  return static_cast<std::uint8_t>(crc);
}

void SiiInterface::insert(std::span<const std::byte> image) {
  content_.clear();
  write_ = {};
  if (image.empty()) {
    return;
  }
  content_.assign(std::bit_ceil(std::max(image.size(), kSmallestEeprom)), std::byte{0xFF});
  std::copy(image.begin(), image.end(), content_.begin());
}

void SiiInterface::corrupt(std::size_t offset, std::uint8_t mask) {
  std::erase_if(worn_, [offset](const WornCell& worn) { return worn.offset == offset; });
  if (mask != 0) {
    worn_.push_back({offset, std::byte{mask}});
  }
}

std::byte SiiInterface::cell(std::size_t offset) const {
  std::byte value = content_[offset];
  for (const WornCell& worn : worn_) {
    if (worn.offset == offset) {
      value ^= worn.mask;
    }
  }
  return value;
}

std::array<std::byte, SiiInterface::kConfigurationAreaLength> SiiInterface::configuration_area()
    const {
  std::array<std::byte, kConfigurationAreaLength> area{};
  for (std::size_t i = 0; i < area.size(); ++i) {
    area[i] = cell(i);
  }
  return area;
}

SiiInterface::LoadResult SiiInterface::load() {
  if (content_.empty()) {
    set_status(kChecksumError, kNotLoaded);
    return LoadResult::no_eeprom;
  }
  const auto area = configuration_area();
  if (std::to_integer<std::uint8_t>(area[14]) != sii_checksum(area)) {
    set_status(0, kChecksumError | kNotLoaded);
    return LoadResult::bad_checksum;
  }
  set_status(kChecksumError | kNotLoaded, 0);
  return LoadResult::loaded;
}

void SiiInterface::reset() {
  if (write_.under_way && write_.kept) {
    if (keeper_ != nullptr) {
      settle_write();
    }
    write_.under_way = false;  // else the transfer was cut short
  }
  deadline_ = base::SimTime::never();
  command_ = Command::idle;
  refresh_status();
}

bool SiiInterface::host_owns() const {
  return (registers_[kSiiHostAccess] & std::byte{1}) != std::byte{0};
}

bool SiiInterface::host_may_take() const {
  return (registers_[kSiiOwner] & std::byte{3}) == std::byte{1};
}

void SiiInterface::update_owner() {
  if ((registers_[kSiiOwner] & std::byte{2}) != std::byte{0}) {
    registers_[kSiiHostAccess] = std::byte{0};
  }
  refresh_status();
}

SiiInterface::CommandResult SiiInterface::start_command(base::SimTime now) {
  const auto status = load_le<std::uint16_t>(registers_, kSiiControl);
  const auto command = static_cast<Command>((status & kCommandMask) >> 8);
  set_status(kCommandMask, 0);
  if (error_blocks_commands_ && (status & kCommandError) != 0 && command != Command::idle) {
    return CommandResult::error_pending;
  }
  base::SimDuration duration;
  switch (command) {
    case Command::idle:
      set_status(kCommandError | kWriteEnableError, 0);
      return CommandResult::idle;
    case Command::read:
      duration = timing_.read;
      break;
    case Command::write:
      if ((status & kWriteEnable) == 0) {
        set_status(kCommandError, kWriteEnableError);
        return CommandResult::not_write_enabled;
      }
      duration = timing_.write;
      break;
    case Command::reload:
      duration = timing_.reload;
      break;
    default:
      set_status(kWriteEnableError, kCommandError);
      return CommandResult::invalid;
  }
  if (content_.empty() || write_.under_way) {
    set_status(kWriteEnableError, kCommandError);
    return content_.empty() ? CommandResult::no_acknowledge : CommandResult::still_writing;
  }
  command_ = command;
  deadline_ = now + duration;
  if (command == Command::write) {
    begin_write(now);
  }
  set_status(kCommandError | kWriteEnableError,
             static_cast<std::uint16_t>(kBusy | (status & kCommandMask)));
  return CommandResult::started;
}

void SiiInterface::start_of_frame() {
  if (!host_owns()) {
    set_status(kWriteEnable, 0);
  }
}

SiiInterface::Completion SiiInterface::finish(base::SimTime now) {
  if (now < deadline_) {
    return Completion::nothing;
  }
  switch (command_) {
    case Command::read:
      end_access();
      read_words();
      return Completion::access;
    case Command::write:
      return end_write(now);
    case Command::reload:
      end_access();
      return Completion::reload;
    case Command::idle:
      break;
  }
  deadline_ = base::SimTime::never();
  return Completion::nothing;
}

void SiiInterface::end_access() {
  deadline_ = base::SimTime::never();
  command_ = Command::idle;
  set_status(kBusy | kCommandMask, 0);
}

void SiiInterface::begin_write(base::SimTime now) {
  write_ = {.offset = byte_address(),
            .word = {registers_[kSiiData], registers_[kSiiData + 1]},
            .under_way = true,
            .kept = true,
            .time_out = now + kLongestWrite};
  if (keeper_ == nullptr) {
    return;
  }
  // The keeper gets the content with the word; the cell itself shows the word once it is kept.
  const auto cell = std::span(content_).subspan(write_.offset).first<2>();
  const std::array before{cell[0], cell[1]};
  std::ranges::copy(write_.word, cell.begin());
  write_.kept.reset();
  if (keeper_->keep_sii(content_)) {
    write_.kept = true;
  }
  std::ranges::copy(before, cell.begin());
}

SiiInterface::Completion SiiInterface::end_write(base::SimTime now) {
  if (!write_.kept && now < write_.time_out) {
    deadline_ = write_.time_out;  // or when finish_write() comes
    return Completion::nothing;
  }
  end_access();
  if (!write_.kept) {
    set_status(0, kCommandError);
    return Completion::given_up;
  }
  settle_write();
  if (!*write_.kept) {
    set_status(0, kCommandError);
  }
  return Completion::access;
}

/// Ends the write: the word goes into its cell if it was kept, else the cell stays as it is.
void SiiInterface::settle_write() {
  write_.under_way = false;
  if (*write_.kept) {
    std::ranges::copy(write_.word, content_.begin() + static_cast<std::ptrdiff_t>(write_.offset));
  }
}

void SiiInterface::finish_write(bool kept, base::SimTime now) {
  if (!write_.under_way || write_.kept) {
    return;
  }
  write_.kept = kept;
  if (command_ != Command::write) {
    settle_write();  // a reset or the time-out has ended the access
  } else if (deadline_ == write_.time_out) {
    static_cast<void>(end_write(now));
  }
}

void SiiInterface::refresh_status() {
  std::uint16_t shown = host_owns() ? kWriteEnable : 0;
  if (eight_byte_read_) {
    shown |= kEightByteRead;
  }
  if (content_.size() > kOneAddressByte) {
    shown |= kTwoAddressBytes;
  }
  set_status(kWriteEnable | kEightByteRead | kTwoAddressBytes, shown);
}

void SiiInterface::set_status(std::uint16_t clear, std::uint16_t set) {
  const unsigned status = load_le<std::uint16_t>(registers_, kSiiControl);
  store_le(registers_, kSiiControl, static_cast<std::uint16_t>((status & ~unsigned{clear}) | set));
}

std::size_t SiiInterface::byte_address() const {
  // The EEPROM decodes only as many address bits as it has words; higher addresses repeat.
  const std::size_t word = load_le<std::uint32_t>(registers_, kSiiAddress);
  return word * 2 & (content_.size() - 1);
}

void SiiInterface::read_words() {
  const std::size_t wanted = eight_byte_read_ ? 8 : 4;
  store_le(registers_, kSiiData, std::uint64_t{0});
  const std::size_t from = byte_address();
  for (std::size_t i = 0; i < wanted; ++i) {
    registers_[kSiiData + i] = cell((from + i) & (content_.size() - 1));
  }
}

}  // namespace stator::ethercat
