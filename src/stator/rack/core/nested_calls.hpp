#pragma once

#include <utility>

namespace stator::rack {

/// While it lives, calls of a rack are parts of the call that made it: a journal that was told of
/// that one repeats them with it, so it is not told of them again.
class NestedCalls {
 public:
  /// `inside` says whether that is so.
  explicit NestedCalls(bool& inside) : inside_(inside), before_(std::exchange(inside, true)) {}
  NestedCalls(const NestedCalls&) = delete;
  NestedCalls& operator=(const NestedCalls&) = delete;
  ~NestedCalls() { inside_ = before_; }

 private:
  bool& inside_;
  bool before_;
};

}  // namespace stator::rack
