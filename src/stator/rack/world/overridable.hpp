#pragma once

#include <algorithm>
#include <vector>

namespace stator::rack {

/// A value that events, programs and wires set and that faults hold. The newest hold that has not
/// been released is in force, else the value that was set last.
template <typename Value>
class Overridable {
 public:
  Overridable() = default;
  /// `value`: what it is before anybody sets it.
  explicit Overridable(Value value) : set_(value) {}

  /// Sets the value. False: a hold is in force, and the value takes effect after it.
  bool set(Value value) {
    set_ = value;
    return holds_.empty();
  }
  /// Holds `value` for `owner` until release(owner). False: a newer hold is in force.
  bool hold(const void* owner, Value value) {
    const auto known = std::ranges::find(holds_, owner, &Hold::owner);
    if (known == holds_.end()) {
      holds_.push_back({owner, value});
      return true;
    }
    known->value = value;
    return known + 1 == holds_.end();
  }
  /// False: nothing changes, for a newer hold is in force, an older one wants the same, or there
  /// was none of `owner`.
  bool release(const void* owner) {
    const Value before = value();
    std::erase_if(holds_, [owner](const Hold& hold) { return hold.owner == owner; });
    return value() != before;
  }
  /// What is in force.
  [[nodiscard]] Value value() const { return holds_.empty() ? set_ : holds_.back().value; }

 private:
  struct Hold {
    const void* owner = nullptr;
    Value value{};
  };
  Value set_{};
  std::vector<Hold> holds_;  ///< the newest last
};

}  // namespace stator::rack
