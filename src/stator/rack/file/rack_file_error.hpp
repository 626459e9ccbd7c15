#pragma once

#include <stdexcept>
#include <utility>

#include "stator/settings/problem.hpp"

namespace stator::rack {

/// The first thing that is wrong with a rack file, for those who want to know no more.
class RackFileError : public std::runtime_error {
 public:
  explicit RackFileError(settings::Problem problem)
      : std::runtime_error(problem.text()), problem_(std::move(problem)) {}

  [[nodiscard]] const settings::Problem& problem() const { return problem_; }

 private:
  settings::Problem problem_;
};

}  // namespace stator::rack
