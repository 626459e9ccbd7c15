#include "stator/tmcl/interpreter/firmware.hpp"

#include "stator/tmcl/command.hpp"

namespace stator::tmcl {

namespace {

using base::EventRule;
using base::Severity;

/// Types of 129 and 136.
constexpr std::uint8_t kFromPresentAddress = 0;
constexpr std::uint8_t kFromGivenAddress = 1;
constexpr std::uint8_t kVersionText = 0;
constexpr std::uint8_t kVersionValue = 1;

/// What 137 must carry (L794-L798).
constexpr std::int32_t kFactorySettings = 1234;

constexpr EventRule kInvalidCommand{
    "tmcl-invalid-command", Severity::refusal,
    "TMCL: command {0} refused with status 2: this module has no command of that number"};
constexpr EventRule kWrongType{
    "tmcl-wrong-type", Severity::refusal,
    "TMCL: {0} refused with status 3: type {1} (motor or bank {2}) is no parameter, port or "
    "operation that this command may use; the module's tables list those there are"};
constexpr EventRule kInvalidValue{
    "tmcl-invalid-value", Severity::refusal,
    "TMCL: {0} with type {1} refused with status 4: motor {2} or value {3} is out of range"};
constexpr EventRule kLocked{
    "tmcl-eeprom-locked", Severity::refusal,
    "TMCL: {0} with type {1} refused with status 5: the configuration EEPROM is locked; SGP 73, 0, "
    "4321 unlocks it"};
constexpr EventRule kNotKept{
    "tmcl-not-kept", Severity::fault,
    "TMCL: {0} with type {1}, motor or bank {2}, value {3} refused with status 5: what it wrote to "
    "the EEPROM could not be kept, and what was there before is there again; see what the state "
    "directory lacks, then send the command again"};
constexpr EventRule kNotAvailable{
    "tmcl-not-available", Severity::refusal,
    "TMCL: {0} refused with status 6: not on this interface, not outside of a program, or kept "
    "back by the code protection (global parameter 81)"};

constexpr EventRule kNotAnswered{
    "tmcl-no-boot-loader", Severity::refusal,
    "TMCL: {0} not obeyed and, as hosts expect, not answered: the boot loader of this module is "
    "not described in its document, so the firmware goes on running; firmware is not loaded here"};

const EventRule* rule_of(Status status) {
  switch (status) {
    case Status::invalid_command:
      return &kInvalidCommand;
    case Status::wrong_type:
      return &kWrongType;
    case Status::invalid_value:
      return &kInvalidValue;
    case Status::eeprom_locked:
      return &kLocked;
    case Status::command_not_available:
      return &kNotAvailable;
    default:
      return nullptr;
  }
}

/// In download mode these are still executed, others are stored (A87).
bool is_executed_in_download(std::uint8_t command) {
  return command >= static_cast<std::uint8_t>(Command::stop_application) &&
         command <= static_cast<std::uint8_t>(Command::restore_factory_settings);
}

bool is_control(std::uint8_t command) {
  return command >= static_cast<std::uint8_t>(Command::stop_application);
}

}  // namespace

Firmware::Firmware(const ModuleDescription& description, Module& module,
                   const FirmwareSettings& settings, base::EventReporter reporter)
    : description_(description),
      module_(module),
      memory_(description.program_length),
      executor_(description, module, state_, memory_),
      interpreter_(module, state_, memory_, executor_, settings.instruction_time, reporter),
      reporter_(reporter) {
  state_.random = base::Random(settings.seed);
}

void Firmware::power_on(base::SimTime now) {
  interpreter_.reset();
  host_waits_ = false;
  const base::Random random = state_.random;
  state_ = {};
  state_.random = random;
  state_.tick_origin = now;
  if (configuration(GlobalParameter::auto_start) == 1) {
    interpreter_.run_from(0, now);
  }
}

HostAnswer Firmware::execute(const Instruction& instruction, Origin origin, base::SimTime now) {
  HostAnswer answer = dispatch(instruction, origin, now);
  if (rule_of(answer.status) != nullptr) {
    report(instruction, answer.status, now);
  }
  if (keeper_ == nullptr) {
    return answer;
  }
  if (!interpreter_.writing()) {  // as the step of command 130
    switch (keeper_->keep(answer.form != ReplyForm::none, now)) {
      case EepromKeeper::Outcome::kept:
        return answer;
      case EepromKeeper::Outcome::failed:
        return refuse(answer, instruction, now);
      case EepromKeeper::Outcome::busy:
        break;
    }
  }
  state_.writing = true;
  host_waits_ = true;
  answer.waits = true;
  waiting_answer_ = answer;
  waiting_instruction_ = instruction;
  return answer;
}

std::optional<HostAnswer> Firmware::take_answer(base::SimTime now) {
  if (keeper_->outcome() == EepromKeeper::Outcome::busy) {
    return std::nullopt;
  }
  const bool kept = keeper_->outcome() == EepromKeeper::Outcome::kept;
  HostAnswer answer = waiting_answer_;
  answer.waits = false;
  host_waits_ = false;
  if (interpreter_.writing()) {  // nobody is told of a program's statuses
    interpreter_.finish_write(kept, now);
    return answer;
  }
  state_.writing = false;
  return kept ? answer : refuse(answer, waiting_instruction_, now);
}

// The command counts as not executed, so a download goes on where it was.
HostAnswer Firmware::refuse(HostAnswer answer, const Instruction& instruction, base::SimTime now) {
  if (answer.status == Status::loaded_into_eeprom) {
    --state_.download_address;
  }
  report(kNotKept, instruction, now);
  answer.status = Status::eeprom_locked;
  answer.value = instruction.value;
  return answer;
}

void Firmware::connect(EepromKeeper& keeper) {
  keeper_ = &keeper;
  interpreter_.connect(&keeper);
}

// The step of a host's command 130 is ended by take_answer().
void Firmware::finish_instruction(base::SimTime now) {
  const EepromKeeper::Outcome outcome = keeper_->outcome();
  if (interpreter_.writing() && !host_waits_ && outcome != EepromKeeper::Outcome::busy) {
    interpreter_.finish_write(outcome == EepromKeeper::Outcome::kept, now);
  }
}

bool Firmware::held(base::SimTime now) {
  finish_instruction(now);
  if (!busy()) {
    return false;
  }
  interpreter_.hold(now);
  return true;
}

HostAnswer Firmware::dispatch(const Instruction& instruction, Origin origin, base::SimTime now) {
  if (is_never_answered(instruction.command)) {
    return {.status = Status::invalid_command,
            .value = instruction.value,
            .form = ReplyForm::none};  // T-11
  }
  if (state_.download && !is_executed_in_download(instruction.command)) {
    return load_into_memory(instruction);
  }
  const Status admitted = executor_.admit(instruction.command, origin);
  if (admitted != Status::success) {
    return {.status = admitted, .value = instruction.value};
  }
  if (is_control(instruction.command)) {
    return control(instruction, origin, now);
  }
  switch (static_cast<Command>(instruction.command)) {
    case Command::compare:
    case Command::jump_conditionally:
    case Command::jump_always:
    case Command::call_subroutine:
    case Command::return_from_subroutine:
    case Command::wait:
    case Command::stop:
    case Command::clear_error_flags:
      // Whatever a module's table says: there is no program they could act on (A83).
      return {.status = Status::command_not_available, .value = instruction.value};
    default: {
      const Answer answer = executor_.execute(instruction, origin, now);
      return {.status = answer.status, .value = answer.value};
    }
  }
}

HostAnswer Firmware::load_into_memory(const Instruction& instruction) {
  if (!memory_.contains(state_.download_address)) {
    return {.status = Status::invalid_value, .value = instruction.value};
  }
  memory_.write(state_.download_address, instruction);
  ++state_.download_address;
  return {.status = Status::loaded_into_eeprom, .value = instruction.value};
}

HostAnswer Firmware::control(const Instruction& instruction, Origin origin, base::SimTime now) {
  HostAnswer answer{.value = instruction.value};
  switch (static_cast<Command>(instruction.command)) {
    case Command::stop_application:
      interpreter_.stop();
      break;
    case Command::run_application:
      answer.status = run_application(instruction, now);
      break;
    case Command::step_application:
      interpreter_.step(now);
      break;
    case Command::reset_application:
      interpreter_.reset();
      break;
    case Command::start_download:
      answer.status = start_download(instruction.value);
      break;
    case Command::quit_download:
      state_.download = false;
      break;
    case Command::read_memory:
      return read_memory(instruction);
    case Command::get_application_status:
      answer.value = static_cast<std::int32_t>(state_.application);
      break;
    case Command::get_firmware_version:
      return version(instruction);
    case Command::restore_factory_settings:
      return restore_factory_settings(instruction);
    case Command::request_target_reached_event:
      answer.event_mask =
          static_cast<std::uint8_t>(instruction.value & ((1 << description_.axes) - 1));
      answer.value = answer.event_mask;
      break;
    case Command::enter_ascii_mode:
      answer.enter_ascii = origin == Origin::serial;
      answer.status = answer.enter_ascii ? Status::success : Status::command_not_available;
      break;
    default:
      answer.status = Status::invalid_command;
      break;
  }
  return answer;
}

Status Firmware::run_application(const Instruction& instruction, base::SimTime now) {
  switch (instruction.type) {
    case kFromPresentAddress:
      interpreter_.run(now);
      return Status::success;
    case kFromGivenAddress:
      if (!memory_.contains(instruction.value)) {
        return Status::invalid_value;
      }
      interpreter_.run_from(static_cast<std::uint16_t>(instruction.value), now);
      return Status::success;
    default:
      return Status::wrong_type;
  }
}

// The program stops: its memory is about to change under it.
Status Firmware::start_download(std::int32_t address) {
  if (protected_from(kProtectedFromWriting)) {
    return Status::command_not_available;  // A62
  }
  if (!memory_.contains(address)) {
    return Status::invalid_value;
  }
  if (state_.application == ApplicationStatus::run) {
    interpreter_.stop();
  }
  state_.download = true;
  state_.download_address = static_cast<std::uint16_t>(address);
  return Status::success;
}

HostAnswer Firmware::read_memory(const Instruction& instruction) const {
  if (protected_from(kProtectedFromReading)) {
    return {.status = Status::command_not_available, .value = instruction.value};  // A62
  }
  if (!memory_.contains(instruction.value)) {
    return {.status = Status::invalid_value, .value = instruction.value};
  }
  return {.value = instruction.value,
          .form = ReplyForm::instruction,
          .instruction = memory_[static_cast<std::size_t>(instruction.value)]};
}

HostAnswer Firmware::version(const Instruction& instruction) const {
  switch (instruction.type) {
    case kVersionText:
      return {.value = instruction.value, .form = ReplyForm::version_text};
    case kVersionValue:
      return {.value = description_.version_value};
    default:
      return {.status = Status::wrong_type, .value = instruction.value};
  }
}

HostAnswer Firmware::restore_factory_settings(const Instruction& instruction) {
  if (instruction.value != kFactorySettings) {
    return {.status = Status::invalid_value, .value = instruction.value};  // A90
  }
  module_.restore_factory_settings();
  return {.value = instruction.value, .form = ReplyForm::none};
}

bool Firmware::targets_reached(std::uint8_t mask) const {
  for (std::uint8_t motor = 0; motor < description_.axes; ++motor) {
    if ((mask >> motor & 1U) != 0 && !module_.position_reached(motor)) {
      return false;
    }
  }
  return true;
}

bool Firmware::protected_from(std::uint32_t access) const {
  return (static_cast<std::uint32_t>(configuration(GlobalParameter::code_protection)) & access) !=
         0;
}

void Firmware::report(const Instruction& instruction, Status status, base::SimTime now) const {
  report(is_never_answered(instruction.command) ? kNotAnswered : *rule_of(status), instruction,
         now);
}

void Firmware::report(const EventRule& rule, const Instruction& instruction,
                      base::SimTime now) const {
  const base::StaticText name = name_of(instruction.command);
  reporter_.report(
      now, rule,
      {name.empty() ? base::EventArgument(int{instruction.command}) : base::EventArgument(name),
       int{instruction.type}, int{instruction.motor}, int{instruction.value}});
}

}  // namespace stator::tmcl
