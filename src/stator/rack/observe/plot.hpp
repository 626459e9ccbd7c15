#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stator::rack {

/// One curve: two columns of a CSV file, with the factor that brings it to the panel's unit. Empty
/// fields are left out.
struct PlotCurve {
  enum class Style {
    line,
    points,
    dashed,  ///< what something is compared with
  };
  int column = 2;
  double scale = 1.0;
  std::string title;
  std::string colour;  ///< "#RRGGBB"
  int x_column = 1;    ///< 1 = time, in a recording
  Style style = Style::line;
};

/// One panel: curves over a common horizontal axis, with its own scale.
struct PlotPanel {
  std::string label;  ///< of the vertical axis, with unit
  std::vector<PlotCurve> curves;
  std::optional<std::pair<double, double>> window;  ///< x shown; all there is if empty
  std::string x_label = "time / s";
  bool from_zero = false;  ///< both axes begin at 0
  bool logarithmic_x = false;
};

/// A picture of one recording or series of measurements: panels above each other.
struct Plot {
  enum class Legend { right, above };
  std::string title;
  std::string csv_path;
  std::uint64_t rows = 0;  ///< of the recording; long ones are thinned where all of it is shown
  std::vector<PlotPanel> panels;
  unsigned panel_height = 230;  ///< pixels, with what is written below and above a panel
  Legend legend = Legend::right;
};

/// Draws `plot` with gnuplot into `image_path` (".png" or ".svg"). Throws std::runtime_error when
/// the ending is another, gnuplot is not installed or fails; the message names the remedy.
void draw(const Plot& plot, const std::string& image_path);

}  // namespace stator::rack
