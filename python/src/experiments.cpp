// Experiments on a test bench: stator._native.simulate and what they measure.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "configuration.hpp"
#include "stator/base/trigonometry.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/experiment/bench_setup.hpp"
#include "stator/experiment/experiment.hpp"
#include "stator/settings/words.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

using experiment::Comparison;
using experiment::Curve;
using experiment::Experiment;
using experiment::ExperimentError;
using experiment::Panel;
using experiment::Result;

/// A unit of an option, and the one of Python's arguments, which is an SI unit.
struct SiUnit {
  std::string_view unit;
  std::string_view si;
  double factor;
};
constexpr std::array kSiUnits{SiUnit{"us", "s", 1e-6},
                              SiUnit{"ms", "s", 1e-3},
                              SiUnit{"rpm", "rad/s", base::kTwoPi / 60.0},
                              SiUnit{"rev/s", "rad/s", base::kTwoPi},
                              SiUnit{"rev/s2", "rad/s2", base::kTwoPi},
                              SiUnit{"rev", "rad", base::kTwoPi}};

SiUnit si_unit_of(std::string_view unit) {
  const auto* const found = std::ranges::find(kSiUnits, unit, &SiUnit::unit);
  return found != kSiUnits.end() ? *found : SiUnit{unit, unit, 1.0};
}

/// As Python writes the name of an argument.
std::string argument_name(std::string_view name) {
  std::string result(name);
  std::ranges::replace(result, '-', '_');
  return result;
}

/// An option in Python's terms.
struct Argument {
  std::string name;
  std::string unit;
  std::string help;
  double minimum = 0.0;
  double maximum = 0.0;
  std::optional<double> preset;
};

Argument argument_of(const experiment::Option& option) {
  const SiUnit unit = si_unit_of(option.unit);
  Argument argument{.name = argument_name(option.name),
                    .unit = std::string(unit.si),
                    .help = std::string(option.help),
                    .minimum = unit.factor * option.minimum,
                    .maximum = unit.factor * option.maximum,
                    .preset = option.preset};
  if (argument.preset) {
    *argument.preset *= unit.factor;
  }
  return argument;
}

std::vector<Argument> arguments_of(const Experiment& experiment) {
  std::vector<Argument> all;
  for (const experiment::Option& option : experiment.options) {
    all.push_back(argument_of(option));
  }
  return all;
}

/// The options in the units of the experiment. Throws ExperimentError in Python's terms.
experiment::Choices choices_of(const Experiment& experiment,
                               const std::map<std::string, double>& options) {
  std::set<std::string> names;
  for (const experiment::Option& option : experiment.options) {
    names.insert(argument_name(option.name));
  }
  experiment::Choices choices;
  for (const auto& [name, value] : options) {
    const auto option = std::ranges::find_if(
        experiment.options,
        [&name](const experiment::Option& each) { return argument_name(each.name) == name; });
    if (option == experiment.options.end()) {
      throw ExperimentError(fmt::format("{} has no option \"{}\"{}; it has: {}", experiment.name,
                                        name, settings::guess_text(name, names),
                                        settings::joined(names)));
    }
    const Argument argument = argument_of(*option);
    if (!(value >= argument.minimum && value <= argument.maximum)) {
      throw ExperimentError(fmt::format("{} is {:g} {}; it must lie in {:g} .. {:g}", name, value,
                                        argument.unit, argument.minimum, argument.maximum));
    }
    // What lies at an end of the range does so in both units.
    choices.set(std::string(option->name), std::clamp(value / si_unit_of(option->unit).factor,
                                                      option->minimum, option->maximum));
  }
  return choices;
}

/// What is asked for around the axis, by names of Python's arguments.
void change_quantities(const std::map<std::string, double>& quantities,
                       experiment::BenchSetup& setup) {
  for (const experiment::AxisQuantity& quantity : experiment::axis_quantities()) {
    const std::string name = argument_name(quantity.name);
    if (const auto wanted = quantities.find(name); wanted != quantities.end()) {
      experiment::change_quantity(quantity, wanted->second, name, setup);
    }
  }
}

/// Has Ctrl-C end what goes on.
void look_for_interruption(double /*part*/) {
  const nb::gil_scoped_acquire interpreter;
  if (PyErr_CheckSignals() != 0) {
    throw nb::python_error();
  }
}

Result simulate(const std::string& name, nb::handle rack, const std::string& device, unsigned axis,
                const std::string& motor, const std::map<std::string, double>& quantities,
                const std::map<std::string, double>& options,
                const std::vector<std::string>& changes) {
  const Experiment& experiment = experiment::require_experiment(name);
  const experiment::Choices choices = choices_of(experiment, options);
  experiment::BenchSetup setup;
  if (!rack.is_none()) {
    setup = experiment::setup_of_axis(experiment::bench_devices(configuration_of(rack, changes)),
                                      experiment.motor,
                                      {.rack = called(rack), .device = device, .axis = axis});
  }
  if (!motor.empty()) {
    experiment::change_motor(motor, experiment.motor, setup);
  }
  change_quantities(quantities, setup);
  if (experiment.motor == experiment::MotorKind::two_phase) {
    setup.module = experiment::module_for_bench(devices::products());
  }
  const nb::gil_scoped_release released;
  return experiment.run(setup, choices, look_for_interruption);
}

std::string style_of(const Curve& curve) {
  switch (curve.style) {
    case Curve::Style::measured_line:
      return "line";
    case Curve::Style::measured_points:
      return "points";
    case Curve::Style::equation:
      break;
  }
  return "equation";
}

void require(const Result& result, double tolerance) {
  if (!(result.worst_deviation() > tolerance)) {
    return;
  }
  std::string text = fmt::format(
      "{}: more than the tolerance of {:g} off the equations:", result.title, tolerance);
  for (const Comparison& comparison : result.comparisons) {
    if (comparison.judged && std::fabs(comparison.deviation()) > tolerance) {
      text += fmt::format("\n  {}: measured {:.5g} {}, equation {:.5g} {}, deviation {:+.4f}",
                          comparison.quantity, comparison.measured, comparison.unit,
                          comparison.equation, comparison.unit, comparison.deviation());
    }
  }
  PyErr_SetString(PyExc_AssertionError, text.c_str());
  throw nb::python_error();
}

void bind_descriptions(nb::module_& module) {
  nb::class_<Argument>(module, "ExperimentOption", "A number that an experiment can be given.")
      .def_ro("name", &Argument::name, "The keyword of stator.simulate.")
      .def_ro("unit", &Argument::unit, "E.g. \"rad/s\"; empty: a plain number.")
      .def_ro("help", &Argument::help, "What it is.")
      .def_ro("minimum", &Argument::minimum, "The least that is taken.")
      .def_ro("maximum", &Argument::maximum, "The most that is taken.")
      .def_ro("preset", &Argument::preset,
              "What it is when nothing is said; None: it is derived from the axis.")
      .def("__repr__", [](const Argument& argument) {
        return fmt::format("<ExperimentOption {} / {}: {}>", argument.name,
                           argument.unit.empty() ? "1" : argument.unit, argument.help);
      });
  nb::class_<Experiment>(module, "Experiment", "An experiment of the test bench.")
      .def_prop_ro(
          "name", [](const Experiment& self) { return std::string(self.name); },
          "For stator.simulate.")
      .def_prop_ro(
          "summary", [](const Experiment& self) { return std::string(self.summary); },
          "What is measured.")
      .def_prop_ro(
          "motor",
          [](const Experiment& self) {
            return std::string(self.motor == experiment::MotorKind::two_phase ? "stepper"
                                                                              : "three-phase");
          },
          "Which kind of motor: \"stepper\" or \"three-phase\".")
      .def_prop_ro("options", &arguments_of, "What it can be given.")
      .def("__repr__", [](const Experiment& self) {
        return fmt::format("<Experiment {}: {}>", self.name, self.summary);
      });
}

void bind_curves(nb::module_& module) {
  nb::class_<Curve>(module, "ExperimentCurve", "A curve over the x values of its panel.")
      .def_ro("title", &Curve::title, "What it is, e.g. \"measured\".")
      .def_prop_ro("style", &style_of,
                   "\"line\" and \"points\" are measured, \"equation\" is from a formula.")
      .def_prop_ro(
          "values", [](const Curve& self) { return array_of(self.values); },
          nb::sig("def values(self, /) -> numpy.typing.NDArray[numpy.float64]"),
          "In the unit of the panel, one for each of its x; NaN where there is none.")
      .def("__repr__", [](const Curve& self) {
        return fmt::format("<ExperimentCurve {}, {} values>", self.title, self.values.size());
      });
  nb::class_<Panel>(module, "ExperimentPanel", "Curves over a common x axis.")
      .def_ro("name", &Panel::name, "Of the vertical axis.")
      .def_ro("unit", &Panel::unit, "Of the vertical axis.")
      .def_ro("x_name", &Panel::x_name, "Of the horizontal axis.")
      .def_ro("x_unit", &Panel::x_unit, "Of the horizontal axis.")
      .def_prop_ro(
          "x", [](const Panel& self) { return array_of(self.x); },
          nb::sig("def x(self, /) -> numpy.typing.NDArray[numpy.float64]"),
          "Along the horizontal axis, in x_unit.")
      .def_prop_ro(
          "curves", [](const Panel& self) { return self.curves; }, "Over x.")
      .def("__repr__", [](const Panel& self) {
        return fmt::format("<ExperimentPanel {} / {} over {} / {}>", self.name, self.unit,
                           self.x_name, self.x_unit);
      });
}

void bind_result(nb::module_& module) {
  nb::class_<Comparison>(module, "Comparison",
                         "A quantity that was measured beside what the equations say of it.")
      .def_ro("quantity", &Comparison::quantity,
              "What and where, e.g. \"pull-out torque at 12 rev/s\".")
      .def_ro("unit", &Comparison::unit, "Of both values.")
      .def_ro("measured", &Comparison::measured, "On the bench.")
      .def_ro("equation", &Comparison::equation, "By the formula.")
      .def_prop_ro("deviation", &Comparison::deviation,
                   "How much more was measured, as a share: 0.01 is 1 %.")
      .def_ro("judged", &Comparison::judged,
              "False: outside the range in which the equation claims to hold.")
      .def("__repr__", [](const Comparison& self) {
        return fmt::format("<Comparison {}: {:.5g} {}, equation {:.5g} {}>", self.quantity,
                           self.measured, self.unit, self.equation, self.unit);
      });
  nb::class_<Result>(module, "Simulation", "What an experiment measured.")
      .def_ro("title", &Result::title, "What was measured, on which motor.")
      .def_ro("remarks", &Result::remarks, "A sentence each: what was set, where an equation ends.")
      .def_prop_ro(
          "comparisons", [](const Result& self) { return self.comparisons; },
          "Measured quantities beside the equations.")
      .def_prop_ro(
          "panels", [](const Result& self) { return self.panels; }, "Curves, for a plot.")
      .def_prop_ro("worst_deviation", &Result::worst_deviation,
                   "The largest of those that are judged, without sign, as a share.")
      .def("require", &require, "tolerance"_a,
           "Raises AssertionError with a sentence for each quantity that deviates by more than "
           "this share, and is judged.")
      .def("__repr__",
           [](const Result& self) { return fmt::format("<Simulation {}>", self.title); });
}

}  // namespace

void bind_experiments(nb::module_& module) {
  bind_descriptions(module);
  bind_curves(module);
  bind_result(module);
  module.def(
      "experiments",
      [] {
        const auto all = experiment::experiments();
        return std::vector<Experiment>(all.begin(), all.end());
      },
      "All experiments of the test bench.");
  module.def("simulate", &simulate, "name"_a, "rack"_a.none(), "device"_a, "axis"_a, "motor"_a,
             "quantities"_a, "options"_a, "changes"_a,
             nb::sig("def simulate(name: str, rack: object, device: str, axis: int, motor: str, "
                     "quantities: dict[str, float], options: dict[str, float], changes: list[str]) "
                     "-> Simulation"),
             "Runs an experiment; see stator.simulate.");
}

}  // namespace stator::python
