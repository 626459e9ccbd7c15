#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/tmcl/interpreter/program_observer.hpp"
#include "stator/tmcl_tools/tmcl_bench.hpp"
#include "stator/tmcl_tools/tmcl_debug_values.hpp"
#include "stator/tmcl_tools/tmcl_source.hpp"

namespace stator::tmcl_tools {

/// Where a program is to be held: before a command, or after what changed a value.
struct StopPoint {
  int number = 0;
  std::optional<std::size_t> address{};  ///< of a breakpoint
  std::string expression{};              ///< of a watchpoint
  std::int64_t value = 0;                ///< of the expression, as last seen
  std::string condition{};               ///< empty: always
  bool enabled = true;
  bool temporary = false;
  std::uint64_t ignore = 0;  ///< hits to pass over
  std::uint64_t hits = 0;
};

enum class StopCause : std::uint8_t {
  breakpoint,
  watchpoint,
  place_reached,  ///< of a step, or of "until" and its like
  refused,        ///< a command of the program
  ended,          ///< the program does not run any more
  time_up,
  interrupted,
};

/// Why a program is held.
struct Stop {
  StopCause cause = StopCause::place_reached;
  int number = 0;              ///< of the stop point
  std::int64_t old_value = 0;  ///< of a watchpoint
  std::int64_t new_value = 0;
};

/// Runs a program under supervision. While it is held simulated time stands still for the module
/// and its motor as well, so that a program behaves in the debugger as it does without.
class TmclDebugger final : private tmcl::ProgramObserver {
 public:
  using Error = std::string;  ///< one sentence

  /// Makes the module and stands before the program's first command at time 0. `changes` are made
  /// in each run at their times. Throws Failure when one of them cannot be made.
  TmclDebugger(MakeTmclModule make_module, TmclSource source, std::vector<InputChange> changes);

  /// The same once more with a module as new; stop points stay.
  void restart();

  [[nodiscard]] const TmclSource& source() const { return source_; }
  [[nodiscard]] TmclBench& bench() { return *bench_; }
  [[nodiscard]] const TmclBench& bench() const { return *bench_; }
  [[nodiscard]] TmclDebugValues& values() { return *values_; }
  /// Of the command that comes next, or that holds the program in a WAIT.
  [[nodiscard]] std::size_t address() const { return bench_->firmware().state().program_counter; }
  [[nodiscard]] std::size_t depth() const { return bench_->firmware().interpreter().stack_depth(); }
  /// The instruction that was executed last.
  [[nodiscard]] const tmcl::ProgramStep& last_step() const { return last_step_; }

  /// @name Going on
  /// @{

  /// Restarts and goes on to the first stop point.
  Stop run();
  /// To the end of the next `count` instructions; a WAIT takes as long as it takes.
  Stop step(std::uint64_t count);
  /// The same, a subroutine being one instruction.
  Stop next(std::uint64_t count);
  /// To the return from the present subroutine.
  Stop finish();
  /// Beyond the present command in this subroutine: through a loop.
  Stop until_below();
  Stop until(std::size_t address);
  /// To the next stop point, or to `limit`.
  Stop resume(base::SimTime limit = base::SimTime::never());
  /// Goes on at `address` with an empty stack.
  Stop jump(std::size_t address);
  /// @}

  /// @name Stop points
  /// @{

  /// An error if the condition has no value now.
  [[nodiscard]] base::Expected<int, Error> add_breakpoint(std::size_t address,
                                                          const std::string& condition,
                                                          bool temporary);
  [[nodiscard]] base::Expected<int, Error> add_watchpoint(const std::string& expression);
  /// Null if there is none of that number.
  [[nodiscard]] StopPoint* find_stop_point(int number);
  bool remove_stop_point(int number);
  void remove_all_stop_points() { stop_points_.clear(); }
  [[nodiscard]] const std::vector<StopPoint>& stop_points() const { return stop_points_; }
  [[nodiscard]] bool has_breakpoint(std::size_t address) const;
  /// Whether a command that is refused holds the program.
  void stop_on_refusal(bool stop) { stop_on_refusal_ = stop; }
  /// @}

  /// Asked from time to time while the program runs; true: it is held.
  void set_interruption(std::function<bool()> interrupted) {
    interrupted_ = std::move(interrupted);
  }

 private:
  using Reached = std::function<bool()>;

  void executed(const tmcl::ProgramStep& step, const tmcl::Registers& registers) override;
  Stop run_until(const Reached& reached, base::SimTime limit = base::SimTime::never());
  Stop repeat(std::uint64_t count, const std::function<Stop()>& once);
  [[nodiscard]] std::optional<Stop> changed_watchpoint();
  [[nodiscard]] std::optional<Stop> hit_breakpoint();
  [[nodiscard]] bool counts(StopPoint& point);
  [[nodiscard]] bool watches() const;

  MakeTmclModule make_module_;
  TmclSource source_;
  std::vector<InputChange> changes_;
  std::unique_ptr<TmclBench> bench_;
  std::unique_ptr<TmclDebugValues> values_;
  std::vector<StopPoint> stop_points_;
  int last_number_ = 0;
  bool stop_on_refusal_ = false;
  std::function<bool()> interrupted_;
  tmcl::ProgramStep last_step_;
};

}  // namespace stator::tmcl_tools
