#pragma once

#include <stdexcept>

namespace stator::rack {

/// What is wrong with a rack file: "FILE:LINE:COLUMN: reason; remedy".
class RackFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stator::rack
