#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"

namespace stator::rack {

/// Copies what passes over the networks of a running rack for somebody who may be slow: frames wait
/// in a ring of fixed length, one that finds no room is lost and counted. Nothing is copied while
/// nobody watches: then the rack knows no tap.
class TrafficTap {
 public:
  enum class Direction : std::uint8_t {
    request,  ///< from the master
    answer,   ///< back to the master
    bus,      ///< on a wire that all share
    error,    ///< the same, destroyed by an error
  };

  /// What is known of a frame beside its bytes.
  struct Header {
    std::uint64_t number = 0;  ///< from 1, lost ones counted
    base::SimTime time;
    std::uint16_t network = 0;  ///< segments first, then buses
    std::uint16_t length = 0;   ///< bytes that follow
    Direction direction = Direction::request;
  };

  struct Record {
    Header header;
    std::vector<std::byte> bytes;
  };

  /// Room for `capacity` bytes of frames and their headers.
  explicit TrafficTap(std::size_t capacity = kDefaultCapacity) : ring_(capacity) {}

  // For whoever holds the rack.

  void put(std::uint16_t network, Direction direction, base::SimTime time,
           std::span<const std::byte> frame);
  /// As bytes of the form that decode_can() reads.
  void put(std::uint16_t network, Direction direction, base::SimTime time, const can::Frame& frame);

  // For the one thread that reads.

  [[nodiscard]] bool empty() const {
    return written_.load(std::memory_order_acquire) == read_.load(std::memory_order_relaxed);
  }
  /// Takes the oldest frame.
  [[nodiscard]] std::optional<Record> take();
  /// Throws the oldest frame away; false: there is none.
  bool skip();
  /// Frames lost because the ring was full.
  [[nodiscard]] std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

  /// The frame that put() wrote; nothing if `bytes` are none.
  [[nodiscard]] static std::optional<can::Frame> decode_can(std::span<const std::byte> bytes);

 private:
  static constexpr std::size_t kDefaultCapacity = std::size_t{1} << 21U;

  void copy_in(std::size_t at, std::span<const std::byte> bytes);
  void copy_out(std::size_t at, std::span<std::byte> bytes) const;

  std::vector<std::byte> ring_;
  std::uint64_t numbered_ = 0;  ///< of the side that puts
  // Both count bytes since the beginning.
  std::atomic<std::size_t> written_{0};
  std::atomic<std::size_t> read_{0};
  std::atomic<std::uint64_t> lost_{0};
};

}  // namespace stator::rack
