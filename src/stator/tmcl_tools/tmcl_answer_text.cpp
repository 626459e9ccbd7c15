#include "stator/tmcl_tools/tmcl_answer_text.hpp"

#include <fmt/format.h>

#include "stator/tmcl/command.hpp"

namespace stator::tmcl_tools {

namespace {

/// Banks of GIO.
constexpr std::uint8_t kAnalogBank = 1;
constexpr std::uint8_t kOutputBank = 2;
constexpr std::uint8_t kAllPorts = 255;

std::string parameter_text(std::string_view kind, const tmcl::ParameterDeclaration* parameter,
                           int number, std::int32_t value) {
  if (parameter == nullptr) {
    return fmt::format("{} {} = {}", kind, number, value);
  }
  const std::string_view unit = unit_text(*parameter);
  return fmt::format("{} ({} {}) = {}{}{}", parameter->symbol, kind, number, value,
                     unit.empty() ? "" : ", ", unit);
}

std::string port_text(const tmcl::Instruction& instruction, std::int32_t value) {
  const std::string_view kind = instruction.motor == kAnalogBank   ? "analog input"
                                : instruction.motor == kOutputBank ? "output"
                                                                   : "input";
  if (instruction.type == kAllPorts) {
    return fmt::format("all {}s = {} ({:08b})", kind, value, static_cast<std::uint32_t>(value));
  }
  return fmt::format("{} {} = {}", kind, instruction.type, value);
}

}  // namespace

std::string_view unit_text(const tmcl::ParameterDeclaration& parameter) {
  switch (parameter.unit) {
    case tmcl::ParameterUnit::microsteps:
      return "microsteps";
    case tmcl::ParameterUnit::velocity:
      return "unit of velocities as axis parameter 255 says";
    case tmcl::ParameterUnit::acceleration:
      return "unit of accelerations as axis parameter 255 says";
    case tmcl::ParameterUnit::current_scale:
      return "of 15";
    case tmcl::ParameterUnit::milliseconds:
      return "ms";
    case tmcl::ParameterUnit::other:
      return parameter.unit_text;
    default:
      return "";
  }
}

std::string answer_text(const tmcl::Instruction& instruction, tmcl::Status status,
                        std::int32_t value, const tmcl::ModuleDescription& module) {
  if (status == tmcl::Status::loaded_into_eeprom) {
    return std::string(tmcl::status_text(status));
  }
  if (status != tmcl::Status::success) {
    return fmt::format("refused: {} (status {})", tmcl::status_text(status),
                       static_cast<int>(status));
  }
  switch (static_cast<tmcl::Command>(instruction.command)) {
    case tmcl::Command::get_axis_parameter:
      return parameter_text("axis parameter", module.axis_parameter(instruction.type),
                            instruction.type, value);
    case tmcl::Command::get_global_parameter:
      return parameter_text(fmt::format("global parameter, bank {},", instruction.motor),
                            module.global_parameter(instruction.motor, instruction.type),
                            instruction.type, value);
    case tmcl::Command::get_input:
      return port_text(instruction, value);
    case tmcl::Command::get_coordinate:
      return fmt::format("coordinate {} = {}, microsteps", instruction.type, value);
    case tmcl::Command::reference_search:
      if (instruction.type == 2) {
        return value == 0 ? "no reference search is active"
                          : fmt::format("reference search is active, state {}", value);
      }
      return "done";
    default:
      return "done";
  }
}

}  // namespace stator::tmcl_tools
