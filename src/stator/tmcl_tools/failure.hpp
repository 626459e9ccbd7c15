#pragma once

#include <stdexcept>

namespace stator::tmcl_tools {

/// A tool could not do what was asked; the text says what, where and what to do.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stator::tmcl_tools
