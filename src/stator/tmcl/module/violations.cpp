#include "stator/tmcl/module/violations.hpp"

#include <cstdint>
#include <string_view>
#include <utility>

#include "stator/tmcl/module/global_parameter.hpp"
#include "stator/tmcl/module/module.hpp"
#include "stator/tmcl/module/ports.hpp"

namespace stator::tmcl {

namespace {

using enum Command;

constexpr std::uint8_t kWaitTicks = 0;
constexpr std::uint8_t kMoveToCoordinate = 2;

std::string interval(std::int64_t first, std::int64_t last) {
  return first == last ? std::to_string(first)
                       : std::to_string(first) + ".." + std::to_string(last);
}

/// The ports of a bit mask: "0..2, 7".
std::string list_of(std::uint32_t ports) {
  std::string list;
  for (std::uint8_t first = 0; first < 32; ++first) {
    if (!has_port(ports, first)) {
      continue;
    }
    std::uint8_t last = first;
    while (has_port(ports, static_cast<std::uint8_t>(last + 1))) {
      ++last;
    }
    list += (list.empty() ? "" : ", ") + interval(first, last);
    first = last;
  }
  return list.empty() ? "none" : list;
}

class Examination {
 public:
  Examination(const Instruction& instruction, const CommandDeclaration& declaration,
              const ModuleDescription& module)
      : instruction_(instruction), command_(declaration.command), module_(module) {
    for (const Operand& operand : declaration.operands) {
      examine(operand.meaning, operand.field);
    }
    if (command_ == move_to_position && instruction_.type == kMoveToCoordinate) {
      examine_coordinate(Field::value, instruction_.value);
    }
  }

  [[nodiscard]] std::vector<Violation> violations() && { return std::move(violations_); }

 private:
  void examine(Meaning meaning, Field field) {
    if (meaning == Meaning::motor) {
      examine_motor();
    } else if (meaning == Meaning::axis_parameter) {
      examine_parameter(module_.axis_parameter(instruction_.type), "axis parameter ", "",
                        command_ != get_axis_parameter);
    } else if (meaning == Meaning::global_parameter) {
      examine_parameter(
          module_.global_parameter(instruction_.motor, instruction_.type), "global parameter ",
          " in bank " + std::to_string(instruction_.motor),
          command_ == set_global_parameter || command_ == accumulator_to_global_parameter);
    } else if (meaning == Meaning::coordinate) {
      examine_coordinate(field, instruction_.type);
    } else if (meaning == Meaning::port) {
      examine_port();
    } else if (meaning == Meaning::ticks && instruction_.value < 0) {
      object(field,
             "found " + std::to_string(instruction_.value) + " ticks; a time is not negative");
    }
  }

  void examine_motor() {
    const bool ignored = command_ == wait && instruction_.type == kWaitTicks;
    const bool copies = (command_ == set_coordinate || command_ == get_coordinate) &&
                        instruction_.motor == kCopyCoordinate;
    if (instruction_.motor >= module_.axes && !ignored && !copies) {
      object(Field::motor, "found motor " + std::to_string(instruction_.motor) + "; the " +
                               std::string(module_.product) + " has motor " +
                               interval(0, module_.axes - 1));
    }
  }

  void examine_parameter(const ParameterDeclaration* parameter, std::string_view kind,
                         const std::string& bank, bool writes) {
    const std::string name = std::string(kind) + std::to_string(instruction_.type) + bank;
    if (parameter == nullptr) {
      object(Field::type, "the " + std::string(module_.product) + " has no " + name);
      return;
    }
    const std::string full_name = name + " (" + std::string(parameter->name) + ')';
    if (writes && !parameter->writable) {
      object(Field::type, full_name + " can only be read");
    } else if (keeps() && !parameter->stored && !parameter->storable) {
      object(Field::type, full_name + " is not kept in the EEPROM");
    } else if (command_ == set_axis_parameter || command_ == set_global_parameter) {
      examine_value(*parameter, full_name);
    }
  }

  [[nodiscard]] bool keeps() const {
    return command_ == store_axis_parameter || command_ == restore_axis_parameter ||
           command_ == store_global_parameter || command_ == restore_global_parameter;
  }

  void examine_value(const ParameterDeclaration& parameter, const std::string& full_name) {
    const std::int32_t value = instruction_.value;
    const bool too_large =
        value > parameter.maximum && parameter.unit != ParameterUnit::acceleration;
    if (is_lock()) {
      if (value != kLockEeprom && value != kUnlockEeprom) {
        object(Field::value, full_name + " takes " + std::to_string(kLockEeprom) + " to lock and " +
                                 std::to_string(kUnlockEeprom) + " to unlock; found " +
                                 std::to_string(value));
      }
    } else if (value < parameter.minimum || too_large) {
      object(Field::value, full_name + " takes " + interval(parameter.minimum, parameter.maximum) +
                               "; found " + std::to_string(value));
    }
  }

  /// Takes two keys, whatever lies between them (A60).
  [[nodiscard]] bool is_lock() const {
    return command_ == set_global_parameter && instruction_.motor == kConfigurationBank &&
           static_cast<GlobalParameter>(instruction_.type) == GlobalParameter::eeprom_lock;
  }

  void examine_port() {
    const bool sets = command_ == set_output;
    const std::uint8_t bank = instruction_.motor;
    if (bank == kOutputBank) {
      examine_port_of("output ", module_.outputs, sets);
    } else if (sets) {
      object(Field::motor, "found bank " + std::to_string(bank) + "; outputs are in bank " +
                               std::to_string(kOutputBank));
    } else if (bank == kDigitalInputBank) {
      examine_port_of("digital input ", module_.digital_inputs, true);
    } else if (bank == kAnalogInputBank) {
      examine_port_of("analog input ", module_.analog_inputs, false);
    } else {
      object(Field::motor,
             "found bank " + std::to_string(bank) +
                 "; digital inputs are in bank 0, analog ones in bank 1, outputs in bank 2");
    }
    if (sets && bank == kOutputBank) {
      examine_output_value();
    }
  }

  void examine_port_of(std::string_view kind, std::uint32_t ports, bool takes_all) {
    const std::uint8_t port = instruction_.type;
    if (!has_port(ports, port) && !(takes_all && port == kAllPorts)) {
      object(Field::type, "found " + std::string(kind) + std::to_string(port) + "; the " +
                              std::string(module_.product) + " has " + list_of(ports) +
                              (takes_all ? ", and 255 for all" : ""));
    }
  }

  void examine_output_value() {
    const bool all = instruction_.type == kAllPorts;
    const std::int32_t value = instruction_.value;
    if (value < (all ? kFromAccumulator : 0) || value > (all ? kOutputBits : 1)) {
      object(Field::value,
             (all ? "all outputs take " + interval(0, kOutputBits) + ", and -1 for the accumulator"
                  : "an output takes 0 or 1") +
                 std::string("; found ") + std::to_string(value));
    }
  }

  void examine_coordinate(Field field, std::int32_t number) {
    if (number < 0 || number >= module_.coordinates) {
      object(field, "found coordinate " + std::to_string(number) + "; the " +
                        std::string(module_.product) + " has " +
                        interval(0, module_.coordinates - 1));
    }
  }

  void object(Field field, std::string message) {
    violations_.push_back({field, std::move(message)});
  }

  const Instruction& instruction_;
  Command command_;
  const ModuleDescription& module_;
  std::vector<Violation> violations_;
};

}  // namespace

std::vector<Violation> violations_of(const Instruction& instruction,
                                     const CommandDeclaration& declaration,
                                     const ModuleDescription& module) {
  return Examination(instruction, declaration, module).violations();
}

}  // namespace stator::tmcl
