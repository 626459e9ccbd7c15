// Runs a scenario and keeps what came of it: status, text and time of each step, plots of signals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/rack/file/rack_file_error.hpp"
#include "stator/scenario/scenario.hpp"

namespace stator::scenario {

enum class Status : std::uint8_t {
  passed,
  failed,
  not_run,  ///< a step behind one that failed
  error,    ///< a scenario that could not be run
};
[[nodiscard]] std::string_view to_text(Status status);

struct StepResult {
  std::uint32_t line = 0;
  std::string kind;
  std::string title;
  Status status = Status::not_run;
  std::string text{};  ///< what was seen, or what was expected and seen instead
  base::SimTime begin{};
  base::SimTime end{};
};

/// A signal over the whole scenario.
struct PlotSeries {
  std::string name;
  std::string unit;
  std::vector<double> times;  ///< s
  std::vector<double> values;
};

/// What a scenario came to.
struct ScenarioResult {
  std::string file;
  std::string name;
  std::string summary;
  Status status = Status::passed;
  std::string error{};  ///< of Status::error: why it could not be run
  std::vector<StepResult> steps{};
  base::SimTime begin{};              ///< simulated time before its first step
  base::SimTime end{};                ///< simulated time behind its last
  double wall_seconds = 0.0;          ///< of the machine; filled in by the caller
  std::vector<std::string> events{};  ///< the last lines of the rack's log; only if it failed
  std::vector<PlotSeries> plots{};

  /// The step that failed; null: none did.
  [[nodiscard]] const StepResult* failed_step() const;
};

/// A scenario on a bench, step after step. What else happens to the bench between two steps is the
/// caller's.
class ScenarioRun {
 public:
  /// From the present moment of `bench`, which is a rack like that of `scenario`; both must outlive
  /// the run. Throws std::runtime_error for plots of signals that are not there.
  ScenarioRun(const Scenario& scenario, bench::Bench& bench);
  ScenarioRun(const ScenarioRun&) = delete;
  ScenarioRun& operator=(const ScenarioRun&) = delete;
  ~ScenarioRun();

  /// Carries out the next step. False: it has failed, or none is left.
  bool step();
  /// What the steps so far came to.
  [[nodiscard]] ScenarioResult result() const;

 private:
  class PlotSampler;

  const Scenario& scenario_;
  bench::Bench& bench_;
  std::unique_ptr<PlotSampler> sampler_;
  ScenarioResult result_;
  std::size_t next_ = 0;
};

/// Runs a scenario in simulated time. Does not throw.
[[nodiscard]] ScenarioResult run(const Scenario& scenario);

/// The result of a scenario file that cannot be read.
[[nodiscard]] ScenarioResult unreadable(const Scenario& scenario,
                                        const std::vector<settings::Problem>& errors);

}  // namespace stator::scenario
