// stator simulate: runs an experiment on a motor with its load and compares it with the motor's
// equations.
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/option_values.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/progress.hpp"
#include "stator/cli/simulate/simulation_output.hpp"
#include "stator/cli/temporary_csv.hpp"
#include "stator/experiment/bench_setup.hpp"
#include "stator/experiment/experiment.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace stator::cli {

namespace {

struct SimulateOptions {
  std::string rack_file;
  std::vector<std::string> rack_changes;
  std::string device;
  unsigned axis = 0;
  std::string motor;
  std::map<std::string, std::string> changes;  ///< of the axis, as written
  std::map<std::string, std::string> choices;  ///< of the experiment, as written
  std::string plot;
  std::string csv;
  std::optional<double> tolerance;
};

/// The letters of a unit, so that "N m", "Nm" and "N*m" are the same.
std::string letters(std::string_view unit) {
  std::string result;
  for (const char c : unit) {
    if (c != ' ' && c != '*') {
      result += c;
    }
  }
  return result;
}

/// "0.3", "0.3Nm" or "0.3 N m" with unit "N m". Throws Failure.
double parse_quantity(const std::string& option, const std::string& text, std::string_view unit) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string_view rest(end, static_cast<std::size_t>(text.data() + text.size() - end));
  const std::string suffix = letters(rest);
  if (error != std::errc() || !std::isfinite(value) ||
      (!suffix.empty() && suffix != letters(unit))) {
    throw Failure(unit.empty()
                      ? fmt::format("--{} \"{}\" is no plain number", option, text)
                      : fmt::format("--{} \"{}\" is no number in {}; write e.g. {}", option, text,
                                    unit, fmt::format("1{}", letters(unit))));
  }
  return value;
}

/// The axis of the rack file that is asked for.
experiment::BenchSetup setup_from_rack(const SimulateOptions& options, experiment::MotorKind kind) {
  return experiment::setup_of_axis(
      experiment::bench_devices(
          rack::load_rack_file(options.rack_file, catalogue(), options.rack_changes)),
      kind, {.rack = options.rack_file, .device = options.device, .axis = options.axis});
}

experiment::BenchSetup setup_of(const SimulateOptions& options, experiment::MotorKind kind) {
  experiment::BenchSetup setup =
      options.rack_file.empty() ? experiment::BenchSetup{} : setup_from_rack(options, kind);
  if (!options.motor.empty()) {
    experiment::change_motor(options.motor, kind, setup);
  }
  for (const experiment::AxisQuantity& quantity : experiment::axis_quantities()) {
    const std::string name(quantity.name);
    const auto written = options.changes.find(name);
    if (written != options.changes.end() && !written->second.empty()) {
      experiment::change_quantity(quantity, parse_quantity(name, written->second, quantity.unit),
                                  "--" + name, setup);
    }
  }
  if (kind == experiment::MotorKind::two_phase) {
    setup.module = experiment::module_for_bench(catalogue());
  }
  return setup;
}

void keep(const experiment::Result& result, const SimulateOptions& options) {
  if (!options.csv.empty()) {
    write_csv(result, options.csv);
  }
  if (options.plot.empty()) {
    return;
  }
  if (!options.csv.empty()) {
    draw(result, options.csv, options.plot);
    return;
  }
  const TemporaryCsv data(options.plot);
  write_csv(result, data.path());
  draw(result, data.path(), options.plot);
}

void simulate(const experiment::Experiment& experiment, const SimulateOptions& options) {
  experiment::Choices choices;
  for (const experiment::Option& option : experiment.options) {
    const auto written = options.choices.find(std::string(option.name));
    if (written != options.choices.end() && !written->second.empty()) {
      choices.set(written->first, parse_quantity(written->first, written->second, option.unit));
    }
  }
  const experiment::Result result = [&] {
    Progress progress(fmt::format("measuring {}", experiment.name));
    return experiment.run(setup_of(options, experiment.motor), choices,
                          [&progress](double part) { progress.reached(part); });
  }();
  print_comparisons(result);
  keep(result, options);
  const double worst = 100.0 * result.worst_deviation();
  if (options.tolerance && worst > *options.tolerance) {
    throw Failure(
        fmt::format("{} deviates from its equation by {:.2f} %, more than the tolerance "
                    "of {:g} %",
                    experiment.name, worst, *options.tolerance));
  }
}

void add_axis_options(CLI::App& command, SimulateOptions& options) {
  CLI::Option* const rack =
      command.add_option("rack", options.rack_file, "Rack file whose axis is put on the bench")
          ->check(names(Names::rack_file));
  add_set_option(command, options.rack_changes)->needs(rack);
  command.add_option("--device", options.device, "Device of the rack file; else its first");
  command.add_option("-a,--axis", options.axis, "Axis of the device")->capture_default_str();
  command.add_option("--motor", options.motor,
                     "Motor, e.g. QSH5718-55-30-098 or QBL4208-61-04-013");
  for (const experiment::AxisQuantity& quantity : experiment::axis_quantities()) {
    const std::string name(quantity.name);
    command.add_option("--" + name, options.changes[name], std::string(quantity.help))
        ->option_text(std::string(quantity.unit));
  }
}

void add_experiment_options(CLI::App& command, const experiment::Experiment& experiment,
                            SimulateOptions& options) {
  for (const experiment::Option& option : experiment.options) {
    const std::string unit(option.unit.empty() ? "NUMBER" : option.unit);
    command
        .add_option(fmt::format("--{}", option.name), options.choices[std::string(option.name)],
                    std::string(option.help))
        ->option_text(option.preset ? fmt::format("{} [{:g}]", unit, *option.preset) : unit)
        ->group("Options of the experiment");
  }
}

}  // namespace

void add_simulate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "simulate", "Measure a motor with its load on a test bench and compare it with equations");
  command->require_subcommand(1);
  command->footer(
      "Time is simulated: no bus, no interface, as fast as the machine.\n"
      "Examples:\n"
      "  stator simulate pull-out --motor QSH5718-79-30-163 --supply 48V --plot pull-out.svg\n"
      "  stator simulate move racks/gantry.toml --axis 0 --distance 2rev --plot move.svg\n"
      "  stator simulate resonance --tolerance 2 && echo as the equations say");
  for (const experiment::Experiment& experiment : experiment::experiments()) {
    auto options = std::make_shared<SimulateOptions>();
    CLI::App* one =
        command->add_subcommand(std::string(experiment.name), std::string(experiment.summary));
    add_axis_options(*one, *options);
    add_experiment_options(*one, experiment, *options);
    one->add_option("--plot", options->plot, "Picture to draw, .svg or .png")
        ->check(names(Names::file));
    one->add_option("--csv", options->csv, "File for the curves' values")
        ->check(names(Names::file));
    one->add_option("--tolerance", options->tolerance,
                    "Fail when a measurement deviates by more than so many percent")
        ->check(CLI::Range(0.0, 100.0));
    one->callback([options, &experiment] { simulate(experiment, *options); });
  }
}

}  // namespace stator::cli
