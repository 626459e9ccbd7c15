#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "devices/drive_sequences/sequence.hpp"
#include "devices/drive_sequences/vocabulary.hpp"
#include "stator/base/random.hpp"

namespace stator::tests {

/// Puts random steps together until they are enough.
class SequenceWriter {
 public:
  explicit SequenceWriter(std::uint64_t seed) : random_(seed * 0x9E3779B97F4A7C15 + 1) {}

  [[nodiscard]] std::vector<DriveStep> take() { return std::move(steps_); }
  [[nodiscard]] bool full() const { return time_ >= kLongest || steps_.size() > 150; }

 protected:
  static constexpr std::int64_t kLongest = 2500;  // ms of a sequence

  bool chance(double share) { return random_.uniform() < share; }
  std::int64_t between(std::int64_t low, std::int64_t high) {
    return low +
           static_cast<std::int64_t>(random_.below(static_cast<std::uint64_t>(high - low + 1)));
  }
  double spread(double low, double high) { return low * std::pow(high / low, random_.uniform()); }
  template <typename T>
  T one_of(std::span<const T> values) {
    return values[random_.below(values.size())];
  }
  /// The first ones more often.
  template <typename T>
  T early_of(std::span<const T> values) {
    return values[std::min(random_.below(values.size()), random_.below(values.size()))];
  }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }

  void put(const DriveStep& step) { steps_.push_back(step); }
  void wait(std::int64_t milliseconds) {
    put({.action = DriveAction::wait, .value = milliseconds});
    time_ += milliseconds;
  }
  void pause() { wait(static_cast<std::int64_t>(spread(3.0, chance(0.1) ? 1500.0 : 300.0))); }
  void set(std::string_view input, double level) {
    put({.action = DriveAction::set, .input = input, .level = level});
  }

  base::Random random_;
  std::vector<DriveStep> steps_;
  std::int64_t time_ = 0;
};

/// random_drive_sequence() of a product with CiA 402, and of one with TMCL.
[[nodiscard]] std::vector<DriveStep> random_cia402_sequence(const Vocabulary& words,
                                                            std::uint64_t seed);
[[nodiscard]] std::vector<DriveStep> random_tmcl_sequence(std::uint64_t seed);

}  // namespace stator::tests
