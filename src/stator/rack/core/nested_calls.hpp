#pragma once

#include <utility>

namespace stator::rack {

/// While an object of this class lives, calls of a rack are made by another call of that rack. The
/// journal has recorded the outer call, and a replay repeats the inner ones with it, so they are
/// not recorded.
class NestedCalls {
 public:
  /// Sets `inside` and restores it at the end.
  explicit NestedCalls(bool& inside) : inside_(inside), before_(std::exchange(inside, true)) {}
  NestedCalls(const NestedCalls&) = delete;
  NestedCalls& operator=(const NestedCalls&) = delete;
  ~NestedCalls() { inside_ = before_; }

 private:
  bool& inside_;
  bool before_;
};

}  // namespace stator::rack
