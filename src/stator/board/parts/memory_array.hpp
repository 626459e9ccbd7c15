#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/board/peripheral/kept_content.hpp"

namespace stator::board {

/// The cells of a serial EEPROM: pages that are written as a whole, one at a time, and one register
/// that is written like a page. Its content is the cells and the register behind them.
class MemoryArray final : public KeptContent {
 public:
  /// `size` and `page` are powers of two.
  MemoryArray(std::size_t size, std::size_t page, base::SimDuration write_time)
      : size_(size),
        cells_(size + 1, std::byte{0xFF}),
        buffer_(page),
        loaded_(page),
        write_time_(write_time) {
    cells_[size_] = std::byte{0};
  }

  [[nodiscard]] std::uint8_t read(std::size_t address) const {
    return std::to_integer<std::uint8_t>(cells_[address & (size_ - 1)]);
  }
  [[nodiscard]] std::uint8_t read_register() const {
    return std::to_integer<std::uint8_t>(cells_[size_]);
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool busy(base::SimTime now) const { return now < ready_at_ || keeping_; }
  [[nodiscard]] std::uint64_t writes() const { return writes_; }

  /// Bytes go into the page buffer from here; an address beyond the page begins it anew.
  void begin_page(std::size_t address) {
    address_ = address & (size_ - 1);
    std::fill(loaded_.begin(), loaded_.end(), false);
    any_ = false;
  }
  void load(std::uint8_t data) {
    const std::size_t within = address_ & (buffer_.size() - 1);
    buffer_[within] = std::byte{data};
    loaded_[within] = true;
    any_ = true;
    address_ = (address_ & ~(buffer_.size() - 1)) | ((within + 1) & (buffer_.size() - 1));
  }
  /// Whether anything waits in the buffer.
  [[nodiscard]] bool loaded() const { return any_; }
  /// Writes the loaded bytes; the array is busy until then.
  void program(base::SimTime now) {
    begin_write();
    const std::size_t page = address_ & ~(buffer_.size() - 1);
    for (std::size_t k = 0; k < buffer_.size(); ++k) {
      if (loaded_[k]) {
        cells_[page + k] = buffer_[k];
      }
    }
    any_ = false;
    end_write(now);
  }
  void write_register(base::SimTime now, std::uint8_t value) {
    begin_write();
    cells_[size_] = std::byte{value};
    end_write(now);
  }
  void drop() { any_ = false; }

  [[nodiscard]] std::span<const std::byte> content() const override {
    return keeping_ ? before_ : cells_;
  }
  [[nodiscard]] bool load(std::span<const std::byte> content) override {
    if (content.size() != cells_.size()) {
      return false;
    }
    std::ranges::copy(content, cells_.begin());
    return true;
  }
  void connect(ContentKeeper* keeper) override {
    keeper_ = keeper;
    keeping_ = false;
    before_ = cells_;
  }
  void finish(bool kept) override {
    if (keeping_ && !kept) {
      cells_ = before_;
    }
    keeping_ = false;
  }

 private:
  void begin_write() {
    if (keeper_ != nullptr) {
      before_ = cells_;
    }
  }
  void end_write(base::SimTime now) {
    ready_at_ = now + write_time_;
    ++writes_;
    keeping_ = keeper_ != nullptr && !keeper_->keep(cells_);
  }

  std::size_t size_;
  std::vector<std::byte> cells_;  ///< and the register
  std::vector<std::byte> buffer_;
  std::vector<bool> loaded_;
  bool any_ = false;
  std::size_t address_ = 0;
  base::SimDuration write_time_;
  base::SimTime ready_at_;
  std::uint64_t writes_ = 0;

  ContentKeeper* keeper_ = nullptr;
  bool keeping_ = false;           ///< the keeper has not told the end
  std::vector<std::byte> before_;  ///< the latest write
};

}  // namespace stator::board
