#include "stator/cli/simulate/simulation_output.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "stator/base/csv.hpp"
#include "stator/cli/failure.hpp"
#include "stator/rack/observe/plot.hpp"

namespace stator::cli {

namespace {

using experiment::Comparison;
using experiment::Curve;
using experiment::Panel;
using experiment::Result;

std::string labelled(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : fmt::format("{} / {}", name, unit);
}

/// One column of the file: its heading and its values.
struct Column {
  std::string heading;
  const std::vector<double>* values;
};

std::vector<Column> columns_of(const Result& result) {
  std::vector<Column> columns;
  for (const Panel& panel : result.panels) {
    columns.push_back({fmt::format("{} [{}]", panel.x_name, panel.x_unit), &panel.x});
    for (const Curve& curve : panel.curves) {
      columns.push_back(
          {fmt::format("{}: {} [{}]", panel.name, curve.title, panel.unit), &curve.values});
    }
  }
  return columns;
}

std::size_t rows_of(const Result& result) {
  std::size_t rows = 0;
  for (const Panel& panel : result.panels) {
    rows = std::max(rows, panel.x.size());
  }
  return rows;
}

rack::PlotCurve::Style drawn_as(Curve::Style style) {
  switch (style) {
    case Curve::Style::measured_points:
      return rack::PlotCurve::Style::points;
    case Curve::Style::equation:
      return rack::PlotCurve::Style::dashed;
    case Curve::Style::measured_line:
      break;
  }
  return rack::PlotCurve::Style::line;
}

constexpr std::array kMeasuredColours{"#1f77b4", "#2a9d5c"};
constexpr std::array kEquationColours{"#d1495b", "#e08e0b", "#8d99a6"};

}  // namespace

void print_comparisons(const Result& result) {
  std::size_t width = 8;
  for (const Comparison& comparison : result.comparisons) {
    width = std::max(width, comparison.quantity.size());
  }
  fmt::print("{}\n", result.title);
  for (const std::string& remark : result.remarks) {
    fmt::print("{}\n", remark);
  }
  fmt::print("\n{:{}}  {:>11}  {:>11}  {:>10}\n", "QUANTITY", width, "MEASURED", "EQUATION",
             "DEVIATION");
  bool aside = false;
  for (const Comparison& comparison : result.comparisons) {
    fmt::print("{:{}}  {:11.5g}  {:11.5g}  {:+9.2f}%{} {}\n", comparison.quantity, width,
               comparison.measured, comparison.equation, 100.0 * comparison.deviation(),
               comparison.judged ? " " : "*", comparison.unit);
    aside = aside || !comparison.judged;
  }
  if (aside) {
    fmt::print("* outside the range of the equation, not judged\n");
  }
}

void write_csv(const Result& result, const std::string& path) {
  std::ofstream file(path);
  const std::vector<Column> columns = columns_of(result);
  std::string row;
  for (const Column& column : columns) {
    row += row.empty() ? "" : ",";
    base::append_csv_field(row, column.heading);
  }
  file << row << '\n';
  for (std::size_t n = 0; n < rows_of(result); ++n) {
    row.clear();
    for (const Column& column : columns) {
      const bool there = n < column.values->size() && !std::isnan((*column.values)[n]);
      row += fmt::format("{}{}", &column == columns.data() ? "" : ",",
                         there ? fmt::format("{:.7g}", (*column.values)[n]) : "");
    }
    file << row << '\n';
  }
  file.close();
  if (!file) {
    throw Failure(
        fmt::format("cannot write {}: {}; choose a file in a directory that exists and "
                    "can be written",
                    path, std::generic_category().message(errno)));
  }
}

void draw(const Result& result, const std::string& csv_path, const std::string& image_path) {
  rack::Plot plot;
  plot.title = result.title;
  plot.csv_path = csv_path;
  plot.rows = rows_of(result);
  plot.panel_height = result.panels.size() == 1 ? 480 : 260;
  plot.legend = rack::Plot::Legend::above;
  int column = 0;
  for (const Panel& panel : result.panels) {
    const int x_column = ++column;
    rack::PlotPanel drawn;
    drawn.label = labelled(panel.name, panel.unit);
    drawn.from_zero = panel.from_zero;
    drawn.logarithmic_x = panel.logarithmic_x;
    drawn.x_label = labelled(panel.x_name, panel.x_unit);
    std::size_t measured = 0;
    std::size_t equations = 0;
    for (const Curve& curve : panel.curves) {
      const bool equation = curve.style == Curve::Style::equation;
      drawn.curves.push_back(
          {.column = ++column,
           .scale = 1.0,
           .title = curve.title,
           .colour = equation ? kEquationColours[equations++ % kEquationColours.size()]
                              : kMeasuredColours[measured++ % kMeasuredColours.size()],
           .x_column = x_column,
           .style = drawn_as(curve.style)});
    }
    plot.panels.push_back(std::move(drawn));
  }
  rack::draw(plot, image_path);
}

}  // namespace stator::cli
