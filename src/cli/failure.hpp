#pragma once

#include <stdexcept>

namespace stator::cli {

/// A command could not do what was asked; the text says what, where and what to do. Exit status 1.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stator::cli
