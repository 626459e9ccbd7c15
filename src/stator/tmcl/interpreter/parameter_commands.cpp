// The commands of axis and global parameters.

#include "stator/tmcl/interpreter/command_executor.hpp"

namespace stator::tmcl {

namespace {

using enum GlobalParameter;

constexpr std::uint8_t number_of(GlobalParameter parameter) {
  return static_cast<std::uint8_t>(parameter);
}

/// The parameters that are the firmware's own, which no module holds.
bool is_of_firmware(std::uint8_t bank, std::uint8_t number) {
  if (bank != kConfigurationBank) {
    return false;
  }
  switch (static_cast<GlobalParameter>(number)) {
    case application_status:
    case download_mode:
    case program_counter:
    case tick_timer:
    case random_number:
      return true;
    default:
      return false;
  }
}

}  // namespace

Status CommandExecutor::set_axis_parameter(const Instruction& instruction, std::int32_t value) {
  const ParameterDeclaration* parameter = axis_parameters_.find(instruction.type);
  if (parameter == nullptr || !parameter->writable) {
    return Status::wrong_type;
  }
  if (!is_motor(instruction.motor) ||
      !module_.axis_parameter_range(instruction.motor, *parameter).contains(value)) {
    return Status::invalid_value;
  }
  return module_.write_axis_parameter(instruction.motor, parameter->number, value);
}

Answer CommandExecutor::get_axis_parameter(const Instruction& instruction) {
  const ParameterDeclaration* parameter = axis_parameters_.find(instruction.type);
  if (parameter == nullptr) {
    return {Status::wrong_type, instruction.value};
  }
  if (!is_motor(instruction.motor)) {
    return {Status::invalid_value, instruction.value};
  }
  return {Status::success, module_.read_axis_parameter(instruction.motor, parameter->number)};
}

Status CommandExecutor::keep_axis_parameter(const Instruction& instruction, bool store) {
  const ParameterDeclaration* parameter = axis_parameters_.find(instruction.type);
  if (parameter == nullptr || (!parameter->stored && !parameter->storable)) {
    return Status::wrong_type;
  }
  if (!is_motor(instruction.motor)) {
    return Status::invalid_value;
  }
  if (!store) {
    module_.restore_axis_parameter(instruction.motor, parameter->number);
    return Status::success;
  }
  if (eeprom_locked()) {
    return Status::eeprom_locked;
  }
  module_.store_axis_parameter(instruction.motor, parameter->number);
  return Status::success;
}

Status CommandExecutor::set_global_parameter(const Instruction& instruction, std::int32_t value,
                                             base::SimTime now) {
  const std::uint8_t bank = instruction.motor;
  const ParameterDeclaration* parameter = global_parameters_.find(bank, instruction.type);
  if (parameter == nullptr || !parameter->writable) {
    return Status::wrong_type;  // banks too: A71
  }
  const std::uint8_t number = parameter->number;
  if (bank == kConfigurationBank && number == number_of(eeprom_lock)) {
    return set_lock(value);
  }
  if (!parameter->range().contains(value)) {
    return Status::invalid_value;
  }
  if (is_of_firmware(bank, number)) {  // the only one that can be written
    state_.preset_tick_timer(value, now);
    return Status::success;
  }
  if (bank == kConfigurationBank) {
    if (eeprom_locked()) {
      return Status::eeprom_locked;  // A57
    }
    if (number == number_of(code_protection)) {
      set_code_protection(value);
    }
  }
  module_.write_global_parameter(bank, number, value);
  return Status::success;
}

Status CommandExecutor::set_lock(std::int32_t value) {
  if (value != kLockEeprom && value != kUnlockEeprom) {
    return Status::invalid_value;  // A60
  }
  module_.write_global_parameter(kConfigurationBank, number_of(eeprom_lock),
                                 value == kLockEeprom ? 1 : 0);
  return Status::success;
}

// What was protected from reading must not become readable.
void CommandExecutor::set_code_protection(std::int32_t value) {
  const auto before = static_cast<std::uint32_t>(configuration(code_protection));
  const auto after = static_cast<std::uint32_t>(value);
  if ((before & kProtectedFromReading) != 0 && (after & kProtectedFromReading) == 0) {
    memory_.erase();
  }
}

Answer CommandExecutor::get_global_parameter(const Instruction& instruction, base::SimTime now) {
  const std::uint8_t bank = instruction.motor;
  const ParameterDeclaration* parameter = global_parameters_.find(bank, instruction.type);
  if (parameter == nullptr) {
    return {Status::wrong_type, instruction.value};
  }
  if (!is_of_firmware(bank, parameter->number)) {
    return {Status::success, module_.read_global_parameter(bank, parameter->number)};
  }
  switch (static_cast<GlobalParameter>(parameter->number)) {
    case application_status:
      return {Status::success, static_cast<std::int32_t>(state_.application)};
    case download_mode:
      return {Status::success, state_.download ? 1 : 0};
    case program_counter:
      return {Status::success, state_.program_counter};
    case tick_timer:
      return {Status::success, state_.tick_timer(now)};
    default:
      return {Status::success, state_.next_random_number()};
  }
}

// The EEPROM has a parameter of bank 0 already, so that there is nothing to copy (L3338-L3343).
Status CommandExecutor::keep_global_parameter(const Instruction& instruction, bool store) {
  const std::uint8_t bank = instruction.motor;
  const ParameterDeclaration* parameter = global_parameters_.find(bank, instruction.type);
  if (parameter == nullptr || (!parameter->stored && !parameter->storable)) {
    return Status::wrong_type;
  }
  if (store && eeprom_locked()) {
    return Status::eeprom_locked;
  }
  if (bank == kConfigurationBank) {
    return Status::success;
  }
  if (store) {
    module_.store_global_parameter(bank, parameter->number);
  } else {
    module_.restore_global_parameter(bank, parameter->number);
  }
  return Status::success;
}

std::int32_t CommandExecutor::configuration(GlobalParameter parameter) const {
  const std::uint8_t number = number_of(parameter);
  return global_parameters_.find(kConfigurationBank, number) != nullptr
             ? module_.read_global_parameter(kConfigurationBank, number)
             : 0;
}

}  // namespace stator::tmcl
