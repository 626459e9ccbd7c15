#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stator::can {

/// The members that compete for the bus, in the order of their arbitration fields and, of equal
/// ones, of their numbers.
///
/// A sorted list whose head moves on: what is taken is mostly the first and what is added mostly
/// comes last, as the answers of many nodes to one SYNC do, so neither moves the others.
class Contenders {
 public:
  /// Field and member in one number, so that comparing them is one comparison.
  class Entry {
   public:
    constexpr Entry(std::uint32_t field, std::size_t member)
        : rank_(std::uint64_t{field} << 32U | static_cast<std::uint32_t>(member)) {}
    [[nodiscard]] constexpr std::uint32_t field() const {
      return static_cast<std::uint32_t>(rank_ >> 32U);
    }
    [[nodiscard]] constexpr std::size_t member() const { return rank_ & 0xFFFF'FFFFU; }
    friend constexpr auto operator<=>(Entry, Entry) = default;

   private:
    std::uint64_t rank_;
  };

  /// Makes room for one more.
  void add_member() { entries_.reserve(2 * ++members_); }
  void insert(Entry entry) {
    if (entries_.size() == 2 * members_) {
      entries_.erase(entries_.begin(), begin());
      first_ = 0;
    }
    if (entries_.empty() || entries_.back() < entry) [[likely]] {
      entries_.push_back(entry);
    } else {
      entries_.insert(std::upper_bound(begin(), entries_.end(), entry), entry);
    }
  }
  void erase(Entry entry) {
    if (*begin() == entry) [[likely]] {
      ++first_;
    } else {
      entries_.erase(std::lower_bound(begin(), entries_.end(), entry));
    }
    if (first_ == entries_.size()) {
      entries_.clear();
      first_ = 0;
    }
  }
  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] std::span<const Entry> all() const { return std::span(entries_).subspan(first_); }

 private:
  [[nodiscard]] std::vector<Entry>::iterator begin() {
    return entries_.begin() + static_cast<std::ptrdiff_t>(first_);
  }

  std::vector<Entry> entries_;
  std::size_t first_ = 0;
  std::size_t members_ = 0;
};

}  // namespace stator::can
