#include "tmcl/objections.hpp"

#include <cstdint>
#include <string_view>
#include <utility>

namespace stator::tmcl {

namespace {

using enum Command;

/// Of SCO and GCO: the coordinate is copied between RAM and EEPROM.
constexpr std::uint8_t kCopyCoordinate = 255;
constexpr std::uint8_t kWaitTicks = 0;
constexpr std::uint8_t kMoveToCoordinate = 2;

std::string interval(std::int64_t first, std::int64_t last) {
  return first == last ? std::to_string(first)
                       : std::to_string(first) + ".." + std::to_string(last);
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

  [[nodiscard]] std::vector<Objection> objections() && { return std::move(objections_); }

 private:
  void examine(Meaning meaning, Field field) {
    if (meaning == Meaning::motor) {
      examine_motor();
    } else if (meaning == Meaning::axis_parameter) {
      const bool writes = command_ != get_axis_parameter;
      examine_parameter(module_.axis_parameter(instruction_.type), "axis parameter ", "", writes,
                        command_ == set_axis_parameter);
    } else if (meaning == Meaning::global_parameter) {
      const bool writes =
          command_ == set_global_parameter || command_ == accumulator_to_global_parameter;
      examine_parameter(module_.global_parameter(instruction_.motor, instruction_.type),
                        "global parameter ", " in bank " + std::to_string(instruction_.motor),
                        writes, command_ == set_global_parameter);
    } else if (meaning == Meaning::coordinate) {
      examine_coordinate(field, instruction_.type);
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
                         const std::string& bank, bool writes, bool sets_value) {
    const std::string name = std::string(kind) + std::to_string(instruction_.type) + bank;
    if (parameter == nullptr) {
      object(Field::type, "the " + std::string(module_.product) + " has no " + name);
      return;
    }
    const std::string full_name = name + " (" + std::string(parameter->name) + ')';
    if (writes && !parameter->writable) {
      object(Field::type, full_name + " can only be read");
      return;
    }
    const bool too_large =
        instruction_.value > parameter->maximum && parameter->unit != ParameterUnit::acceleration;
    if (sets_value && (instruction_.value < parameter->minimum || too_large)) {
      object(Field::value, full_name + " takes " +
                               interval(parameter->minimum, parameter->maximum) + "; found " +
                               std::to_string(instruction_.value));
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
    objections_.push_back({field, std::move(message)});
  }

  const Instruction& instruction_;
  Command command_;
  const ModuleDescription& module_;
  std::vector<Objection> objections_;
};

}  // namespace

std::vector<Objection> objections_to(const Instruction& instruction,
                                     const CommandDeclaration& declaration,
                                     const ModuleDescription& module) {
  return Examination(instruction, declaration, module).objections();
}

}  // namespace stator::tmcl
