#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/sim_time.hpp"

namespace stator::board {

/// The cells of a serial EEPROM: pages that are written as a whole, one at a time.
class MemoryArray {
 public:
  /// `size` and `page` are powers of two.
  MemoryArray(std::size_t size, std::size_t page, base::SimDuration write_time)
      : cells_(size, std::uint8_t{0xFF}), buffer_(page), loaded_(page), write_time_(write_time) {}

  [[nodiscard]] std::uint8_t read(std::size_t address) const {
    return cells_[address & (cells_.size() - 1)];
  }
  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  [[nodiscard]] bool busy(base::SimTime now) const { return now < ready_at_; }
  [[nodiscard]] std::uint64_t writes() const { return writes_; }

  /// Bytes go into the page buffer from here; an address beyond the page begins it anew.
  void begin_page(std::size_t address) {
    address_ = address & (cells_.size() - 1);
    std::fill(loaded_.begin(), loaded_.end(), false);
    any_ = false;
  }
  void load(std::uint8_t data) {
    const std::size_t within = address_ & (buffer_.size() - 1);
    buffer_[within] = data;
    loaded_[within] = true;
    any_ = true;
    address_ = (address_ & ~(buffer_.size() - 1)) | ((within + 1) & (buffer_.size() - 1));
  }
  /// Whether anything waits in the buffer.
  [[nodiscard]] bool loaded() const { return any_; }
  /// Writes the loaded bytes; the array is busy until then.
  void program(base::SimTime now) {
    const std::size_t page = address_ & ~(buffer_.size() - 1);
    for (std::size_t k = 0; k < buffer_.size(); ++k) {
      if (loaded_[k]) {
        cells_[page + k] = buffer_[k];
      }
    }
    any_ = false;
    ready_at_ = now + write_time_;
    ++writes_;
  }
  void drop() { any_ = false; }

 private:
  std::vector<std::uint8_t> cells_;
  std::vector<std::uint8_t> buffer_;
  std::vector<bool> loaded_;
  bool any_ = false;
  std::size_t address_ = 0;
  base::SimDuration write_time_;
  base::SimTime ready_at_;
  std::uint64_t writes_ = 0;
};

}  // namespace stator::board
