#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// The file of a recorded session (docs/how-to/record-and-replay.md): kMagic, then chunks. A chunk
// is the length of its content and the CRC-32 of that, four bytes each, little-endian, and the
// content. The first chunk is the header, those that follow have steps in the order in which they
// were taken; no step goes beyond its chunk. A file that ends anywhere is good up to its last whole
// chunk.

namespace stator::replay {

inline constexpr std::string_view kMagic = "StatorRn";
inline constexpr std::uint64_t kFormatVersion = 4;
/// From which on the places of programs on CAN buses are steps; before, each bus has those of the
/// rack's configuration all the time.
inline constexpr std::uint64_t kVersionWithPorts = 4;
/// Readable as well. Version 2 has no steps of a chip's host and of EoE; such racks were refused.
/// Version 1 has no steps of completions either: what devices ordered to be kept was kept at once.
inline constexpr std::uint64_t kOldestVersion = 1;
inline constexpr std::size_t kChunkHead = 8;
inline constexpr std::size_t kMaximumHeader = std::size_t{256} << 20U;
inline constexpr std::size_t kMaximumChunk = std::size_t{256} << 10U;
/// Of a frame, of bytes of a serial line, of an object's value.
inline constexpr std::size_t kMaximumBytes = std::size_t{64} << 10U;

/// What a step is. Numbers are those of the file.
enum class StepKind : std::uint8_t {
  advance = 1,
  frame_comes = 2,
  frame_leaves = 3,
  bus_events = 4,
  carrier = 5,
  can_frame_comes = 6,
  can_frame_leaves = 7,
  ports_replaced = 8,
  bytes_come = 9,
  bytes_leave = 10,
  event = 11,
  object_read = 12,
  object_written = 13,
  signals = 14,  ///< those that have changed since the step of this kind before
  mark = 15,
  end = 16,
  release = 17,
  fault = 18,
  fault_cleared = 19,
  completion = 20,  ///< of an order to keep something
  host_select = 21,
  host_transfer = 22,
  host_answers = 23,
  host_deselect = 24,
  host_pin = 25,
  eoe_frame_comes = 26,
  eoe_frame_leaves = 27,
  port_opened = 28,  ///< a program's place on a CAN bus
  port_closed = 29,
};

/// What a recording begins with: all that is needed to build the rack again.
struct RecordingHeader {
  using Texts = std::vector<std::pair<std::string, std::string>>;

  std::uint64_t version = kFormatVersion;   ///< of the format
  std::string program{};                    ///< version that recorded it
  Texts options{};                          ///< of whoever built the rack, by name
  Texts files{};                            ///< content by path, of rack file, images, kept files
  std::vector<std::string> signal_names{};  ///< in the order of their numbers in steps

  /// Of the first option of this name; empty: there is none.
  [[nodiscard]] std::string_view option(std::string_view name) const;
};

[[nodiscard]] std::vector<std::byte> encode(const RecordingHeader& header);
/// False: this is no header of a version from kOldestVersion to kFormatVersion; `version` then
/// tells which it is, 0: none at all.
[[nodiscard]] bool decode(const std::vector<std::byte>& bytes, RecordingHeader& header,
                          std::uint64_t& version);

}  // namespace stator::replay
