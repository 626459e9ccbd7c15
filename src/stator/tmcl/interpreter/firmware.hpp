#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/interpreter/command_executor.hpp"
#include "stator/tmcl/interpreter/eeprom_keeper.hpp"
#include "stator/tmcl/interpreter/firmware_state.hpp"
#include "stator/tmcl/interpreter/interpreter.hpp"
#include "stator/tmcl/interpreter/program_memory.hpp"
#include "stator/tmcl/module/module.hpp"
#include "stator/tmcl/module/module_description.hpp"

namespace stator::tmcl {

/// What the reply to a host looks like.
enum class ReplyForm : std::uint8_t {
  normal,
  none,          ///< of command 137
  version_text,  ///< eight characters, of command 136
  instruction,   ///< a cell of the program memory, of command 134 (A88)
};

/// What became of a host's command, and what its interface has to do.
struct HostAnswer {
  Status status = Status::success;
  std::int32_t value = 0;
  ReplyForm form = ReplyForm::normal;
  Instruction instruction{};    ///< of ReplyForm::instruction
  bool enter_ascii = false;     ///< after the reply (A92)
  std::uint8_t event_mask = 0;  ///< motors whose reached targets are to be told (command 138)
  /// There is no answer yet, because the EEPROM is being written: Firmware::take_answer() has it.
  bool waits = false;
};

struct FirmwareSettings {
  /// From one instruction of a program to the next, at least 1 ns (A85).
  base::SimDuration instruction_time{100'000};
  /// Of the random numbers.
  std::uint64_t seed = 0;
};

/// The firmware of a TMCL module, without its motion and its interfaces: direct mode, programs and
/// their memory, download. The interfaces (SerialSession, CanSession) bring it the commands of
/// hosts; all of them speak with the same module (M142-EXE-001).
class Firmware {
 public:
  /// `description` and `module` must outlive it. Allocates; nothing else here does.
  /// std::logic_error: the description contradicts itself.
  Firmware(const ModuleDescription& description, Module& module,
           const FirmwareSettings& settings = {}, base::EventReporter reporter = {});
  Firmware(const Firmware&) = delete;
  Firmware& operator=(const Firmware&) = delete;
  ~Firmware() = default;

  /// Registers and program begin anew; the memory keeps its program, which starts if global
  /// parameter 77 says so. The module must have its values already.
  void power_on(base::SimTime now);

  /// What keeps the EEPROM without supply; it must outlive the firmware's use. Without one nothing
  /// that is written takes time.
  void connect(EepromKeeper& keeper);
  /// The processor waits for its EEPROM: commands have to wait.
  [[nodiscard]] bool busy() const {
    return state_.writing ||
           (keeper_ != nullptr && keeper_->outcome() == EepromKeeper::Outcome::busy);
  }
  /// Executes a host's command; advance() to `now` comes first. Not while busy(), never
  /// Origin::program.
  [[nodiscard]] HostAnswer execute(const Instruction& instruction, Origin origin,
                                   base::SimTime now);
  /// The answer that execute() said was to be waited for; nothing: it is still being written. Until
  /// it has been taken the firmware is busy.
  [[nodiscard]] std::optional<HostAnswer> take_answer(base::SimTime now);
  /// Ends the instruction of the program that had to wait for the EEPROM, once that is written.
  void finish_instruction(base::SimTime now);
  /// Executes what is due of the program.
  void advance(base::SimTime now) {
    if (keeper_ == nullptr || !held(now)) {
      interpreter_.advance(now);
    }
  }
  [[nodiscard]] base::SimTime next_deadline() const { return interpreter_.next_deadline(); }

  /// Tells programs of an error (A80); it stays until CLE.
  void raise(ErrorFlag flag) { state_.registers.raise(flag); }
  /// RUN of the ASCII interface: from the first command on.
  void start_program(base::SimTime now) { interpreter_.run_from(0, now); }
  /// STOP of the ASCII interface.
  void stop_program() { interpreter_.stop(); }
  /// All motors of `mask` have reached their targets.
  [[nodiscard]] bool targets_reached(std::uint8_t mask) const;

  /// A parameter of bank 0, as configured; 0 if the module has none of that number.
  [[nodiscard]] std::int32_t configuration(GlobalParameter parameter) const {
    return executor_.configuration(parameter);
  }
  [[nodiscard]] const ModuleDescription& description() const { return description_; }
  [[nodiscard]] const FirmwareState& state() const { return state_; }
  [[nodiscard]] const ProgramMemory& memory() const { return memory_; }
  /// Puts a program into the memory, as a download would.
  void load_program(std::span<const Instruction> program) { memory_.load(program); }
  [[nodiscard]] Interpreter& interpreter() { return interpreter_; }
  [[nodiscard]] const Interpreter& interpreter() const { return interpreter_; }

 private:
  [[nodiscard]] bool held(base::SimTime now);
  [[nodiscard]] HostAnswer refuse(HostAnswer answer, const Instruction& instruction,
                                  base::SimTime now);
  [[nodiscard]] HostAnswer dispatch(const Instruction& instruction, Origin origin,
                                    base::SimTime now);
  [[nodiscard]] HostAnswer control(const Instruction& instruction, Origin origin,
                                   base::SimTime now);
  [[nodiscard]] HostAnswer load_into_memory(const Instruction& instruction);
  [[nodiscard]] Status run_application(const Instruction& instruction, base::SimTime now);
  [[nodiscard]] Status start_download(std::int32_t address);
  [[nodiscard]] HostAnswer read_memory(const Instruction& instruction) const;
  [[nodiscard]] HostAnswer version(const Instruction& instruction) const;
  [[nodiscard]] HostAnswer restore_factory_settings(const Instruction& instruction);
  [[nodiscard]] bool protected_from(std::uint32_t access) const;
  void report(const Instruction& instruction, Status status, base::SimTime now) const;
  void report(const base::EventRule& rule, const Instruction& instruction, base::SimTime now) const;

  const ModuleDescription& description_;
  Module& module_;
  FirmwareState state_;
  ProgramMemory memory_;
  CommandExecutor executor_;
  Interpreter interpreter_;
  base::EventReporter reporter_;
  EepromKeeper* keeper_ = nullptr;
  bool host_waits_ = false;  ///< for take_answer()
  HostAnswer waiting_answer_;
  Instruction waiting_instruction_;
};

}  // namespace stator::tmcl
