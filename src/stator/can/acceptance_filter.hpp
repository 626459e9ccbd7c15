#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/can/frame.hpp"

namespace stator::can {

/// Which frames a controller takes from the bus: one bit per 11-bit identifier for data frames, as
/// the filter banks of real controllers have it, and one for all extended frames. Remote frames,
/// which are rare, always pass. Everything, to begin with.
class AcceptanceFilter {
 public:
  static constexpr std::uint32_t kIdentifiers = 2048;

  AcceptanceFilter() { accept_all(); }

  /// Counts each change of the filter in `*changes`, by which the bus notices it; null: nowhere.
  void count_changes(std::uint64_t* changes) { changes_ = changes; }

  void accept_all() {
    words_.fill(~std::uint64_t{0});
    extended_ = true;
    changed();
  }
  /// Takes no data frame until identifiers are named.
  void accept_none() {
    words_.fill(0);
    extended_ = false;
    changed();
  }
  /// Takes frames with this 11-bit identifier; higher bits are ignored.
  void accept(std::uint32_t identifier) {
    words_[(identifier % kIdentifiers) / 64] |= std::uint64_t{1} << (identifier % 64);
    changed();
  }
  void reject(std::uint32_t identifier) {
    words_[(identifier % kIdentifiers) / 64] &= ~(std::uint64_t{1} << (identifier % 64));
    changed();
  }
  void accept_extended(bool accepted) {
    extended_ = accepted;
    changed();
  }

  [[nodiscard]] bool accepts(const Frame& frame) const {
    if (frame.extended) {
      return extended_;
    }
    const std::uint32_t identifier = frame.identifier % kIdentifiers;
    return frame.remote || (words_[identifier / 64] >> (identifier % 64) & 1U) != 0;
  }

 private:
  void changed() {
    if (changes_ != nullptr) {
      ++*changes_;
    }
  }

  std::array<std::uint64_t, kIdentifiers / 64> words_{};
  bool extended_ = true;
  std::uint64_t* changes_ = nullptr;
};

}  // namespace stator::can
