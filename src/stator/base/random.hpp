#pragma once

#include <cstdint>

namespace stator::base {

/// Seeded random numbers (SplitMix64): integer arithmetic only, so a seed gives the same sequence
/// on every compiler and processor. One generator per noise channel; the seed comes from the rack
/// file.
class Random {
 public:
  constexpr explicit Random(std::uint64_t seed) : state_(seed) {}

  /// The next 64 equally distributed bits.
  constexpr std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
    return z ^ (z >> 31);
  }

  /// A number in [0, 1) with 53 random bits.
  constexpr double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

  /// A bell-shaped random number of variance 1, within +-3.5: the sum of four equally distributed
  /// ones.
  constexpr double bell() {
    const std::uint64_t bits = next();
    const std::uint64_t sum =
        (bits & 0xFFFF) + ((bits >> 16) & 0xFFFF) + ((bits >> 32) & 0xFFFF) + (bits >> 48);
    constexpr double kSquareRootOfThree = 1.73205080756887729353;
    return (static_cast<double>(sum) * 0x1p-16 - (2.0 - 0x1p-15)) * kSquareRootOfThree;
  }

  /// A whole number in [0, bound); `bound` must not be 0.
  constexpr std::uint64_t below(std::uint64_t bound) { return next() % bound; }

 private:
  std::uint64_t state_;
};

}  // namespace stator::base
