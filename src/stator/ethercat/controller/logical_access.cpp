// Logical commands: FMMUs and what they lead to. Mappings of whole bytes to a buffered sync manager
// or to plain memory are compiled when registers change and executed by moving bytes; everything
// else takes the bitwise path.

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

/// Adds to a working counter what a successful read and a successful write count in `command`.
void count_access(DatagramView& datagram, bool read, bool written) {
  const unsigned write_count = datagram.command == Command::lrw ? 2U : 1U;
  const unsigned sum = (read ? 1U : 0U) + (written ? write_count : 0U);
  datagram.working_counter = static_cast<std::uint16_t>(datagram.working_counter + sum);
}

/// The part of a mapping that lies in a datagram; both must overlap.
struct Overlap {
  Overlap(const DirectMapping& mapping, std::uint32_t first, std::uint32_t last)
      : area_offset(mapping.area_offset + std::max(first, mapping.first) - mapping.first),
        in_datagram(std::max(first, mapping.first) - first),
        length(std::min(last, mapping.last) - std::max(first, mapping.first) + 1) {}

  std::uint32_t area_offset;  ///< in the sync manager's area, or behind the mapping's memory
  std::uint32_t in_datagram;
  std::uint32_t length;
};

std::uint32_t last_address(const DatagramView& datagram) {
  const std::uint32_t last = datagram.address + (datagram.length - 1U);
  return last < datagram.address ? 0xFFFFFFFF : last;
}

bool overlaps(const DirectMapping& mapping, std::uint32_t first, std::uint32_t last) {
  return mapping.first <= last && mapping.last >= first;
}

/// memcpy for the few bytes of process data: two overlapping moves of a fixed size need neither a
/// call nor a loop.
void move_bytes(std::byte* to, const std::byte* from, std::size_t count) {
  const auto move_ends = [&]<std::size_t size>(std::integral_constant<std::size_t, size>) {
    std::array<std::byte, size> head{};
    std::array<std::byte, size> tail{};
    std::memcpy(head.data(), from, size);
    std::memcpy(tail.data(), from + count - size, size);
    std::memcpy(to, head.data(), size);
    std::memcpy(to + count - size, tail.data(), size);
  };
  if (count > 64) {
    std::memcpy(to, from, count);
  } else if (count >= 32) {
    move_ends(std::integral_constant<std::size_t, 32>());
  } else if (count >= 16) {
    move_ends(std::integral_constant<std::size_t, 16>());
  } else if (count >= 8) {
    move_ends(std::integral_constant<std::size_t, 8>());
  } else if (count >= 4) {
    move_ends(std::integral_constant<std::size_t, 4>());
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      to[i] = from[i];
    }
  }
}

/// Moves bytes of a frame into the writer's buffer; false if the sync manager refuses.
bool write_buffer(SyncManager& manager, std::byte* memory, const Overlap& part,
                  const std::byte* from) {
  if (!manager.begin_write(part.area_offset)) {
    return false;
  }
  move_bytes(memory + manager.write_base() + part.area_offset, from, part.length);
  return true;
}

/// Moves bytes of the reader's buffer into a frame; false if the sync manager refuses.
bool read_buffer(SyncManager& manager, const std::byte* memory, const Overlap& part,
                 std::byte* to) {
  if (!manager.begin_read(part.area_offset)) {
    return false;
  }
  move_bytes(to, memory + manager.read_base() + part.area_offset, part.length);
  return true;
}

}  // namespace

void SlaveController::process_logical(DatagramView& datagram) {
  const std::uint32_t first = datagram.address;
  const std::uint32_t last = last_address(datagram);
  const bool reads = datagram.command != Command::lwr;
  const bool writes = datagram.command != Command::lrd;
  if (!direct_only_) {
    process_logical_bitwise(datagram, reads, writes);
    return;
  }
  // Writing first takes the master's data out of the frame before the slave's own replace them;
  // direct mappings never read what another one writes.
  bool written = false;
  if (writes) {
    for (const DirectMapping& mapping : std::span(write_mappings_).first(write_mapping_count_)) {
      if (!overlaps(mapping, first, last)) {
        continue;
      }
      const Overlap part(mapping, first, last);
      SyncManager& manager = sync_managers_[mapping.channel];
      if (!write_buffer(manager, memory_.data(), part, datagram.data + part.in_datagram)) {
        continue;
      }
      if (manager.end_write(part.area_offset + part.length) && manager.triggers_watchdog()) {
        trigger_process_data_watchdog();
      }
      publish_sync_manager(mapping.channel);
      written = true;
    }
  }
  bool read = false;
  if (reads) {
    for (const DirectMapping& mapping : std::span(read_mappings_).first(read_mapping_count_)) {
      if (!overlaps(mapping, first, last)) {
        continue;
      }
      const Overlap part(mapping, first, last);
      std::byte* const to = datagram.data + part.in_datagram;
      if (mapping.channel == DirectMapping::kNoChannel) {
        move_bytes(to, memory_.data() + mapping.memory + part.area_offset, part.length);
        read = true;
        continue;
      }
      SyncManager& manager = sync_managers_[mapping.channel];
      if (!read_buffer(manager, memory_.data(), part, to)) {
        continue;
      }
      static_cast<void>(manager.end_read(part.area_offset + part.length));
      publish_sync_manager(mapping.channel);
      read = true;
    }
  }
  count_access(datagram, read, written);
}

void SlaveController::process_logical_bitwise(DatagramView& datagram, bool reads, bool writes) {
  // A mapping of `length` logical bytes touches at most one physical byte more.
  // NOLINTBEGIN(cppcoreguidelines-pro-type-member-init): too long to clear for each datagram
  std::array<std::byte, 0x800> incoming;
  std::array<std::byte, 0x800 + 1> physical;
  // NOLINTEND(cppcoreguidelines-pro-type-member-init)
  std::copy_n(datagram.data, datagram.length, incoming.begin());
  const std::uint64_t datagram_first = std::uint64_t{datagram.address} * 8;
  const std::uint64_t datagram_end = datagram_first + std::uint64_t{datagram.length} * 8;
  bool read = false;
  bool written = false;
  const auto visit = [&](const Fmmu& fmmu, bool for_write) {
    const std::uint64_t first = std::max(fmmu.first_bit(), datagram_first);
    const std::uint64_t end = std::min(fmmu.end_bit(), datagram_end);
    if (first >= end) {
      return;
    }
    const std::uint64_t from = std::uint64_t{fmmu.physical_start} * 8 + fmmu.physical_start_bit +
                               (first - fmmu.first_bit());
    const auto address = static_cast<std::uint32_t>(from / 8);
    const std::size_t shift = from % 8;
    const std::size_t bits = end - first;
    const std::size_t position = first - datagram_first;
    const std::span<std::byte> bytes = std::span(physical).first((shift + bits + 7) / 8);
    // Bytes that are refused keep what is in the frame.
    copy_bits(bytes.data(), shift, incoming.data(), position, bits);
    if (for_write) {
      const auto first_mask = static_cast<std::uint8_t>(0xFFU << shift);
      const auto last_mask = static_cast<std::uint8_t>(0xFFU >> (7 - (shift + bits - 1) % 8));
      written |= write_memory(Side::bus, address, bytes, first_mask, last_mask);
    } else if (read_memory(Side::bus, address, bytes)) {
      copy_bits(datagram.data, position, bytes.data(), shift, bits);
      read = true;
    }
  };
  const std::span<const Fmmu> active = std::span(fmmus_).first(fmmu_count_);
  for (const Fmmu& fmmu : active) {
    if (reads && fmmu.reads) {
      visit(fmmu, false);
    }
  }
  for (const Fmmu& fmmu : active) {
    if (writes && fmmu.writes) {
      visit(fmmu, true);
    }
  }
  count_access(datagram, read, written);
}

void SlaveController::compile_mappings() {
  fmmu_count_ = 0;
  write_mapping_count_ = 0;
  read_mapping_count_ = 0;
  logical_first_ = 0xFFFFFFFF;
  logical_last_ = 0;
  // A memory partner is told of each access, which the direct path does not do.
  direct_only_ = loaded_ && !register_bit(kEscWriteProtection, 0) && partner_ == nullptr;
  for (std::size_t i = 0; i < configuration_.fmmu_count; ++i) {
    const auto fmmu = Fmmu::decode(
        registers().subspan(kFmmus + i * Fmmu::kRegisterLength).first<Fmmu::kRegisterLength>());
    if (!fmmu) {
      continue;
    }
    fmmus_[fmmu_count_++] = *fmmu;
    const std::uint64_t last = std::min<std::uint64_t>((fmmu->end_bit() - 1) / 8, 0xFFFFFFFF);
    logical_first_ = std::min(logical_first_, fmmu->logical_start);
    logical_last_ = std::max(logical_last_, static_cast<std::uint32_t>(last));
    if (!compile_mapping(*fmmu)) {
      direct_only_ = false;
    }
  }
}

bool SlaveController::compile_mapping(const Fmmu& fmmu) {
  const std::uint32_t from = fmmu.physical_start;
  const std::uint64_t last = std::uint64_t{fmmu.logical_start} + fmmu.length - 1;
  if (!fmmu.byte_aligned() || fmmu.reads == fmmu.writes || last > 0xFFFFFFFF ||
      from + fmmu.length > memory_.size()) {
    return false;
  }
  DirectMapping mapping;
  mapping.first = fmmu.logical_start;
  mapping.last = static_cast<std::uint32_t>(last);
  mapping.memory = from;
  if (from < kRegisterSpace) {
    for (std::uint32_t at = from; at < from + fmmu.length; ++at) {
      if (at >= kRegisterSpace || !register_map_[at].bus_reads ||
          any_of(set_of(register_map_[at].effect), kBusReads)) {
        return false;
      }
    }
  } else {
    const Piece piece = piece_at(from, fmmu.length);
    if (piece.length != fmmu.length) {
      return false;
    }
    if (piece.channel != kNoChannel) {
      const SyncManager& manager = sync_managers_[piece.channel];
      const bool inside = from - manager.start() < manager.length();
      // The direct path takes no time stamps.
      const bool stamped = (activations_[piece.channel] & kLatchBusEvents) != 0;
      if (!manager.active() || !manager.buffered() || !inside || stamped ||
          manager.bus_writes() != fmmu.writes) {
        return false;
      }
      mapping.channel = static_cast<std::uint8_t>(piece.channel);
      mapping.area_offset = static_cast<std::uint16_t>(from - manager.start());
    }
  }
  if (fmmu.reads) {
    read_mappings_[read_mapping_count_++] = mapping;
  } else if (mapping.channel != DirectMapping::kNoChannel) {
    write_mappings_[write_mapping_count_++] = mapping;
  } else {
    return false;
  }
  return true;
}

}  // namespace stator::ethercat
