#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace stator::can {

/// The members of a bus whose transmit buffer has changed since the bus last looked, so that it
/// need not ask each of them for each frame.
class PendingMembers {
 public:
  /// Makes room for one more.
  void add_member() {
    ++members_;
    words_.resize((members_ + 63) / 64);
  }
  void note(std::size_t member) {
    words_[member / 64] |= std::uint64_t{1} << (member % 64);
    any_ = true;
  }
  [[nodiscard]] bool any() const { return any_; }
  /// Calls `look(member)` for each noted one, in their order, and forgets them.
  template <typename Look>
  void take(Look look) {
    any_ = false;
    for (std::size_t i = 0; i < words_.size(); ++i) {
      look_at(i, look);
      words_[i] = 0;
    }
  }
  /// The same without forgetting them.
  template <typename Look>
  void look(Look look) const {
    for (std::size_t i = 0; i < words_.size(); ++i) {
      look_at(i, look);
    }
  }

 private:
  template <typename Look>
  void look_at(std::size_t i, Look& look) const {
    for (std::uint64_t word = words_[i]; word != 0; word &= word - 1) {
      look(i * 64 + static_cast<std::size_t>(std::countr_zero(word)));
    }
  }

  std::size_t members_ = 0;
  std::vector<std::uint64_t> words_;
  bool any_ = false;
};

}  // namespace stator::can
