#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/tmcl/interpreter/interpreter.hpp"
#include "stator/tmcl/interpreter/program_observer.hpp"
#include "stator/tmcl_tools/tmcl_source.hpp"

namespace stator::tmcl_tools {

/// Where a program spends its time: executions and simulated time of every instruction and of every
/// subroutine. An instruction's time is the time since the one before it; that of a WAIT is as long
/// as it holds the program.
class TmclProfile final : public tmcl::ProgramObserver {
 public:
  struct Cost {
    std::uint64_t executions = 0;  ///< of a subroutine: calls
    std::uint64_t refused = 0;
    base::SimDuration time;
  };

  /// For a program that is started at `start`.
  TmclProfile(const tmcl::ModuleDescription& module, base::SimTime start)
      : instructions_(module.program_length), subroutines_(module.program_length), last_(start) {}

  void executed(const tmcl::ProgramStep& step, const tmcl::Registers& registers) override;

  [[nodiscard]] const Cost& at(std::size_t address) const { return instructions_[address]; }
  /// Of the subroutine that begins at `address`, with those it calls; calls that are open do not
  /// count, nor does the time of calls within a call of the same.
  [[nodiscard]] const Cost& subroutine(std::size_t address) const { return subroutines_[address]; }

  /// Tables of the instructions and subroutines that were executed, the costliest first.
  [[nodiscard]] std::string text(const TmclSource& source) const;

 private:
  struct Call {
    std::size_t target = 0;
    base::SimTime begin;
  };

  void follow_calls(const tmcl::ProgramStep& step);

  std::vector<Cost> instructions_;
  std::vector<Cost> subroutines_;
  std::array<Call, tmcl::Interpreter::kStackDepth> calls_{};
  std::size_t depth_ = 0;
  base::SimTime last_;
};

}  // namespace stator::tmcl_tools
