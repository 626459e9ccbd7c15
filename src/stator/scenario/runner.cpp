#include "stator/scenario/runner.hpp"

#include <algorithm>
#include <exception>
#include <memory>

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

/// Samples what is to be drawn while a scenario runs.
class PlotSampler {
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

Outcome run_action(const Step& step, bench::Bench& bench) {
  try {
    return step.action(bench);
  } catch (const bench::TimeLimitReached& reached) {
    return fail(
        fmt::format("the scenario's limit of {} of simulated time is reached; raise "
                    "\"limit\" if it needs more",
                    duration_text(reached.limit)));
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}

void run_steps(const Scenario& scenario, bench::Bench& bench, ScenarioResult& result) {
  for (std::size_t i = 0; i < scenario.steps.size() && result.status == Status::passed; ++i) {
    const Step& step = scenario.steps[i];
    StepResult& step_result = result.steps[i];
    if (!step.looks) {
      bench.begin_deed();
    }
    step_result.begin = bench.now();
    Outcome outcome = run_action(step, bench);
    step_result.end = bench.now();
    step_result.status = outcome.passed ? Status::passed : Status::failed;
    step_result.text = std::move(outcome.text);
    result.status = step_result.status;
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

ScenarioResult run(const Scenario& scenario) {
  ScenarioResult result{scenario.file, scenario.name, scenario.summary};
  for (const Step& step : scenario.steps) {
    result.steps.push_back({step.line, step.kind, step.title});
  }
  try {
    bench::Bench bench(scenario.rack, scenario.limit);
    const PlotSampler sampler(bench, scenario);
    run_steps(scenario, bench, result);
    result.end = bench.now();
    result.plots = sampler.series();
    if (result.status != Status::passed) {
      result.events = last_events(bench.log());
    }
  } catch (const std::exception& error) {
    result.status = Status::error;
    result.error = error.what();
  }
  return result;
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
