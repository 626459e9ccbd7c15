#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stator::rack {

/// One curve: a column of a CSV file, with the factor that brings it to the panel's unit.
struct PlotCurve {
  int column = 2;  ///< 1 = time
  double scale = 1.0;
  std::string title;
  std::string colour;  ///< "#RRGGBB"
};

/// One panel: curves over a common time axis, with its own scale.
struct PlotPanel {
  std::string label;  ///< of the vertical axis, with unit
  std::vector<PlotCurve> curves;
  std::optional<std::pair<double, double>> window;  ///< seconds shown; the whole recording if empty
};

/// A picture of one recording: panels above each other over the same time axis.
struct Plot {
  std::string title;
  std::string csv_path;
  std::uint64_t rows = 0;  ///< of the recording; long ones are thinned where all of it is shown
  std::vector<PlotPanel> panels;
};

/// Draws `plot` with gnuplot into `image_path` (".png" or ".svg"). Throws std::runtime_error when
/// the ending is another, gnuplot is not installed or fails; the message names the remedy.
void draw(const Plot& plot, const std::string& image_path);

}  // namespace stator::rack
