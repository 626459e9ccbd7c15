#pragma once

#include <stdexcept>

namespace stator::cli {

/// A command could not do what was asked; the text says what, where and what to do. Exit status 1.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A recording was replayed as far as it goes, but its end is missing. Exit status 3.
class RecordingCut : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stator::cli
