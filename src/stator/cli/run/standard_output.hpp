#pragma once

#include <cstdio>
#include <memory>

#include "stator/link/system/background_output.hpp"

namespace stator::cli {

/// While it lives, all that is printed to standard output goes through a queue, so that the program
/// does not wait for who reads it: neither to start nor to end. Line by line.
class StandardOutput {
 public:
  StandardOutput();
  /// Waits for what was printed as long as somebody reads it.
  ~StandardOutput();
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

  /// Lets what was printed come out before something else is said, as far as somebody reads it; see
  /// link::BackgroundOutput::drain().
  void drain(
      link::BackgroundOutput::Clock::time_point asked = link::BackgroundOutput::Clock::now());

 private:
  std::unique_ptr<link::BackgroundOutput> output_;
  std::FILE* before_;
  std::FILE* stream_;
};

}  // namespace stator::cli
