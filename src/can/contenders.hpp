#pragma once

#include <algorithm>
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
  struct Entry {
    std::uint32_t field;
    std::uint32_t member;

    friend auto operator<=>(const Entry&, const Entry&) = default;
  };

  /// Makes room for one more.
  void add_member() { entries_.reserve(2 * ++members_); }
  void insert(Entry entry) {
    if (entries_.size() == 2 * members_) {
      entries_.erase(entries_.begin(), begin());
      first_ = 0;
    }
    entries_.insert(std::upper_bound(begin(), entries_.end(), entry), entry);
  }
  void erase(Entry entry) {
    const auto found = std::lower_bound(begin(), entries_.end(), entry);
    if (found == begin()) {
      ++first_;
    } else {
      entries_.erase(found);
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
