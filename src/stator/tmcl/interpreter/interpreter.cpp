#include "stator/tmcl/interpreter/interpreter.hpp"

#include <algorithm>
#include <stdexcept>

#include "stator/tmcl/command.hpp"
#include "stator/tmcl/interpreter/calculation.hpp"

namespace stator::tmcl {

namespace {

using base::EventRule;
using base::Severity;
using base::SimTime;

constexpr EventRule kRefused{"tmcl-program-refusal", Severity::refusal,
                             "program: command {1} at address {0} refused with status {2}, with "
                             "type {3}, motor or bank {4}, "
                             "value {5}; the program goes on with the next, correct this one"};
constexpr EventRule kNotKept{
    "tmcl-program-not-kept", Severity::fault,
    "program: command {1} at address {0} refused with status {2}, with type {3}, motor or bank "
    "{4}, "
    "value {5}: what it wrote to the EEPROM could not be kept, and the old value is there again; "
    "the program goes on with the next, see what the state directory lacks"};
constexpr EventRule kPastTheEnd{
    "tmcl-program-end", Severity::warning,
    "program: stopped, because it ran past the last of {0} commands of the memory; end it with "
    "STOP or a jump"};

/// Types of JC.
enum class Jump : std::uint8_t {
  zero = 0,
  not_zero = 1,
  equal = 2,
  not_equal = 3,
  greater = 4,
  greater_or_equal = 5,
  lower = 6,
  lower_or_equal = 7,
  first_error = 8,
};

bool holds(const Registers& registers, Jump condition) {
  switch (condition) {
    case Jump::zero:
      return registers.zero;
    case Jump::not_zero:
      return !registers.zero;
    case Jump::equal:
      return registers.equal;
    case Jump::not_equal:
      return !registers.equal;
    case Jump::greater:
      return registers.greater;
    case Jump::greater_or_equal:
      return registers.greater || registers.equal;
    case Jump::lower:
      return registers.lower;
    case Jump::lower_or_equal:
      return registers.lower || registers.equal;
    case Jump::first_error:
      break;
  }
  return false;
}

/// The first pass at or after `moment`, of those at `from` and every `pass` after it.
SimTime pass_at_or_after(SimTime moment, SimTime from, base::SimDuration pass) {
  const base::SimDuration past = (moment - from) % pass;
  return past.nanoseconds() == 0 ? moment : moment + (pass - past);
}

}  // namespace

Interpreter::Interpreter(Module& module, FirmwareState& state, const ProgramMemory& memory,
                         CommandExecutor& executor, base::SimDuration pass,
                         base::EventReporter reporter)
    : module_(module),
      state_(state),
      memory_(memory),
      executor_(executor),
      pass_(pass),
      reporter_(reporter),
      reported_(memory.size()) {
  if (pass.nanoseconds() < 1) {
    throw std::logic_error("TMCL: an instruction takes at least 1 ns");
  }
}

void Interpreter::start(SimTime now) {
  next_pass_ = now + pass_;
  first_ = true;
  wait_ = {};
  std::fill(reported_.begin(), reported_.end(), false);
  state_.application = ApplicationStatus::run;
}

void Interpreter::run(SimTime now) {
  if (state_.application != ApplicationStatus::run) {
    start(now);
  }
}

void Interpreter::run_from(std::uint16_t address, SimTime now) {
  state_.program_counter = address;
  depth_ = 0;
  start(now);
}

void Interpreter::stop() {
  wait_ = {};
  if (writing_) {
    writing_ = false;
    state_.writing = false;
  }
  state_.application = ApplicationStatus::stop;
}

void Interpreter::step(SimTime now) {
  if (state_.application == ApplicationStatus::step && wait_.active) {
    return;
  }
  wait_ = {};
  first_ = true;
  state_.application = ApplicationStatus::step;
  next_pass_ = now;
  execute_one(now);
  next_pass_ = now + pass_;
}

void Interpreter::reset() {
  stop();
  depth_ = 0;
  state_.program_counter = 0;
  state_.application = ApplicationStatus::reset;
}

void Interpreter::advance(SimTime now) {
  if (observer_ != nullptr) {
    execute_until<true>(now);
  } else {
    execute_until<false>(now);
  }
}

std::size_t Interpreter::run_at_once(std::size_t limit, SimTime now) {
  return observer_ != nullptr ? execute_at_once<true>(limit, now)
                              : execute_at_once<false>(limit, now);
}

SimTime Interpreter::next_deadline() const {
  return active() ? next_pass_ : SimTime::never();
}

template <bool kObserved>
void Interpreter::execute_until(SimTime now) {
  while (active() && next_pass_ <= now && !writing_) {
    if (wait_.active) {
      continue_wait(now);
    } else {
      execute_next<kObserved>(next_pass_);
      next_pass_ += pass_;
    }
  }
}

template <bool kObserved>
std::size_t Interpreter::execute_at_once(std::size_t limit, SimTime now) {
  std::size_t count = 0;
  if (wait_.active && active()) {
    next_pass_ = now;
    continue_wait(now);
  }
  while (count < limit && state_.application == ApplicationStatus::run && !wait_.active) {
    execute_next<kObserved>(now);
    ++count;
  }
  next_pass_ = std::max(next_pass_, now + pass_);
  return count;
}

template <bool kObserved>
void Interpreter::execute_next(SimTime now) {
  const std::uint16_t address = state_.program_counter;
  // A copy: the instruction may erase the memory it is in.
  const Instruction instruction = memory_[address];
  if constexpr (kObserved) {
    if (!first_ && !observer_->may_execute(now, address, instruction)) {
      stop();
      return;
    }
    first_ = false;
  }
  const Status status = perform(instruction, now);
  if (status != Status::success) {
    report(kRefused, instruction, address, status, now);
  }
  if (writing_) {
    return;
  }
  if constexpr (kObserved) {
    if (!wait_.active) {
      observer_->executed({now, address, instruction, status}, state_.registers);
    }
  }
  stop_at_the_end(now);
}

void Interpreter::stop_at_the_end(SimTime now) {
  if (state_.program_counter >= memory_.size()) {
    stop();
    state_.program_counter = 0;
    reporter_.report(now, kPastTheEnd, {memory_.size()});
  }
}

void Interpreter::execute_one(SimTime now) {
  if (observer_ != nullptr) {
    execute_next<true>(now);
  } else {
    execute_next<false>(now);
  }
}

Status Interpreter::perform(const Instruction& instruction, SimTime now) {
  Status status = executor_.admit(instruction.command, Origin::program);
  if (status == Status::success) {
    switch (static_cast<Command>(instruction.command)) {
      case Command::calculate:
        status = calculate(state_.registers, instruction.type, instruction.value);
        break;
      case Command::compare:
        state_.registers.compare(instruction.value);
        break;
      case Command::jump_conditionally:
        return jump_if(instruction);
      case Command::jump_always:
        return jump(instruction.value);
      case Command::call_subroutine:
        return call(instruction.value);
      case Command::return_from_subroutine:
        return_from_call();
        return Status::success;
      case Command::wait:
        status = begin_wait(instruction, now);
        if (wait_.active) {
          return status;
        }
        break;
      case Command::stop:
        stop();
        return Status::success;
      case Command::clear_error_flags:
        status = clear_errors(instruction.type);
        break;
      default:
        status = executor_.execute(instruction, Origin::program, now).status;
        if (keeper_ != nullptr) {
          switch (keeper_->keep(true, now)) {
            case EepromKeeper::Outcome::busy:
              writing_ = true;
              written_by_ = instruction;
              state_.writing = true;
              return status;
            case EepromKeeper::Outcome::failed:
              status = Status::eeprom_locked;
              report(kNotKept, instruction, state_.program_counter, status, now);
              break;
            case EepromKeeper::Outcome::kept:
              break;
          }
        }
        break;
    }
  }
  go_on();
  return status;
}

void Interpreter::hold(SimTime now) {
  if (active() && next_pass_ <= now) {
    next_pass_ = pass_at_or_after(now + base::SimDuration(1), next_pass_, pass_);
  }
}

void Interpreter::finish_write(bool kept, SimTime now) {
  writing_ = false;
  state_.writing = false;
  const std::uint16_t address = state_.program_counter;
  const Status status = kept ? Status::success : Status::eeprom_locked;
  if (!kept) {
    report(kNotKept, written_by_, address, status, now);
  }
  if (observer_ != nullptr) {
    observer_->executed({now, address, written_by_, status}, state_.registers);
  }
  go_on();
  stop_at_the_end(now);
}

void Interpreter::go_on() {
  ++state_.program_counter;
}

Status Interpreter::jump(std::int32_t address) {
  if (!memory_.contains(address)) {
    go_on();
    return Status::invalid_value;
  }
  state_.program_counter = static_cast<std::uint16_t>(address);
  return Status::success;
}

Status Interpreter::jump_if(const Instruction& instruction) {
  constexpr auto kFirstError = static_cast<std::uint8_t>(Jump::first_error);
  const std::uint8_t type = instruction.type;
  bool taken = false;
  if (type < kFirstError) {
    taken = holds(state_.registers, static_cast<Jump>(type));
  } else if (type < kFirstError + kErrorFlagCount) {
    taken = state_.registers.raised(static_cast<ErrorFlag>(type - kFirstError + 1));
  } else {
    go_on();
    return Status::wrong_type;
  }
  if (taken) {
    return jump(instruction.value);
  }
  go_on();
  return memory_.contains(instruction.value) ? Status::success : Status::invalid_value;
}

// A call with a full stack is passed over (L3925-L3926).
Status Interpreter::call(std::int32_t address) {
  if (!memory_.contains(address)) {
    go_on();
    return Status::invalid_value;
  }
  go_on();
  if (depth_ < kStackDepth) {
    stack_[depth_++] = state_.program_counter;
    state_.program_counter = static_cast<std::uint16_t>(address);
  }
  return Status::success;
}

// With an empty stack it is passed over (L3963-L3964).
void Interpreter::return_from_call() {
  if (depth_ == 0) {
    go_on();
  } else {
    state_.program_counter = stack_[--depth_];
  }
}

Status Interpreter::clear_errors(std::uint8_t type) {
  if (type > kErrorFlagCount) {
    return Status::wrong_type;
  }
  if (type == 0) {
    state_.registers.errors = 0;
  } else {
    state_.registers.clear(static_cast<ErrorFlag>(type));
  }
  return Status::success;
}

Status Interpreter::begin_wait(const Instruction& instruction, SimTime now) {
  if (instruction.type > static_cast<std::uint8_t>(Condition::reference_search)) {
    return Status::wrong_type;
  }
  const auto condition = static_cast<Condition>(instruction.type);
  const std::int32_t ticks = instruction.value;
  if (ticks < 0 || (condition != Condition::ticks && instruction.motor >= executor_.motors())) {
    return Status::invalid_value;
  }
  wait_ = {.active = true, .condition = condition, .motor = instruction.motor};
  if (ticks > 0) {
    wait_.deadline = now + kWaitTick * ticks;
  }
  const bool through = condition == Condition::ticks ? ticks == 0 : condition_met();
  wait_.active = !through;
  return Status::success;
}

bool Interpreter::condition_met() const {
  switch (wait_.condition) {
    case Condition::ticks:
      return false;
    case Condition::position:
      return module_.position_reached(wait_.motor);
    case Condition::reference_switch:
      return module_.reference_switch_active(wait_.motor);
    case Condition::limit_switch:
      return module_.limit_switch_active(wait_.motor);
    case Condition::reference_search:
      return module_.reference_search_state(wait_.motor) == 0;
  }
  return false;
}

// The module shows its state of `now`, so the passes until then would all see the same.
void Interpreter::continue_wait(SimTime now) {
  const SimTime pass = next_pass_;
  const bool met = condition_met();
  const bool expired = pass >= wait_.deadline;
  if (!met && !expired) {
    const SimTime following = pass_at_or_after(now + base::SimDuration(1), pass, pass_);
    const SimTime last = wait_.deadline == SimTime::never()
                             ? SimTime::never()
                             : pass_at_or_after(wait_.deadline, pass, pass_);
    next_pass_ = wait_.condition == Condition::ticks ? last : std::min(following, last);
    return;
  }
  if (expired && !met && wait_.condition != Condition::ticks) {
    state_.registers.raise(ErrorFlag::timeout);
  }
  const std::uint16_t address = state_.program_counter;
  wait_ = {};
  if (observer_ != nullptr) {
    observer_->executed({pass, address, memory_[address], Status::success}, state_.registers);
  }
  go_on();
  stop_at_the_end(pass);
  next_pass_ = pass + pass_;
}

void Interpreter::report(const EventRule& rule, const Instruction& instruction,
                         std::uint16_t address, Status status, SimTime now) {
  if (reported_[address]) {
    return;
  }
  reported_[address] = true;
  const base::StaticText name = name_of(instruction.command);
  reporter_.report(
      now, rule,
      {int{address},
       name.empty() ? base::EventArgument(int{instruction.command}) : base::EventArgument(name),
       static_cast<int>(status), int{instruction.type}, int{instruction.motor},
       int{instruction.value}});
}

}  // namespace stator::tmcl
