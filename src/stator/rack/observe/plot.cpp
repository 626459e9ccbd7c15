#include "stator/rack/observe/plot.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

namespace stator::rack {

namespace {

/// Points of a curve that a picture of this width can show; more only make the file large.
constexpr std::uint64_t kPointsShown = 6000;

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    result += c == '\'' ? "''" : std::string(1, c);
  }
  return result + "'";
}

unsigned height_of(const Plot& plot) {
  return 120 + plot.panel_height * static_cast<unsigned>(plot.panels.size());
}

std::string terminal_for(const std::string& image_path, unsigned height) {
  if (image_path.ends_with(".svg")) {
    return fmt::format("set terminal svg size 1200,{} font 'DejaVu Sans,14' background '#ffffff'\n",
                       height);
  }
  if (image_path.ends_with(".png")) {
    return fmt::format("set terminal pngcairo size 1200,{} font 'DejaVu Sans,11'\n", height);
  }
  throw std::runtime_error(
      fmt::format("plot: {} ends neither in .png nor in .svg; choose one of the two", image_path));
}

const char* drawn_as(PlotCurve::Style style) {
  switch (style) {
    case PlotCurve::Style::points:
      return "points pt 7 ps 0.8";
    case PlotCurve::Style::dashed:
      return "lines lw 1.6 dt 2";
    case PlotCurve::Style::line:
      break;
  }
  return "lines lw 1.6";
}

/// Whether the panel below `i` shows the same horizontal axis, so that one set of numbers does.
bool shares_axis_below(const std::vector<PlotPanel>& panels, std::size_t i) {
  return i + 1 < panels.size() && panels[i + 1].window == panels[i].window &&
         panels[i + 1].x_label == panels[i].x_label;
}

bool every_panel_shares_its_axis(const Plot& plot) {
  return std::ranges::all_of(plot.panels, [&](const PlotPanel& panel) {
    return panel.x_label == plot.panels.front().x_label;
  });
}

/// Room for panels and for what is written around them; gnuplot wants fractions of the picture.
std::string layout_of(const Plot& plot) {
  constexpr double kTitle = 50.0;       // pixels above the first panel
  constexpr double kAxis = 70.0;        // below a panel with numbers and name of its axis
  constexpr double kSharedAxis = 40.0;  // below one without
  constexpr double kLegend = 30.0;      // above a panel
  const double height = height_of(plot);
  const bool above = plot.legend == Plot::Legend::above;
  const double spacing =
      (every_panel_shares_its_axis(plot) ? kSharedAxis : kAxis) + (above ? kLegend : 0.0);
  return fmt::format("margins 0.09,{},{},{} spacing 0,{}", above ? 0.97 : 0.86, kAxis / height,
                     1.0 - (kTitle + (above ? kLegend : 0.0)) / height, spacing / height);
}

void append_curve(std::string& script, const Plot& plot, const PlotCurve& curve,
                  std::uint64_t thinning) {
  const bool every_row_counts = curve.style == PlotCurve::Style::points;
  fmt::format_to(std::back_inserter(script),
                 "{} using {}:(${}*{}) skip 1 every {} with {} lc rgb '{}' title {}",
                 quoted(plot.csv_path), curve.x_column, curve.column, curve.scale,
                 every_row_counts ? 1 : thinning, drawn_as(curve.style), curve.colour,
                 quoted(curve.title));
}

std::string script_for(const Plot& plot, const std::string& image_path) {
  std::string script = terminal_for(image_path, height_of(plot));
  auto out = std::back_inserter(script);
  fmt::format_to(out, "set output {}\n", quoted(image_path));
  fmt::format_to(out, "set datafile separator ','\n");
  fmt::format_to(out, "set multiplot layout {},1 title {} font ',16' noenhanced {}\n",
                 plot.panels.size(), quoted(plot.title), layout_of(plot));
  fmt::format_to(out,
                 "set grid lt 1 lw 0.6 lc rgb '#cfd6dc'\nset border lc rgb '#5a6470'\n"
                 "set key {} noenhanced samplen 2\nset tics nomirror\nset autoscale xfix\n",
                 plot.legend == Plot::Legend::above
                     ? "at graph 1,1.02 bottom right horizontal Left "
                       "reverse"
                     : "outside right center");
  for (std::size_t i = 0; i < plot.panels.size(); ++i) {
    const PlotPanel& panel = plot.panels[i];
    fmt::format_to(out, "set ylabel {} offset 1\n", quoted(panel.label));
    const bool shared = shares_axis_below(plot.panels, i);
    const bool own_axis =
        i + 1 == plot.panels.size() || panel.x_label != plot.panels[i + 1].x_label;
    fmt::format_to(out, "set format x '{}'\n", shared ? "" : "%g");
    fmt::format_to(out, "set xlabel {}\n", quoted(own_axis ? panel.x_label : ""));
    if (panel.window) {
      fmt::format_to(out, "set xrange [{}:{}]\n", panel.window->first, panel.window->second);
    }
    fmt::format_to(out, "set yrange [{}:*]\n", panel.from_zero ? "0" : "*");
    if (!panel.window) {
      fmt::format_to(out, "set xrange [{}:*]\n", panel.from_zero ? "0" : "*");
    }
    fmt::format_to(out, "{} logscale x\n", panel.logarithmic_x ? "set" : "unset");
    const std::uint64_t thinning = panel.window ? 1 : 1 + plot.rows / kPointsShown;
    std::string separator = "plot ";
    for (const PlotCurve& curve : panel.curves) {
      script += separator;
      append_curve(script, plot, curve, thinning);
      separator = ", ";
    }
    fmt::format_to(out, "\n");
  }
  fmt::format_to(out, "unset multiplot\n");
  return script;
}

struct PipeClose {
  void operator()(std::FILE* pipe) const { ::pclose(pipe); }
};

}  // namespace

void draw(const Plot& plot, const std::string& image_path) {
  const std::string script = script_for(plot, image_path);
  std::unique_ptr<std::FILE, PipeClose> pipe(::popen("gnuplot -", "w"));  // NOLINT(cert-env33-c)
  if (pipe == nullptr) {
    throw std::runtime_error("plot: cannot start gnuplot; install the package gnuplot-nox");
  }
  // A gnuplot that does not take all of it has failed, and says so by its exit status.
  static_cast<void>(std::fwrite(script.data(), 1, script.size(), pipe.get()));
  if (const int status = ::pclose(pipe.release()); status != 0) {
    throw std::runtime_error(
        fmt::format("plot: gnuplot did not draw {} (exit status {}); install the package "
                    "gnuplot-nox, or see its message above",
                    image_path, status));
  }
}

}  // namespace stator::rack
