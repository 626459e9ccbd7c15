#include "stator/tmcl/interpreter/command_executor.hpp"

#include <limits>

#include "stator/tmcl/interpreter/calculation.hpp"
#include "stator/tmcl/module/ports.hpp"

namespace stator::tmcl {

namespace {

/// Types of MVP.
enum class Move : std::uint8_t { absolute = 0, relative = 1, to_coordinate = 2 };
/// Types of RFS.
enum class Search : std::uint8_t { start = 0, stop = 1, status = 2 };

/// "All TMCL commands that read a value store the result in the accumulator" (L669-L671).
bool reads(const Instruction& instruction) {
  switch (static_cast<Command>(instruction.command)) {
    case Command::get_axis_parameter:
    case Command::get_global_parameter:
    case Command::get_input:
    case Command::get_coordinate:
      return true;
    case Command::reference_search:
      return static_cast<Search>(instruction.type) == Search::status;
    default:
      return false;
  }
}

}  // namespace

CommandExecutor::CommandExecutor(const ModuleDescription& description, Module& module,
                                 FirmwareState& state, ProgramMemory& memory)
    : description_(description),
      module_(module),
      state_(state),
      memory_(memory),
      axis_parameters_(description.axis_parameters),
      global_parameters_(description.global_parameters) {
  for (const CommandDeclaration& declaration : description.commands.all()) {
    uses_[static_cast<std::uint8_t>(declaration.command)] = declaration.use;
  }
}

Answer CommandExecutor::execute(const Instruction& instruction, Origin origin, base::SimTime now) {
  const Answer answer = dispatch(instruction, now);
  if (origin == Origin::program && answer.status == Status::success && reads(instruction)) {
    state_.registers.load(answer.value);
  }
  return answer;
}

Answer CommandExecutor::dispatch(const Instruction& instruction, base::SimTime now) {
  const std::int32_t value = instruction.value;
  const std::int32_t accumulator = state_.registers.accumulator;
  switch (static_cast<Command>(instruction.command)) {
    case Command::rotate_right:
      return {rotate(instruction, 1), value};
    case Command::rotate_left:
      return {rotate(instruction, -1), value};
    case Command::motor_stop:
      if (!is_motor(instruction.motor)) {
        return {Status::invalid_value, value};
      }
      module_.stop(instruction.motor);
      return {Status::success, value};
    case Command::move_to_position:
      return {move(instruction), value};
    case Command::set_axis_parameter:
      return {set_axis_parameter(instruction, value), value};
    case Command::get_axis_parameter:
      return get_axis_parameter(instruction);
    case Command::store_axis_parameter:
      return {keep_axis_parameter(instruction, true), value};
    case Command::restore_axis_parameter:
      return {keep_axis_parameter(instruction, false), value};
    case Command::set_global_parameter:
      return {set_global_parameter(instruction, value, now), value};
    case Command::get_global_parameter:
      return get_global_parameter(instruction, now);
    case Command::store_global_parameter:
      return {keep_global_parameter(instruction, true), value};
    case Command::restore_global_parameter:
      return {keep_global_parameter(instruction, false), value};
    case Command::reference_search:
      return reference_search(instruction);
    case Command::set_output:
      return {set_output(instruction), value};
    case Command::get_input:
      return get_input(instruction);
    case Command::calculate:
      return {calculate(state_.registers, instruction.type, value), value};
    case Command::calculate_with_x:
      return {calculate_with_x(state_.registers, instruction.type), value};
    case Command::set_coordinate:
      return {set_coordinate(instruction, value), value};
    case Command::get_coordinate:
      return get_coordinate(instruction);
    case Command::capture_coordinate:
      return {capture_coordinate(instruction), value};
    case Command::accumulator_to_axis_parameter:
      return {set_axis_parameter(instruction, accumulator), value};
    case Command::accumulator_to_global_parameter:
      return {set_global_parameter(instruction, accumulator, now), value};
    case Command::accumulator_to_coordinate:
      return {set_coordinate(instruction, accumulator), value};
    case Command::user_function_0:
    case Command::user_function_1:
    case Command::user_function_2:
    case Command::user_function_3:
    case Command::user_function_4:
    case Command::user_function_5:
    case Command::user_function_6:
    case Command::user_function_7:
      return module_.user_function(
          static_cast<std::uint8_t>(instruction.command -
                                    static_cast<unsigned>(Command::user_function_0)),
          instruction);
    default:
      return {Status::invalid_command, value};
  }
}

Status CommandExecutor::rotate(const Instruction& instruction, std::int32_t sign) {
  if (!is_motor(instruction.motor) || instruction.value < 0) {  // A19
    return Status::invalid_value;
  }
  return module_.rotate(instruction.motor, sign * instruction.value);
}

Status CommandExecutor::move(const Instruction& instruction) {
  const std::uint8_t motor = instruction.motor;
  if (instruction.type > static_cast<std::uint8_t>(Move::to_coordinate)) {
    return Status::wrong_type;
  }
  if (!is_motor(motor)) {
    return Status::invalid_value;
  }
  switch (static_cast<Move>(instruction.type)) {
    case Move::absolute:
      return module_.move_to(motor, instruction.value);
    case Move::relative: {  // A21
      const std::int64_t target = std::int64_t{module_.actual_position(motor)} + instruction.value;
      if (target < std::numeric_limits<std::int32_t>::min() ||
          target > std::numeric_limits<std::int32_t>::max()) {
        return Status::invalid_value;
      }
      return module_.move_to(motor, static_cast<std::int32_t>(target));
    }
    case Move::to_coordinate:
      if (instruction.value < 0 || instruction.value >= description_.coordinates) {
        return Status::invalid_value;
      }
      return module_.move_to(motor,
                             module_.coordinate(static_cast<std::uint8_t>(instruction.value)));
  }
  return Status::wrong_type;
}

Answer CommandExecutor::reference_search(const Instruction& instruction) {
  const std::uint8_t motor = instruction.motor;
  if (instruction.type > static_cast<std::uint8_t>(Search::status)) {
    return {Status::wrong_type, instruction.value};
  }
  if (!is_motor(motor)) {
    return {Status::invalid_value, instruction.value};
  }
  switch (static_cast<Search>(instruction.type)) {
    case Search::start:
      module_.start_reference_search(motor);
      break;
    case Search::stop:
      module_.stop_reference_search(motor);
      break;
    case Search::status:
      return {Status::success, module_.reference_search_state(motor)};
  }
  return {Status::success, instruction.value};
}

Status CommandExecutor::set_coordinate(const Instruction& instruction, std::int32_t position) {
  const std::uint8_t number = instruction.type;
  if (number >= description_.coordinates) {
    return Status::wrong_type;
  }
  const bool from_accumulator =
      static_cast<Command>(instruction.command) == Command::accumulator_to_coordinate;
  if (instruction.motor == kCopyCoordinate && !from_accumulator) {
    return copy_coordinates(number, true);
  }
  if (!is_motor(instruction.motor)) {
    return Status::invalid_value;
  }
  module_.set_coordinate(number, position);
  if (number != 0 && configuration(GlobalParameter::coordinate_storage) != 0) {
    module_.store_coordinate(number);
  }
  return Status::success;
}

Answer CommandExecutor::get_coordinate(const Instruction& instruction) {
  const std::uint8_t number = instruction.type;
  if (number >= description_.coordinates) {
    return {Status::wrong_type, instruction.value};
  }
  if (instruction.motor == kCopyCoordinate) {
    return {copy_coordinates(number, false), module_.coordinate(number)};
  }
  if (!is_motor(instruction.motor)) {
    return {Status::invalid_value, instruction.value};
  }
  return {Status::success, module_.coordinate(number)};
}

Status CommandExecutor::capture_coordinate(const Instruction& instruction) {
  if (instruction.type >= description_.coordinates) {
    return Status::wrong_type;
  }
  if (!is_motor(instruction.motor)) {
    return Status::invalid_value;
  }
  return set_coordinate(instruction, module_.actual_position(instruction.motor));
}

// Number 0 stands for all others, since coordinate 0 itself is kept in RAM only (A63).
Status CommandExecutor::copy_coordinates(std::uint8_t number, bool store) {
  const std::uint8_t first = number == 0 ? std::uint8_t{1} : number;
  const std::uint8_t last =
      number == 0 ? static_cast<std::uint8_t>(description_.coordinates - 1) : number;
  for (std::uint8_t each = first; each <= last; ++each) {
    if (store) {
      module_.store_coordinate(each);
    } else {
      module_.restore_coordinate(each);
    }
  }
  return Status::success;
}

Status CommandExecutor::set_output(const Instruction& instruction) {
  if (instruction.motor != kOutputBank) {
    return Status::wrong_type;
  }
  const std::int32_t value = instruction.value;
  if (instruction.type == kAllPorts) {
    if (value != kFromAccumulator && (value < 0 || value > kOutputBits)) {
      return Status::invalid_value;
    }
    const std::int32_t bits = value == kFromAccumulator ? state_.registers.accumulator : value;
    module_.set_digital_outputs(static_cast<std::uint32_t>(bits & kOutputBits) &
                                description_.outputs);
    return Status::success;
  }
  if (!has_port(description_.outputs, instruction.type)) {
    return Status::wrong_type;
  }
  if (value != 0 && value != 1) {
    return Status::invalid_value;
  }
  const std::uint32_t bit = 1U << instruction.type;
  const std::uint32_t outputs = module_.digital_outputs();
  module_.set_digital_outputs(value == 1 ? outputs | bit : outputs & ~bit);
  return Status::success;
}

Answer CommandExecutor::get_input(const Instruction& instruction) const {
  const std::uint8_t port = instruction.type;
  const auto bit_of = [port](std::uint32_t bits) {
    return Answer{Status::success, static_cast<std::int32_t>(bits >> port & 1U)};
  };
  if (instruction.motor == kDigitalInputBank && port == kAllPorts) {
    return {Status::success,
            static_cast<std::int32_t>(module_.digital_inputs() & description_.digital_inputs &
                                      description_.input_bits)};
  }
  if (instruction.motor == kDigitalInputBank && has_port(description_.digital_inputs, port)) {
    return bit_of(module_.digital_inputs());
  }
  if (instruction.motor == kAnalogInputBank && has_port(description_.analog_inputs, port)) {
    return {Status::success, module_.analog_input(port)};
  }
  if (instruction.motor == kOutputBank && has_port(description_.outputs, port)) {
    return bit_of(module_.digital_outputs());
  }
  return {Status::wrong_type, instruction.value};
}

}  // namespace stator::tmcl
