#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/interpreter/registers.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

/// One instruction of a program that was executed.
struct ProgramStep {
  base::SimTime time;  ///< when it was through; a WAIT that held the program: when it let go
  std::uint16_t address = 0;
  Instruction instruction;
  Status status = Status::success;
};

/// Observes the instructions of a program: traces, breakpoints, profiles. Without an observer a
/// program runs in code that does not look for one.
class ProgramObserver {
 public:
  ProgramObserver() = default;
  ProgramObserver(const ProgramObserver&) = delete;
  ProgramObserver& operator=(const ProgramObserver&) = delete;
  virtual ~ProgramObserver() = default;

  /// Asked before every instruction but the first after a start or a step, so that a program goes
  /// on from a breakpoint. False: the program stops before it.
  [[nodiscard]] virtual bool may_execute(base::SimTime /*now*/, std::uint16_t /*address*/,
                                         const Instruction& /*instruction*/) {
    return true;
  }
  /// `registers` as the instruction left them.
  virtual void executed(const ProgramStep& /*step*/, const Registers& /*registers*/) {}
};

}  // namespace stator::tmcl
