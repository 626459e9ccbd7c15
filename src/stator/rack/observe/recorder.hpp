#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/link/system/background_output.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::rack {

/// Writes chosen signals as CSV, one row per sampling period of simulated time: first column the
/// time in seconds, then one column per signal headed "name [unit]". Numbers are written with the
/// fewest digits that read back to the same value, so equal runs give equal files. A thread of its
/// own writes them.
class Recorder {
 public:
  /// Opens `path`; throws std::runtime_error naming the file and the reason when that fails, or
  /// when `signals` is empty or `period` is not positive.
  Recorder(const std::string& path, std::vector<product::Signal> signals, base::SimDuration period);

  /// The next moment to sample; the rack brings its devices there and calls sample().
  [[nodiscard]] base::SimTime next_sample() const { return next_sample_; }

  /// Writes one row for `now` and moves next_sample() on by one period.
  void sample(base::SimTime now);

  /// Rows written so far; those that found no room are not among them.
  [[nodiscard]] std::uint64_t rows() const { return output_->records(); }
  /// The file: what it does when nobody takes rows, and what is missing.
  [[nodiscard]] link::BackgroundOutput& output() { return *output_; }

 private:
  std::vector<product::Signal> signals_;
  base::SimDuration period_;
  base::SimTime next_sample_;
  std::string row_;
  std::unique_ptr<link::BackgroundOutput> output_;
};

/// The signals whose name matches one of `patterns` (base::matches), in the
/// order of `available`. Throws std::runtime_error naming a pattern that matches nothing and the
/// names that exist.
std::vector<product::Signal> select_signals(const std::vector<product::Signal>& available,
                                            const std::vector<std::string>& patterns);

}  // namespace stator::rack
