#include "stator/ethercat/controller/spi_slave_port.hpp"

#include <algorithm>

namespace stator::ethercat {

namespace {

constexpr std::byte kTermination{0xFF};
constexpr std::size_t kAddressSpace = 0x10000;

}  // namespace

void SpiSlavePort::select() {
  header_reply_ = memory_.header_reply();
  phase_ = memory_.operational() ? Phase::first : Phase::closed;
  address_ = 0;
  command_ = 0;
  error_ = 0;
  extended_ = false;
  data_started_ = false;
  terminated_ = false;
  reserved_command_ = false;
}

void SpiSlavePort::exchange(std::span<const std::byte> mosi, std::span<std::byte> miso,
                            const SpiTiming& timing) {
  select();
  transfer(mosi, miso, timing.read_pause);
  deselect(timing.surplus_clocks);
}

void SpiSlavePort::transfer(std::span<const std::byte> mosi, std::span<std::byte> miso,
                            std::optional<base::SimDuration> read_pause) {
  std::fill(miso.begin(), miso.end(), kUndefined);
  std::size_t at = 0;
  while (at < mosi.size()) {
    switch (phase_) {
      case Phase::first:
      case Phase::second:
      case Phase::extension:
        miso[at] = take_header(mosi[at]);
        ++at;
        break;
      case Phase::wait_state:
        phase_ = Phase::read;
        ++at;
        break;
      case Phase::read:
        // Data in a piece of its own: the host was busy elsewhere in between.
        read(mosi.subspan(at), miso.subspan(at), at != 0 ? read_pause : std::nullopt);
        return;
      case Phase::write:
        write(mosi.subspan(at));
        return;
      case Phase::idle:
      case Phase::nothing:
      case Phase::closed:
        return;
    }
  }
}

void SpiSlavePort::deselect(unsigned surplus_clocks) {
  const bool listened = phase_ != Phase::idle && phase_ != Phase::closed;
  const bool in_read = phase_ == Phase::read || phase_ == Phase::wait_state;
  phase_ = Phase::idle;
  if (!listened) {
    return;
  }
  error_ = static_cast<std::uint8_t>(error_ | (surplus_clocks & spi_error::kClocks));
  if (in_read && !terminated_) {
    error_ |= spi_error::kTerminationMissing;
  }
  if (error_ != 0 || reserved_command_) {
    const unsigned command = static_cast<unsigned>(command_ >> 1U) << spi_error::kCommandShift;
    memory_.count_error(static_cast<std::uint8_t>(error_ | command));
  }
}

// Header bytes: A[12:5]; A[4:0] C[2:0]; with address extension A[15:13] C[2:0] 00 (L1003-L1027).
std::byte SpiSlavePort::take_header(std::byte byte) {
  const auto bits = std::to_integer<unsigned>(byte);
  switch (phase_) {
    case Phase::first:
      address_ = static_cast<std::uint16_t>(bits << 5U);
      phase_ = Phase::second;
      return header_reply_[0];
    case Phase::second:
      address_ = static_cast<std::uint16_t>(address_ | bits >> 3U);
      take_command(bits & 7U);
      return header_reply_[1];
    default:
      break;
  }
  address_ = static_cast<std::uint16_t>((address_ & 0x1FFFU) | (bits >> 5U) << 13U);
  take_command(bits >> 2U & 7U);
  const bool repeated = extended_;
  extended_ = true;
  return repeated ? kUndefined : header_reply_[2];
}

void SpiSlavePort::take_command(unsigned command) {
  command_ = static_cast<std::uint8_t>(command);
  switch (command) {
    case Command::kNop:
      phase_ = Phase::nothing;
      memory_.touch();
      break;
    case Command::kRead:
      phase_ = Phase::read;
      break;
    case Command::kReadWithWaitState:
      phase_ = Phase::wait_state;
      break;
    case Command::kWrite:
      phase_ = Phase::write;
      break;
    case Command::kAddressExtension:
      phase_ = Phase::extension;
      break;
    default:
      phase_ = Phase::nothing;
      reserved_command_ = true;
      break;
  }
}

void SpiSlavePort::read(std::span<const std::byte> mosi, std::span<std::byte> miso,
                        std::optional<base::SimDuration> pause) {
  if (terminated_) {
    error_ |= spi_error::kContinued;
    return;
  }
  const auto last = std::ranges::find(mosi, kTermination);
  terminated_ = last != mosi.end();
  const auto length = static_cast<std::size_t>(last - mosi.begin()) + (terminated_ ? 1 : 0);
  if (length < mosi.size()) {
    error_ |= spi_error::kContinued;
  }
  read_memory(miso.first(length));
  const bool early = command_ == Command::kRead && !data_started_ && pause && *pause < kReadPause;
  if (early) {
    error_ |= spi_error::kBusy;
    miso.front() = kUndefined;
  }
  data_started_ = true;
}

void SpiSlavePort::read_memory(std::span<std::byte> out) {
  while (!out.empty()) {
    const std::size_t length = std::min(out.size(), kAddressSpace - address_);
    memory_.read(address_, out.first(length));
    address_ = static_cast<std::uint16_t>(address_ + length);
    out = out.subspan(length);
  }
}

void SpiSlavePort::write(std::span<const std::byte> data) {
  while (!data.empty()) {
    const std::size_t length = std::min(data.size(), kAddressSpace - address_);
    memory_.write(address_, data.first(length));
    address_ = static_cast<std::uint16_t>(address_ + length);
    data = data.subspan(length);
  }
}

}  // namespace stator::ethercat
