#include "stator/devices/tmc8461/mfc_spi_memory.hpp"

#include <algorithm>

namespace stator::devices::tmc8461 {

std::array<std::byte, 3> MfcSpiMemory::header_reply() const {
  const std::uint32_t events = shared_bus_ ? controller_.al_event_request() : 0U;
  return {static_cast<std::byte>(events), static_cast<std::byte>(events >> 8U),
          static_cast<std::byte>(events >> 16U)};
}

void MfcSpiMemory::read(std::uint16_t address, std::span<std::byte> out) {
  if (kept_length_ != 0 && address == kept_address_) {
    const std::size_t known = std::min(out.size(), kept_length_);
    std::copy_n(kept_.end() - static_cast<std::ptrdiff_t>(kept_length_), known, out.begin());
    out = out.subspan(known);
    address = static_cast<std::uint16_t>(address + known);
    kept_length_ -= known;
    kept_address_ = address;
  }
  if (out.empty()) {
    return;
  }
  const std::size_t end = (address + out.size()) % kSlot;
  const std::size_t rest = end == 0 ? 0 : kSlot - end;
  const std::size_t whole = out.size() - (end == 0 ? 0 : std::min(end, out.size()));
  if (whole != 0) {
    block_.read(address, out.first(whole));
  }
  kept_length_ = 0;
  if (rest == 0) {
    return;
  }
  // The last register begins here or before; all that follows of it is fetched at the same moment.
  const std::size_t begun = out.size() - whole;
  const auto at = static_cast<std::uint16_t>(address + whole);
  const std::span<std::byte> fetched = std::span(kept_).last(begun + rest);
  block_.read(at, fetched);
  std::copy_n(fetched.begin(), begun, out.begin() + static_cast<std::ptrdiff_t>(whole));
  kept_length_ = rest;
  kept_address_ = static_cast<std::uint16_t>(at + begun);
}

void MfcSpiMemory::write(std::uint16_t address, std::span<const std::byte> data) {
  kept_length_ = 0;
  block_.write(address, data);
}

}  // namespace stator::devices::tmc8461
