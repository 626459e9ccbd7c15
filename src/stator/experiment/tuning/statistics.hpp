#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "stator/experiment/tuning/settings.hpp"

namespace stator::experiment::tuning {

/// Mean and spread of samples.
class Mean {
 public:
  void add(double value) {
    ++count_;
    const double before = value - mean_;
    mean_ += before / static_cast<double>(count_);
    squares_ += before * (value - mean_);
  }
  [[nodiscard]] double value() const { return mean_; }
  /// Standard deviation of one sample.
  [[nodiscard]] double spread() const {
    return count_ > 1 ? std::sqrt(squares_ / static_cast<double>(count_ - 1)) : 0.0;
  }
  /// Standard deviation of the mean.
  [[nodiscard]] double deviation() const {
    return count_ > 0 ? spread() / std::sqrt(static_cast<double>(count_)) : 0.0;
  }
  [[nodiscard]] Measured measured() const { return {value(), deviation()}; }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::size_t count_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;
};

/// Linear least squares: y = sum of x_k times the unknown k.
template <std::size_t kUnknowns>
class LeastSquares {
 public:
  using Row = std::array<double, kUnknowns>;

  void add(const Row& x, double y) {
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      for (std::size_t k = 0; k < kUnknowns; ++k) {
        normal_[i][k] += x[i] * x[k];
      }
      right_[i] += x[i] * y;
    }
    squares_ += y * y;
    ++rows_;
  }

  /// The unknowns with their standard deviations; all deviations are infinite if the rows do not
  /// tell the unknowns apart.
  [[nodiscard]] std::array<Measured, kUnknowns> solve() const {
    std::array<Measured, kUnknowns> result{};
    std::array<Row, kUnknowns> inverse{};
    if (!invert(inverse) || rows_ <= kUnknowns) {
      result.fill({0.0, HUGE_VAL});
      return result;
    }
    double left = squares_;
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      for (std::size_t k = 0; k < kUnknowns; ++k) {
        result[i].value += inverse[i][k] * right_[k];
      }
      left -= result[i].value * right_[i];
    }
    const double variance = std::fmax(left, 0.0) / static_cast<double>(rows_ - kUnknowns);
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      result[i].deviation = std::sqrt(variance * std::fmax(inverse[i][i], 0.0));
    }
    return result;
  }

 private:
  /// Gauss and Jordan on the matrix scaled to a diagonal of ones, which the units would spoil.
  bool invert(std::array<Row, kUnknowns>& inverse) const {
    Row scale{};
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      if (!(normal_[i][i] > 0.0)) {
        return false;
      }
      scale[i] = 1.0 / std::sqrt(normal_[i][i]);
    }
    std::array<Row, kUnknowns> work{};
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      for (std::size_t k = 0; k < kUnknowns; ++k) {
        work[i][k] = normal_[i][k] * scale[i] * scale[k];
        inverse[i][k] = i == k ? 1.0 : 0.0;
      }
    }
    constexpr double kSingular = 1e-9;  // positive definite: pivots on the diagonal will do
    for (std::size_t p = 0; p < kUnknowns; ++p) {
      if (work[p][p] < kSingular) {
        return false;
      }
      const double factor = 1.0 / work[p][p];
      for (std::size_t k = 0; k < kUnknowns; ++k) {
        work[p][k] *= factor;
        inverse[p][k] *= factor;
      }
      for (std::size_t i = 0; i < kUnknowns; ++i) {
        const double share = work[i][p];
        for (std::size_t k = 0; i != p && k < kUnknowns; ++k) {
          work[i][k] -= share * work[p][k];
          inverse[i][k] -= share * inverse[p][k];
        }
      }
    }
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      for (std::size_t k = 0; k < kUnknowns; ++k) {
        inverse[i][k] *= scale[i] * scale[k];
      }
    }
    return true;
  }

  std::array<Row, kUnknowns> normal_{};
  Row right_{};
  double squares_ = 0.0;
  std::size_t rows_ = 0;
};

}  // namespace stator::experiment::tuning
