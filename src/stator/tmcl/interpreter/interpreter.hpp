#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/tmcl/interpreter/command_executor.hpp"
#include "stator/tmcl/interpreter/eeprom_keeper.hpp"
#include "stator/tmcl/interpreter/firmware_state.hpp"
#include "stator/tmcl/interpreter/program_memory.hpp"
#include "stator/tmcl/interpreter/program_observer.hpp"
#include "stator/tmcl/module/module.hpp"

namespace stator::tmcl {

/// One tick of WAIT (L4051).
inline constexpr base::SimDuration kWaitTick{10'000'000};

/// Runs the program in the memory: one instruction in every pass, passes at a fixed distance from
/// the start on (A85). Passive: passes are made up for when the time is told.
///
/// An instruction that is refused, as in direct mode it would be, changes nothing; the program goes
/// on with the next. A program that runs past the end of the memory stops.
class Interpreter {
 public:
  static constexpr std::size_t kStackDepth = 8;

  /// All must outlive the interpreter. `pass`: time from one instruction to the next, at least 1
  /// ns.
  Interpreter(Module& module, FirmwareState& state, const ProgramMemory& memory,
              CommandExecutor& executor, base::SimDuration pass, base::EventReporter reporter);

  /// Starts where the program counter is; no effect while the program runs (A86).
  void run(base::SimTime now);
  /// Starts at `address`, which must be within the memory, with an empty stack.
  void run_from(std::uint16_t address, base::SimTime now);
  /// The program counter keeps its place; a WAIT begins anew when the program goes on.
  void stop();
  /// Executes one instruction and holds. While a WAIT holds a step, nothing more happens.
  void step(base::SimTime now);
  /// Program counter 0, empty stack (A84).
  void reset();

  /// Executes what is due up to `now`. An instruction that writes to the EEPROM lasts until
  /// finish_write().
  void advance(base::SimTime now);
  /// The instruction that is executed has written to the EEPROM, and that takes its time.
  [[nodiscard]] bool writing() const { return writing_; }
  /// That is over, `kept` or not.
  void finish_write(bool kept, base::SimTime now);
  /// Lets the passes up to `now` go by without an instruction: the processor waits for its EEPROM.
  void hold(base::SimTime now);
  /// Executes up to `limit` instructions at once, as if they took no time; returns how many. Ends
  /// early when a WAIT holds the program and when it stops.
  std::size_t run_at_once(std::size_t limit, base::SimTime now);
  /// When advance() has something to do next.
  [[nodiscard]] base::SimTime next_deadline() const;

  /// What keeps the EEPROM; null: nothing. It must outlive the interpreter's use.
  void connect(EepromKeeper* keeper) { keeper_ = keeper; }
  /// Null: none. It must outlive the interpreter or be taken off.
  void observe(ProgramObserver* observer) {
    observer_ = observer;
    first_ = false;
  }
  [[nodiscard]] bool waiting() const { return wait_.active; }
  /// Subroutines the program is in.
  [[nodiscard]] std::size_t stack_depth() const { return depth_; }
  /// Where they return to, the innermost last.
  [[nodiscard]] std::span<const std::uint16_t> stack() const {
    return std::span(stack_).first(depth_);
  }

 private:
  /// Types of WAIT.
  enum class Condition : std::uint8_t {
    ticks = 0,
    position = 1,
    reference_switch = 2,
    limit_switch = 3,
    reference_search = 4,
  };
  struct Wait {
    bool active = false;
    Condition condition = Condition::ticks;
    std::uint8_t motor = 0;
    base::SimTime deadline = base::SimTime::never();
  };

  [[nodiscard]] bool active() const {
    return state_.application == ApplicationStatus::run ||
           (state_.application == ApplicationStatus::step && wait_.active);
  }
  template <bool kObserved>
  void execute_until(base::SimTime now);
  template <bool kObserved>
  std::size_t execute_at_once(std::size_t limit, base::SimTime now);
  template <bool kObserved>
  void execute_next(base::SimTime now);
  void execute_one(base::SimTime now);
  [[nodiscard]] Status perform(const Instruction& instruction, base::SimTime now);
  [[nodiscard]] Status jump(std::int32_t address);
  [[nodiscard]] Status jump_if(const Instruction& instruction);
  [[nodiscard]] Status call(std::int32_t address);
  void return_from_call();
  [[nodiscard]] Status clear_errors(std::uint8_t type);
  [[nodiscard]] Status begin_wait(const Instruction& instruction, base::SimTime now);
  /// One pass of a WAIT, at next_pass_.
  void continue_wait(base::SimTime now);
  [[nodiscard]] bool condition_met() const;
  void go_on();
  void stop_at_the_end(base::SimTime now);
  void report(const base::EventRule& rule, const Instruction& instruction, std::uint16_t address,
              Status status, base::SimTime now);
  void start(base::SimTime now);

  Module& module_;
  FirmwareState& state_;
  const ProgramMemory& memory_;
  CommandExecutor& executor_;
  base::SimDuration pass_;
  base::EventReporter reporter_;
  EepromKeeper* keeper_ = nullptr;
  ProgramObserver* observer_ = nullptr;

  base::SimTime next_pass_ = base::SimTime::never();
  bool first_ = false;  ///< the next instruction is the first after a start
  Wait wait_;
  bool writing_ = false;
  Instruction written_by_;  ///< it may have erased the memory it was in
  std::array<std::uint16_t, kStackDepth> stack_{};
  std::size_t depth_ = 0;
  /// Addresses whose refusal was told since the start: a loop would tell it for ever.
  std::vector<bool> reported_;
};

}  // namespace stator::tmcl
