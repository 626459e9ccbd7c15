#pragma once

#include <string>
#include <vector>

namespace stator::experiment {

/// A quantity the bench measured beside what the equations say of it.
struct Comparison {
  std::string quantity;  ///< what and where, e.g. "pull-out torque at 12 rev/s"
  std::string unit;
  double measured = 0.0;
  double equation = 0.0;
  double scale = 0.0;  ///< what a deviation is a part of; 0 = the equation's value
  bool judged = true;  ///< false: outside the range in which the equation claims to hold

  /// (measured - equation) / scale.
  [[nodiscard]] double deviation() const;
};

/// One curve over the x values of its panel.
struct Curve {
  enum class Style {
    measured_line,    ///< a trace
    measured_points,  ///< single measurements
    equation,         ///< a line from a formula
  };
  std::string title;
  Style style = Style::measured_line;
  std::vector<double> values;  ///< as many as the panel's x; NaN where there is none
};

/// Curves over a common x axis.
struct Panel {
  std::string x_name;  ///< e.g. "speed"
  std::string x_unit;
  std::string name;  ///< of the vertical axis
  std::string unit;
  std::vector<double> x;
  std::vector<Curve> curves;
  bool from_zero = false;  ///< drawn with axes that begin at 0
  bool logarithmic_x = false;
};

/// What an experiment gives back: numbers for a table, curves for a picture.
struct Result {
  std::string title;
  std::vector<std::string> remarks;  ///< one sentence each: what was set, where an equation ends
  std::vector<Comparison> comparisons;
  std::vector<Panel> panels;

  /// Largest magnitude of a judged deviation.
  [[nodiscard]] double worst_deviation() const;
};

}  // namespace stator::experiment
