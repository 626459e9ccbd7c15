#pragma once

#include <cstdint>

#include "stator/base/random.hpp"

namespace stator::base {

/// How often something is to happen on a row of occasions (frames, messages, bytes): so many times,
/// each with a probability. The same seed gives the same choice of occasions.
class Recurrence {
 public:
  /// `count` 0: without end. `probability` of one occasion, 0 to 1.
  constexpr explicit Recurrence(std::uint64_t count = 1, double probability = 1.0,
                                std::uint64_t seed = 1)
      : count_(count), probability_(probability), random_(seed) {}

  /// Another occasion: true if it happens this time.
  [[nodiscard]] constexpr bool next() {
    if (over() || (probability_ < 1.0 && random_.uniform() >= probability_)) {
      return false;
    }
    ++times_;
    return true;
  }
  /// It has happened as often as it should.
  [[nodiscard]] constexpr bool over() const { return count_ != 0 && times_ >= count_; }
  /// How often it has happened.
  [[nodiscard]] constexpr std::uint64_t times() const { return times_; }

 private:
  std::uint64_t count_;
  std::uint64_t times_ = 0;
  double probability_;
  Random random_;
};

}  // namespace stator::base
