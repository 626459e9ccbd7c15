#include "stator/experiment/result.hpp"

#include <algorithm>
#include <cmath>

namespace stator::experiment {

double Comparison::deviation() const {
  return (measured - equation) / (scale != 0.0 ? scale : std::fabs(equation));
}

double Result::worst_deviation() const {
  double worst = 0.0;
  for (const Comparison& comparison : comparisons) {
    if (comparison.judged) {
      worst = std::max(worst, std::fabs(comparison.deviation()));
    }
  }
  return worst;
}

}  // namespace stator::experiment
