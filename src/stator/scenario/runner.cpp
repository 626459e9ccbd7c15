#include "stator/scenario/runner.hpp"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "stator/bench/bench.hpp"
#include "stator/rack/observe/recorder.hpp"
#include "stator/rack/observe/signal_tap.hpp"
#include "stator/scenario/step_reader.hpp"

namespace stator::scenario {

namespace {

/// Rows of the signals that are drawn; a scenario that uses up its limit has so many.
constexpr std::int64_t kPlotRows = 20'000;
constexpr std::size_t kEventsTold = 20;

Outcome limit_reached(base::SimDuration limit) {
  return fail(
      fmt::format("the scenario's limit of {} of simulated time is reached; raise "
                  "\"limit\" if it needs more",
                  duration_text(limit)));
}

Outcome run_action(const Step& step, bench::Bench& bench, base::SimDuration limit) {
  try {
    return step.action(bench);
  } catch (const bench::TimeLimitReached& reached) {
    return reached.limit == limit
               ? limit_reached(limit)
               : fail(fmt::format("the rack's limit of {} of simulated time is reached",
                                  duration_text(reached.limit)));
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}

std::vector<std::string> last_events(const rack::EventLog& log) {
  std::vector<std::string> lines;
  const std::uint64_t total = log.total();
  log.visit(total - std::min<std::uint64_t>(total, kEventsTold),
            [&](std::uint64_t, const base::Event& event) {
              lines.push_back(fmt::format("{:12.6f} s  {}", event.time.seconds(), log.line(event)));
              return true;
            });
  return lines;
}

/// The result before the first step.
ScenarioResult not_begun(const Scenario& scenario) {
  ScenarioResult result{scenario.file, scenario.name, scenario.summary};
  for (const Step& step : scenario.steps) {
    result.steps.push_back({step.line, step.kind, step.title});
  }
  return result;
}

}  // namespace

std::string_view to_text(Status status) {
  switch (status) {
    case Status::passed:
      return "passed";
    case Status::failed:
      return "failed";
    case Status::not_run:
      return "not run";
    case Status::error:
      return "error";
  }
  return "?";
}

const StepResult* ScenarioResult::failed_step() const {
  const auto found = std::ranges::find(steps, Status::failed, &StepResult::status);
  return found != steps.end() ? &*found : nullptr;
}

/// Samples what is to be drawn while a scenario runs.
class ScenarioRun::PlotSampler {
 public:
  PlotSampler(bench::Bench& bench, const Scenario& scenario) : bench_(bench) {
    if (scenario.plots.empty()) {
      return;
    }
    const base::SimDuration share(scenario.limit.nanoseconds() / kPlotRows);
    tap_ = std::make_unique<rack::SignalTap>(
        rack::select_signals(bench.rack().signals(), scenario.plots),
        std::max(share, bench.configuration().cycle), std::size_t{kPlotRows} + 1);
    bench.rack().add(*tap_, bench.now());
  }
  PlotSampler(const PlotSampler&) = delete;
  PlotSampler& operator=(const PlotSampler&) = delete;
  ~PlotSampler() {
    if (tap_ != nullptr) {
      bench_.rack().remove(*tap_);
    }
  }

  [[nodiscard]] std::vector<PlotSeries> series() const {
    std::vector<PlotSeries> all;
    for (std::size_t i = 0; tap_ != nullptr && i < tap_->signals().size(); ++i) {
      PlotSeries series{tap_->signals()[i].name, tap_->signals()[i].unit, {}, {}};
      for (std::size_t row = 0; row < tap_->size(); ++row) {
        series.times.push_back(tap_->time(row).seconds());
        series.values.push_back(tap_->values(row)[i]);
      }
      all.push_back(std::move(series));
    }
    return all;
  }

 private:
  bench::Bench& bench_;
  std::unique_ptr<rack::SignalTap> tap_;
};

ScenarioRun::ScenarioRun(const Scenario& scenario, bench::Bench& bench)
    : scenario_(scenario),
      bench_(bench),
      sampler_(std::make_unique<PlotSampler>(bench, scenario)),
      result_(not_begun(scenario)) {
  result_.begin = bench.now();
}

ScenarioRun::~ScenarioRun() = default;

bool ScenarioRun::step() {
  if (result_.status != Status::passed || next_ >= scenario_.steps.size()) {
    return false;
  }
  const Step& step = scenario_.steps[next_];
  StepResult& step_result = result_.steps[next_++];
  if (!step.looks) {
    bench_.begin_deed();
  }
  step_result.begin = bench_.now();
  Outcome outcome = run_action(step, bench_, scenario_.limit);
  step_result.end = bench_.now();
  // A bench that was there before may have another limit.
  if (outcome.passed && step_result.end - result_.begin > scenario_.limit) {
    outcome = limit_reached(scenario_.limit);
  }
  step_result.status = outcome.passed ? Status::passed : Status::failed;
  step_result.text = std::move(outcome.text);
  result_.status = step_result.status;
  return outcome.passed;
}

ScenarioResult ScenarioRun::result() const {
  ScenarioResult result = result_;
  result.end = bench_.now();
  result.plots = sampler_->series();
  if (result.status != Status::passed) {
    result.events = last_events(bench_.log());
  }
  return result;
}

ScenarioResult run(const Scenario& scenario) {
  try {
    bench::Bench bench(scenario.rack, scenario.limit);
    ScenarioRun run(scenario, bench);
    while (run.step()) {
    }
    return run.result();
  } catch (const std::exception& error) {
    ScenarioResult result = not_begun(scenario);
    result.status = Status::error;
    result.error = error.what();
    return result;
  }
}

ScenarioResult unreadable(const Scenario& scenario, const std::vector<settings::Problem>& errors) {
  ScenarioResult result{scenario.file, scenario.name, scenario.summary};
  result.status = Status::error;
  for (const settings::Problem& error : errors) {
    result.error += (result.error.empty() ? "" : "\n") + std::string(error.what());
  }
  return result;
}

}  // namespace stator::scenario
