#include <cmath>
#include <string>

#include "stator/base/trigonometry.hpp"
#include "stator/experiment/tuning/tuner.hpp"

namespace stator::experiment::tuning {
namespace {

/// So many of the values, evenly spread, that a picture is fine.
std::vector<double> thinned(const std::vector<double>& values, double factor = 1.0) {
  constexpr std::size_t kShown = 1000;
  const std::size_t stride = 1 + values.size() / kShown;
  std::vector<double> result;
  for (std::size_t n = 0; n < values.size(); n += stride) {
    result.push_back(factor * values[n]);
  }
  return result;
}

Panel step_panel(const StepResponse& response, const std::string& name, const char* unit) {
  constexpr double kMilliseconds = 1e3;
  return {.x_name = "time from the step of " + name,
          .x_unit = "ms",
          .name = name,
          .unit = unit,
          .x = thinned(response.time, kMilliseconds),
          .curves = {{"measured", Curve::Style::measured_line, thinned(response.actual)},
                     {"linear model", Curve::Style::equation, thinned(response.model)}}};
}

std::vector<double> decibels(const std::vector<std::complex<double>>& responses) {
  std::vector<double> result;
  result.reserve(responses.size());
  for (const auto& response : responses) {
    result.push_back(20.0 * std::log10(std::abs(response)));
  }
  return result;
}

/// Degrees without jumps.
std::vector<double> phases(const std::vector<std::complex<double>>& responses) {
  std::vector<double> result;
  result.reserve(responses.size());
  double last = 0.0;
  for (const auto& response : responses) {
    last += std::remainder(std::arg(response) * 180.0 / base::kPi - last, 360.0);
    result.push_back(last);
  }
  return result;
}

void add_bode(Result& result, const BodePlot& plot, const std::string& loop) {
  using Values = std::vector<double> (*)(const std::vector<std::complex<double>>&);
  const auto add = [&](const char* name, const char* unit, Values values) {
    Panel panel{.x_name = "frequency of the " + loop + " target",
                .x_unit = "Hz",
                .name = loop + " " + name,
                .unit = unit,
                .x = plot.frequency,
                .curves = {{"measured", Curve::Style::measured_points, values(plot.measured)},
                           {"linear model", Curve::Style::equation, values(plot.model)}},
                .logarithmic_x = true};
    result.panels.push_back(std::move(panel));
  };
  add("gain", "dB", decibels);
  add("phase", "degree", phases);
}

}  // namespace

Result step_curves(const Verification& verification) {
  Result result;
  result.title = "Steps of the tuned loops";
  result.panels = {step_panel(verification.current_step, "current", "A"),
                   step_panel(verification.velocity_step, "velocity", "rpm"),
                   step_panel(verification.position_step, "position", "rev")};
  return result;
}

Result bode_curves(const Verification& verification) {
  Result result;
  result.title = "The tuned loops, actual value over target";
  add_bode(result, verification.current, "current");
  add_bode(result, verification.velocity, "velocity");
  return result;
}

}  // namespace stator::experiment::tuning
