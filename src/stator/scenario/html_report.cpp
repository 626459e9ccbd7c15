// Results of scenarios as one HTML page: overview, steps, plots as SVG.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "stator/scenario/comparison.hpp"
#include "stator/scenario/report.hpp"

namespace stator::scenario {

namespace {

constexpr std::string_view kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Scenarios</title>
<style>
:root { color-scheme: light dark; --text: #1c1f24; --quiet: #5b6470; --page: #f5f6f8; --panel: #fff; --line: #d5dae1;
  --good: #17703a; --bad: #b3261e; --curve: #0b57c2; --mark: #b3261e; }
@media (prefers-color-scheme: dark) { :root { --text: #e6e9ee; --quiet: #9aa5b3; --page: #14171b; --panel: #1d2126;
  --line: #353c45; --good: #63c98a; --bad: #ff8a80; --curve: #7ab3ff; --mark: #ff8a80; } }
body { margin: 0 auto; padding: 1.5rem; max-width: 76rem; background: var(--page); color: var(--text);
  font: 0.95rem/1.45 system-ui, sans-serif; }
h1 { font-size: 1.5rem; margin: 0 0 0.25rem; } h2 { font-size: 1.15rem; margin: 0; }
p { margin: 0.35rem 0; } .quiet { color: var(--quiet); }
.passed { color: var(--good); } .failed, .error { color: var(--bad); } .not-run { color: var(--quiet); }
section, .overview { background: var(--panel); border: 1px solid var(--line); border-radius: 6px; padding: 1rem; margin: 1rem 0;
  overflow-x: auto; }
table { border-collapse: collapse; width: 100%; } caption { text-align: left; color: var(--quiet); }
th, td { text-align: left; vertical-align: top; padding: 0.3rem 0.7rem 0.3rem 0; border-top: 1px solid var(--line); }
thead th { border-top: 0; color: var(--quiet); font-weight: 500; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
a { color: inherit; } pre { overflow-x: auto; background: var(--page); padding: 0.6rem; border-radius: 4px; font-size: 0.85rem; }
svg { display: block; width: 100%; height: auto; margin-top: 0.6rem; }
svg text { fill: var(--quiet); font-size: 11px; } svg .axis { stroke: var(--line); } svg .curve { stroke: var(--curve); fill: none; }
svg .mark { stroke: var(--mark); stroke-dasharray: 4 3; }
</style>
</head>
<body>
)";

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string class_of(Status status) {
  return status == Status::not_run ? "not-run" : std::string(to_text(status));
}

std::string status_cell(Status status) {
  return fmt::format("<td class=\"{}\">{}</td>", class_of(status), to_text(status));
}

/// A step between tick marks that leaves some five of them: 1, 2 or 5 times a power of ten.
double tick_step(double span) {
  const double rough = span / 5;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) {
      return factor * power;
    }
  }
  return 10 * power;
}

/// The rectangle of a plot in the picture, and the range of times and values that it shows.
struct Frame {
  double left = 80;
  double top = 22;
  double width = 850;
  double height = 130;
  double t0 = 0.0;
  double t1 = 1.0;
  double v0 = 0.0;
  double v1 = 1.0;

  [[nodiscard]] double x(double t) const { return left + (t - t0) / (t1 - t0) * width; }
  [[nodiscard]] double y(double v) const { return top + (v1 - v) / (v1 - v0) * height; }
};

Frame frame_of(const PlotSeries& series, double end) {
  Frame frame;
  frame.t1 = end > 0.0 ? end : 1.0;
  const auto [low, high] = std::ranges::minmax_element(series.values);
  const double margin = *high > *low ? 0.05 * (*high - *low) : std::max(1.0, std::abs(*high));
  frame.v0 = *low - margin;
  frame.v1 = *high + margin;
  return frame;
}

std::string axes(const Frame& frame) {
  std::string svg;
  const double time_step = tick_step(frame.t1 - frame.t0);
  double t = 0.0;
  while (t <= frame.t1 * (1 + 1e-9)) {
    svg += fmt::format(
        "<line class=\"axis\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/>"
        "<text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4:g} s</text>",
        frame.x(t), frame.top, frame.top + frame.height, frame.top + frame.height + 14, t);
    t += time_step;
  }
  const double value_step = tick_step(frame.v1 - frame.v0);
  double n = std::ceil(frame.v0 / value_step);
  while (n * value_step <= frame.v1) {
    const double v = n * value_step;
    svg += fmt::format(
        "<line class=\"axis\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>"
        "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>",
        frame.left, frame.left + frame.width, frame.y(v), frame.left - 6, frame.y(v) + 4,
        number_text(v));
    ++n;
  }
  return svg;
}

/// A polyline of at most two points per pixel: the least and the greatest value there.
std::string curve(const PlotSeries& series, const Frame& frame) {
  std::string points;
  const auto add = [&](std::size_t row) {
    points +=
        fmt::format("{:.1f},{:.1f} ", frame.x(series.times[row]), frame.y(series.values[row]));
  };
  for (std::size_t begin = 0; begin < series.values.size();) {
    const double column = std::floor(frame.x(series.times[begin]));
    std::size_t low = begin;
    std::size_t high = begin;
    std::size_t end = begin;
    for (; end < series.values.size() && std::floor(frame.x(series.times[end])) == column; ++end) {
      low = series.values[end] < series.values[low] ? end : low;
      high = series.values[end] > series.values[high] ? end : high;
    }
    add(std::min(low, high));
    if (low != high) {
      add(std::max(low, high));
    }
    begin = end;
  }
  return fmt::format(R"(<polyline class="curve" points="{}"/>)", points);
}

/// Vertical lines where faults were injected and where steps failed.
std::string marks(const ScenarioResult& result, const Frame& frame) {
  std::string svg;
  for (const StepResult& step : result.steps) {
    const bool failed = step.status == Status::failed;
    if (step.status == Status::not_run || (!failed && step.kind != "inject")) {
      continue;
    }
    const double x = frame.x((failed ? step.end : step.begin).seconds());
    svg += fmt::format(
        "<line class=\"mark\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\">"
        "<title>{3}</title></line>",
        x, frame.top, frame.top + frame.height, escaped(step.title));
  }
  return svg;
}

std::string picture(const ScenarioResult& result, const PlotSeries& series) {
  if (series.values.empty()) {
    return {};
  }
  const Frame frame = frame_of(series, result.end.seconds());
  const std::string title =
      series.unit.empty() ? series.name : fmt::format("{} / {}", series.name, series.unit);
  return fmt::format(
      "<svg viewBox=\"0 0 960 176\" role=\"img\" aria-label=\"{0} over simulated time\">"
      "<text x=\"{1}\" y=\"14\">{0}</text>{2}{3}{4}</svg>\n",
      escaped(title), frame.left, axes(frame), curve(series, frame), marks(result, frame));
}

std::string step_row(const StepResult& step) {
  return fmt::format(
      "<tr><td class=\"number\">{}</td><td>{}</td><td>{}</td>{}<td class=\"number\">{:.6f}</td>"
      "<td class=\"number\">{:.3f}</td><td>{}</td></tr>\n",
      step.line, escaped(step.kind), escaped(step.title), status_cell(step.status),
      step.begin.seconds(), (step.end - step.begin).seconds() * 1e3, escaped(step.text));
}

/// What failed and what was seen instead; empty of a scenario that passed.
std::string failure_of(const ScenarioResult& result) {
  if (!result.error.empty()) {
    return fmt::format("<pre class=\"error\">{}</pre>\n", escaped(result.error));
  }
  const StepResult* const failed = result.failed_step();
  return failed == nullptr ? std::string()
                           : fmt::format("<p class=\"failed\">{}:{}: {}: {}</p><p>{}</p>\n",
                                         escaped(result.file), failed->line, escaped(failed->kind),
                                         escaped(failed->title), escaped(failed->text));
}

/// Why the page was opened, before anything else.
std::string failures(std::span<const ScenarioResult> results) {
  std::string html;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (const std::string failure = failure_of(results[i]); !failure.empty()) {
      html += fmt::format("<h2><a href=\"#scenario-{}\">{}</a></h2>\n{}", i + 1,
                          escaped(results[i].name), failure);
    }
  }
  return html.empty() ? "" : fmt::format("<section class=\"failures\">{}</section>\n", html);
}

std::string chapter(const ScenarioResult& result, std::size_t number) {
  std::string html = fmt::format(
      "<section id=\"scenario-{}\"><h2><span class=\"{}\">{}</span> {}</h2>\n<p class=\"quiet\">{}"
      ", {:.3f} s simulated in {:.2f} s</p>\n",
      number, class_of(result.status), to_text(result.status), escaped(result.name),
      escaped(result.file), result.end.seconds(), result.wall_seconds);
  if (!result.summary.empty()) {
    html += fmt::format("<p>{}</p>\n", escaped(result.summary));
  }
  html += failure_of(result);
  if (!result.steps.empty() && result.status != Status::error) {
    html +=
        "<table><thead><tr><th class=\"number\">Line</th><th>Kind</th><th>Step</th><th>Result</th>"
        "<th class=\"number\">Begin / s</th><th class=\"number\">Took / "
        "ms</th><th>Seen</th></tr></thead><tbody>\n";
    for (const StepResult& step : result.steps) {
      html += step_row(step);
    }
    html += "</tbody></table>\n";
  }
  for (const PlotSeries& series : result.plots) {
    html += picture(result, series);
  }
  if (!result.events.empty()) {
    html += "<p>The last events of the rack:</p><pre>";
    for (const std::string& line : result.events) {
      html += escaped(line) + "\n";
    }
    html += "</pre>\n";
  }
  return html + "</section>\n";
}

}  // namespace

std::string html_report(std::span<const ScenarioResult> results) {
  const auto passed = std::ranges::count(results, Status::passed, &ScenarioResult::status);
  std::string html(kHead);
  html += fmt::format("<h1>Scenarios</h1>\n<p>{} of {} passed</p>\n", passed, results.size());
  html += failures(results);
  html +=
      "<div class=\"overview\"><table><thead><tr><th>Scenario</th><th>Result</th>"
      "<th class=\"number\">Simulated / s</th><th class=\"number\">Took / "
      "s</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < results.size(); ++i) {
    html += fmt::format(
        "<tr><td><a href=\"#scenario-{}\">{}</a></td>{}<td class=\"number\">{:.3f}</td>"
        "<td class=\"number\">{:.2f}</td></tr>\n",
        i + 1, escaped(results[i].name), status_cell(results[i].status), results[i].end.seconds(),
        results[i].wall_seconds);
  }
  html += "</tbody></table></div>\n";
  for (std::size_t i = 0; i < results.size(); ++i) {
    html += chapter(results[i], i + 1);
  }
  return html + "</body>\n</html>\n";
}

}  // namespace stator::scenario
