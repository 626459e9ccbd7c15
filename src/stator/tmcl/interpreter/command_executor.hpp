#pragma once

#include <array>
#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/tmcl/command_set.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/interpreter/firmware_state.hpp"
#include "stator/tmcl/interpreter/program_memory.hpp"
#include "stator/tmcl/module/global_parameter.hpp"
#include "stator/tmcl/module/module.hpp"
#include "stator/tmcl/module/module_description.hpp"
#include "stator/tmcl/module/parameter_table.hpp"

namespace stator::tmcl {

/// Where a command comes from.
enum class Origin : std::uint8_t {
  serial,   ///< a binary telegram
  can,      ///< a CAN frame
  ascii,    ///< a line of text
  program,  ///< program memory
};

/// Executes the commands that mean the same in direct mode and in programs: motion, parameters,
/// coordinates, inputs and outputs, calculation. Checks them against the module's description
/// before anything reaches the module: an unknown number is Status::wrong_type, a motor or value
/// out of range Status::invalid_value (A95, A96), a locked EEPROM Status::eeprom_locked.
///
/// Replies carry the value that was read, and for other commands the one they came with (A6).
class CommandExecutor {
 public:
  /// All must outlive the executor. std::logic_error: the description contradicts itself.
  CommandExecutor(const ModuleDescription& description, Module& module, FirmwareState& state,
                  ProgramMemory& memory);

  /// Status::invalid_command: the module has no such command. Status::command_not_available: not
  /// from there (A83).
  [[nodiscard]] Status admit(std::uint8_t command, Origin origin) const {
    const CommandUse& use = uses_[command];
    if (!use.direct && !use.program && !use.ascii) {
      return Status::invalid_command;
    }
    const bool usable = origin == Origin::program ? use.program
                        : origin == Origin::ascii ? use.ascii
                                                  : use.direct;
    return usable ? Status::success : Status::command_not_available;
  }
  /// Of a command that admit() let pass. In programs, reading commands load the accumulator.
  [[nodiscard]] Answer execute(const Instruction& instruction, Origin origin, base::SimTime now);

  /// Of bank 0; parameters that the module does not have are 0.
  [[nodiscard]] std::int32_t configuration(GlobalParameter parameter) const;
  [[nodiscard]] std::uint8_t motors() const { return description_.axes; }

 private:
  [[nodiscard]] Answer dispatch(const Instruction& instruction, base::SimTime now);

  [[nodiscard]] Status rotate(const Instruction& instruction, std::int32_t sign);
  [[nodiscard]] Status move(const Instruction& instruction);
  [[nodiscard]] Answer reference_search(const Instruction& instruction);

  [[nodiscard]] Status set_axis_parameter(const Instruction& instruction, std::int32_t value);
  [[nodiscard]] Answer get_axis_parameter(const Instruction& instruction);
  [[nodiscard]] Status keep_axis_parameter(const Instruction& instruction, bool store);

  [[nodiscard]] Status set_global_parameter(const Instruction& instruction, std::int32_t value,
                                            base::SimTime now);
  [[nodiscard]] Status set_lock(std::int32_t value);
  [[nodiscard]] Answer get_global_parameter(const Instruction& instruction, base::SimTime now);
  [[nodiscard]] Status keep_global_parameter(const Instruction& instruction, bool store);
  void set_code_protection(std::int32_t value);

  [[nodiscard]] Status set_coordinate(const Instruction& instruction, std::int32_t position);
  [[nodiscard]] Answer get_coordinate(const Instruction& instruction);
  [[nodiscard]] Status capture_coordinate(const Instruction& instruction);
  [[nodiscard]] Status copy_coordinates(std::uint8_t number, bool store);

  [[nodiscard]] Status set_output(const Instruction& instruction);
  [[nodiscard]] Answer get_input(const Instruction& instruction) const;

  [[nodiscard]] bool is_motor(std::uint8_t motor) const { return motor < description_.axes; }
  [[nodiscard]] bool eeprom_locked() const {
    return configuration(GlobalParameter::eeprom_lock) != 0;
  }

  const ModuleDescription& description_;
  Module& module_;
  FirmwareState& state_;
  ProgramMemory& memory_;
  ParameterTable axis_parameters_;
  ParameterTable global_parameters_;
  std::array<CommandUse, 256> uses_{};
};

}  // namespace stator::tmcl
