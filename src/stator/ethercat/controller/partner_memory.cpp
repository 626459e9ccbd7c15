// Process memory as logic on the same chip sees it: beside bus and host, without exchanging the
// sync managers' buffers.

#include <algorithm>

#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

void SlaveController::set_memory_partner(MemoryPartner* partner) {
  partner_ = partner;
  compile_mappings();
}

void SlaveController::read_process_data(std::uint16_t address, std::span<std::byte> out) const {
  std::uint32_t at = address;
  while (!out.empty() && at < memory_.size()) {
    const Piece piece = piece_at(at, std::min(out.size(), memory_.size() - at));
    std::uint32_t from = at;
    if (piece.channel != kNoChannel) {
      const SyncManager& manager = sync_managers_[piece.channel];
      if (manager.buffered() && manager.bus_writes() && at - manager.start() < manager.length()) {
        from = manager.newest_base() + (at - manager.start());
      }
    }
    std::copy_n(memory_.begin() + from, piece.length, out.begin());
    at += static_cast<std::uint32_t>(piece.length);
    out = out.subspan(piece.length);
  }
}

void SlaveController::write_process_data(std::uint16_t address, std::span<const std::byte> data) {
  std::uint32_t at = address;
  while (!data.empty() && at >= kRegisterSpace && at < memory_.size()) {
    const Piece piece = piece_at(at, std::min(data.size(), memory_.size() - at));
    std::uint32_t copies = 1;
    std::uint32_t distance = 0;
    if (piece.channel != kNoChannel) {
      const SyncManager& manager = sync_managers_[piece.channel];
      if (manager.buffered() && !manager.bus_writes() && at - manager.start() < manager.length()) {
        // Written into all three buffers, so that the bus finds it whichever buffer it takes next.
        copies = 3;
        distance = manager.length();
      }
    }
    for (std::uint32_t copy = 0; copy < copies; ++copy) {
      std::copy_n(data.begin(), piece.length,
                  memory_.begin() + at + std::ptrdiff_t{copy} * distance);
    }
    at += static_cast<std::uint32_t>(piece.length);
    data = data.subspan(piece.length);
  }
}

void SlaveController::finish_process_data(std::uint16_t address, std::size_t length) {
  if (!register_bit(register_address::kEscConfiguration, 0)) {
    return;
  }
  for (std::size_t channel = 0; channel < configuration_.sync_manager_count; ++channel) {
    SyncManager& manager = sync_managers_[channel];
    if (!manager.active() || manager.start() >= address + length ||
        address >= std::uint32_t{manager.start()} + manager.length()) {
      continue;
    }
    if (manager.bus_writes() ? manager.begin_read(0) : manager.begin_write(0)) {
      static_cast<void>(manager.bus_writes() ? manager.end_read(manager.length())
                                             : manager.end_write(manager.length()));
      publish_sync_manager(channel);
    }
  }
}

}  // namespace stator::ethercat
