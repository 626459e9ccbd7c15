// Scenarios: stator._native.run_scenario and what they come to, stator._native.ScenarioReport.
#include <any>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "configuration.hpp"
#include "device_behaviour.hpp"
#include "errors.hpp"
#include "event_record.hpp"
#include "session.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/file/rack_file_steps.hpp"
#include "stator/scenario/report.hpp"
#include "stator/scenario/runner.hpp"
#include "stator/scenario/scenario_file.hpp"
#include "values.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

using scenario::PlotSeries;
using scenario::ScenarioRead;
using scenario::ScenarioResult;
using scenario::StepResult;

/// What a scenario came to, with all events that the rack had to tell meanwhile.
struct ScenarioReport {
  ScenarioResult result;
  std::vector<EventRecord> events;

  [[nodiscard]] bool passed() const { return result.status == scenario::Status::passed; }
};

/// A run with a place in a rack, which ends before the rack does or is another.
class RunGuest final : public Guest {
 public:
  RunGuest(const scenario::Scenario& scenario, bench::Bench& bench)
      : run_(std::in_place, scenario, bench) {}
  void leave() override { run_.reset(); }
  void step_aside() override { run_.reset(); }
  [[nodiscard]] std::any remember() const override { return {}; }
  void recall(const std::any& /*memory*/, bench::Bench::Past& /*past*/) override {}

  /// Throws std::runtime_error if it has ended.
  [[nodiscard]] scenario::ScenarioRun& run() {
    if (!run_) {
      throw std::runtime_error(
          "the rack was brought to another moment, which has ended the scenario on it");
    }
    return *run_;
  }

 private:
  std::optional<scenario::ScenarioRun> run_;
};

/// A scenario as a tree, and the name of its file.
struct ScenarioText {
  settings::Value tree;
  std::string name;
};

ScenarioText read_text(nb::handle source) {
  if (is_path(source)) {
    const std::string path = path_of(source);
    const nb::gil_scoped_release released;
    return {rack::parse_rack_tree(rack::read_rack_text(path, "scenario file"), path), path};
  }
  return {settings::Value(to_table(source)), ""};
}

/// Throws RackFileMistakes.
scenario::Scenario require_read(ScenarioRead read) {
  if (!read.errors.empty()) {
    throw RackFileMistakes(read.errors);
  }
  if (read.scenario.name.empty()) {
    read.scenario.name = "scenario";
  }
  return std::move(read.scenario);
}

/// Ends a run for which something goes wrong.
void give_up(Session& session, RunGuest& guest) {
  const nb::gil_scoped_release released;
  try {
    session.held_without_interpreter([&guest] { guest.leave(); });
  } catch (const std::runtime_error&) {
    // The rack is closed; the guest has left.
  }
}

ScenarioReport run_on(Session& session, const scenario::Scenario& scenario) {
  std::shared_ptr<RunGuest> guest;
  std::uint64_t before = 0;
  session.held([&] {
    guest = std::make_shared<RunGuest>(scenario, session.bench());
    session.admit(guest);
    before = session.log().total();
  });
  try {
    while (session.held([&guest] { return guest->run().step(); })) {
      if (PyErr_CheckSignals() != 0) {
        throw nb::python_error();
      }
    }
    return session.held([&] {
      ScenarioReport report{guest->run().result(), events_of(session.log(), before)};
      guest->leave();
      return report;
    });
  } catch (...) {
    give_up(session, *guest);
    throw;
  }
}

ScenarioReport run_scenario(nb::handle source, const std::vector<std::string>& changes) {
  ScenarioText read = read_text(source);
  const scenario::Scenario scenario = [&] {
    const nb::gil_scoped_release released;
    return require_read(scenario::read_scenario_tree(std::move(read.tree), read.name,
                                                     devices::products(), changes));
  }();
  const std::shared_ptr<Session> session = [&] {
    const nb::gil_scoped_release released;
    return std::make_shared<Session>(
        Source{}, scenario.rack,
        Session::Options{.limit = scenario.limit,
                         .signals = {},
                         .recording = {},
                         .failure = std::make_shared<DeviceFailure>()});
  }();
  return run_on(*session, scenario);
}

ScenarioReport run_scenario_on(Session& session, nb::handle source,
                               const std::vector<std::string>& changes) {
  ScenarioText read = read_text(source);
  const scenario::Scenario scenario = [&] {
    return session.held([&] {
      return require_read(scenario::read_scenario_tree(std::move(read.tree), read.name,
                                                       session.bench().configuration(), changes));
    });
  }();
  return run_on(session, scenario);
}

/// As `stator test` prints a scenario that failed; empty: it passed.
std::string failure_of(const ScenarioReport& report) {
  const StepResult* const failed = report.result.failed_step();
  if (failed == nullptr) {
    return "";
  }
  const std::string place = report.result.file.empty()
                                ? report.result.name
                                : fmt::format("{}:{}", report.result.file, failed->line);
  std::string text =
      fmt::format("{}: {}: {}\n  {}", place, failed->kind, failed->title, failed->text);
  for (const std::string& line : report.result.events) {
    text += "\n  " + line;
  }
  return text;
}

void require(const ScenarioReport& report) {
  if (!report.passed()) {
    PyErr_SetString(PyExc_AssertionError, failure_of(report).c_str());
    throw nb::python_error();
  }
}

std::string status_of(scenario::Status status) {
  return std::string(scenario::to_text(status));
}

void bind_steps(nb::module_& module) {
  nb::class_<StepResult>(module, "ScenarioStep", "A step of a scenario, and what it came to.")
      .def_prop_ro(
          "line", [](const StepResult& step) { return step.line; },
          "Of the scenario file, from 1; 0: the scenario is in no file.")
      .def_prop_ro(
          "kind", [](const StepResult& step) { return step.kind; }, "The word behind `do`.")
      .def_prop_ro(
          "title", [](const StepResult& step) { return step.title; },
          "Its note, else what it does in words.")
      .def_prop_ro(
          "status", [](const StepResult& step) { return status_of(step.status); },
          "\"passed\", \"failed\", or \"not run\" behind one that failed.")
      .def_prop_ro(
          "text", [](const StepResult& step) { return step.text; },
          "What was seen; of a step that failed also what was expected.")
      .def_prop_ro(
          "begin", [](const StepResult& step) { return step.begin.seconds(); },
          "Simulated time, s.")
      .def_prop_ro(
          "end", [](const StepResult& step) { return step.end.seconds(); }, "Simulated time, s.")
      .def("__repr__", [](const StepResult& step) {
        return fmt::format("<ScenarioStep {}: {}: {}{}{}>", scenario::to_text(step.status),
                           step.kind, step.title, step.text.empty() ? "" : "; ", step.text);
      });
  nb::class_<PlotSeries>(module, "ScenarioCurve",
                         "A signal over a scenario, one of those behind its key `plot`.")
      .def_prop_ro(
          "name", [](const PlotSeries& series) { return series.name; },
          "With the device in front, e.g. \"x.axis0.shaft_speed\".")
      .def_prop_ro(
          "unit", [](const PlotSeries& series) { return series.unit; },
          "E.g. \"rev/s\"; empty for plain numbers.")
      .def_prop_ro(
          "times", [](const PlotSeries& series) { return array_of(series.times); },
          nb::sig("def times(self, /) -> numpy.typing.NDArray[numpy.float64]"),
          "When the samples were taken, in simulated seconds.")
      .def_prop_ro(
          "values", [](const PlotSeries& series) { return array_of(series.values); },
          nb::sig("def values(self, /) -> numpy.typing.NDArray[numpy.float64]"),
          "A sample for each of times.")
      .def("__repr__", [](const PlotSeries& series) {
        return fmt::format("<ScenarioCurve {}, {} samples>", series.name, series.values.size());
      });
}

void bind_report(nb::module_& module) {
  nb::class_<ScenarioReport>(module, "ScenarioReport", "What a scenario came to.")
      .def_prop_ro(
          "file", [](const ScenarioReport& self) { return self.result.file; },
          "As it was named; empty: the scenario is in no file.")
      .def_prop_ro(
          "name", [](const ScenarioReport& self) { return self.result.name; },
          "What the scenario shows.")
      .def_prop_ro(
          "summary", [](const ScenarioReport& self) { return self.result.summary; },
          "What it is good for.")
      .def_prop_ro("passed", &ScenarioReport::passed, "Whether all steps did.")
      .def_prop_ro(
          "verdict", [](const ScenarioReport& self) { return status_of(self.result.status); },
          "\"passed\" or \"failed\".")
      .def_prop_ro(
          "steps", [](const ScenarioReport& self) { return self.result.steps; },
          "All of them, in order.")
      .def_prop_ro(
          "failed_step",
          [](const ScenarioReport& self) -> std::optional<StepResult> {
            const StepResult* const failed = self.result.failed_step();
            return failed != nullptr ? std::optional(*failed) : std::nullopt;
          },
          "The step that failed; None: all passed.")
      .def_prop_ro(
          "begin", [](const ScenarioReport& self) { return self.result.begin.seconds(); },
          "Simulated time of its rack before the first step, s.")
      .def_prop_ro(
          "end", [](const ScenarioReport& self) { return self.result.end.seconds(); },
          "Simulated time of its rack at the end, s.")
      .def_ro("events", &ScenarioReport::events,
              "What devices and networks had to say meanwhile, the oldest first: the newest "
              "thousand.")
      .def_prop_ro(
          "curves", [](const ScenarioReport& self) { return self.result.plots; },
          "The signals behind the scenario's key `plot`.")
      .def_prop_ro("failure", &failure_of,
                   "What failed, as `stator test` tells it: step, what was expected and seen, and "
                   "the last events; empty: nothing.")
      .def("require", &require, "Raises AssertionError with the text of `failure`, if it failed.")
      .def(
          "html",
          [](const ScenarioReport& self) {
            return scenario::html_report(std::span(&self.result, 1));
          },
          "The report as a page that needs nothing else, as `stator test --html` writes it.")
      .def(
          "junit",
          [](const ScenarioReport& self) {
            return scenario::junit_report(std::span(&self.result, 1));
          },
          "The report as JUnit XML, as `stator test --junit` writes it.")
      .def("__repr__", [](const ScenarioReport& self) {
        return fmt::format("<ScenarioReport {}: {}>", self.result.name,
                           scenario::to_text(self.result.status));
      });
}

}  // namespace

void bind_scenarios(nb::module_& module) {
  bind_steps(module);
  bind_report(module);
  module.def("run_scenario", &run_scenario, "source"_a, "changes"_a = std::vector<std::string>{},
             "Runs a scenario on a rack of its own; see stator.run_scenario.");
  module.def("run_scenario_on", &run_scenario_on, "rack"_a, "source"_a,
             "changes"_a = std::vector<std::string>{},
             "Runs the steps of a scenario on a rack; see stator.Rack.run_scenario.");
}

}  // namespace stator::python
