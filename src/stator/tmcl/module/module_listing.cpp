#include "stator/tmcl/module/module_listing.hpp"

#include <algorithm>

#include "stator/tmcl/command.hpp"

namespace stator::tmcl {

namespace {

constexpr std::uint8_t kVariableBank = 2;

std::string range_text(const ParameterDeclaration& parameter) {
  return std::to_string(parameter.minimum) + ".." + std::to_string(parameter.maximum);
}

std::string_view access_text(const ParameterDeclaration& parameter) {
  return !parameter.writable ? "R" : parameter.stored ? "RWE" : "RW";
}

std::string_view stored_text(const ParameterDeclaration& parameter) {
  return !parameter.stored ? "no" : parameter.bank == kVariableBank ? "by STGP" : "yes";
}

bool reads(const CommandDeclaration& command, const Symbol* symbol) {
  switch (command.command) {
    case Command::get_axis_parameter:
    case Command::get_global_parameter:
    case Command::get_input:
    case Command::get_coordinate:
    case Command::get_application_status:
    case Command::get_firmware_version:
      return true;
    case Command::reference_search:
      return symbol != nullptr && symbol->name == "STATUS";
    default:
      return false;
  }
}

std::string_view reply_text(const CommandDeclaration& command, const Symbol* symbol) {
  return !command.use.direct      ? "6, not in direct mode (A83)"
         : reads(command, symbol) ? "100, the value"
                                  : "100, value as sent (A6)";
}

const Operand* operand_in(const CommandDeclaration& command, Field field) {
  const auto found = std::ranges::find(command.operands, field, &Operand::field);
  return found != command.operands.end() ? &*found : nullptr;
}

std::string numbers_up_to(std::size_t count) {
  return count == 1 ? "0" : "0.." + std::to_string(count - 1);
}

/// The numbers of the ports of which `bits` says that they exist.
std::string ports_text(std::uint32_t bits) {
  std::string text;
  for (unsigned port = 0; port < 32; ++port) {
    if ((bits >> port & 1U) != 0) {
      text += (text.empty() ? "" : ",") + std::to_string(port);
    }
  }
  return text;
}

/// The ports that a bank of SIO and GIO has.
std::string ports_of_bank(const ModuleDescription& module, int bank) {
  const std::uint32_t bits = bank == 0   ? module.digital_inputs
                             : bank == 1 ? module.analog_inputs
                                         : module.outputs;
  return "port " + ports_text(bits);
}

std::string bank_text(const CommandDeclaration& command) {
  switch (command.command) {
    case Command::store_global_parameter:
    case Command::restore_global_parameter:
      return "bank 2";
    default:
      return "bank 0 or 2";
  }
}

using CommandRow = std::array<std::string, kCommandColumns.size()>;

std::string operand_text(const ModuleDescription& module, const CommandDeclaration& command,
                         Field field) {
  const Operand* operand = operand_in(command, field);
  if (operand == nullptr) {
    return "any";
  }
  switch (operand->meaning) {
    case Meaning::motor:
      return numbers_up_to(module.axes);
    case Meaning::bank:
      return bank_text(command);
    case Meaning::axis_parameter:
      return "axis parameter";
    case Meaning::global_parameter:
      return "global parameter";
    case Meaning::coordinate:
      return "coordinate " + numbers_up_to(module.coordinates);
    case Meaning::port:
      return "port";
    case Meaning::address:
      return "address " + numbers_up_to(module.program_length);
    case Meaning::ticks:
      return "ticks (10 ms)";
    case Meaning::number:
    case Meaning::symbol:
      break;
  }
  return "-2147483648..2147483647";
}

CommandRow row_of(const ModuleDescription& module, const CommandDeclaration& command,
                  const Symbol* symbol) {
  const std::string mnemonic(command.mnemonic.empty() ? command.name : command.mnemonic);
  return {std::to_string(static_cast<int>(command.command)),
          symbol != nullptr ? mnemonic + ' ' + std::string(symbol->name) : mnemonic,
          symbol != nullptr ? std::to_string(symbol->value)
                            : operand_text(module, command, Field::type),
          operand_text(module, command, Field::motor),
          operand_text(module, command, Field::value),
          std::string(reply_text(command, symbol)),
          std::string(symbol != nullptr ? symbol->source : command.source),
          std::string(command.name)};
}

CommandRow row_of(const ModuleDescription& module, const CommandDeclaration& command,
                  const CommandForm& form) {
  CommandRow row = row_of(module, command, nullptr);
  row[1] = form.name;
  if (form.bank != CommandForm::kAny) {
    row[2] = ports_of_bank(module, form.bank);
    row[3] = "bank " + std::to_string(form.bank);
  }
  if (form.type != CommandForm::kAny) {
    row[2] = std::to_string(form.type);
  }
  row[6] = form.source;
  return row;
}

}  // namespace

std::string_view unit_of(const ParameterDeclaration& parameter) {
  switch (parameter.unit) {
    case ParameterUnit::none:
      return "";
    case ParameterUnit::flag:
      return "flag";
    case ParameterUnit::bits:
      return "bits";
    case ParameterUnit::enumeration:
      return "enum";
    case ParameterUnit::microsteps:
      return "usteps";
    case ParameterUnit::velocity:
      return "usteps/t (TMC457 velocity unit, or usteps/s when AP255=1)";
    case ParameterUnit::acceleration:
      return "usteps/t^2 (TMC457 acceleration unit, or usteps/s^2 when AP255=1)";
    case ParameterUnit::current_scale:
      return "1/15 of module maximum";
    case ParameterUnit::milliseconds:
      return "1 ms";
    case ParameterUnit::other:
      return parameter.unit_text;
  }
  return "";
}

std::vector<std::array<std::string, kAxisParameterColumns.size()>> list_axis_parameters(
    const ModuleDescription& module) {
  std::vector<std::array<std::string, kAxisParameterColumns.size()>> rows;
  for (const ParameterDeclaration& each : module.axis_parameters) {
    rows.push_back({std::to_string(each.number), std::string(each.name),
                    std::string(access_text(each)), range_text(each), std::to_string(each.initial),
                    std::string(unit_of(each)), std::string(stored_text(each)),
                    std::string(each.source), std::string(each.notes)});
  }
  return rows;
}

std::vector<std::array<std::string, kGlobalParameterColumns.size()>> list_global_parameters(
    const ModuleDescription& module) {
  std::vector<std::array<std::string, kGlobalParameterColumns.size()>> rows;
  for (const ParameterDeclaration& each : module.global_parameters) {
    rows.push_back({std::to_string(each.bank), std::to_string(each.number), std::string(each.name),
                    std::string(access_text(each)), range_text(each), std::to_string(each.initial),
                    std::string(unit_of(each)), std::string(stored_text(each)),
                    std::string(each.source), std::string(each.notes)});
  }
  return rows;
}

std::vector<std::array<std::string, kCommandColumns.size()>> list_commands(
    const ModuleDescription& module) {
  std::vector<CommandRow> rows;
  for (const CommandDeclaration& command : module.commands.all()) {
    for (const Symbol& symbol : command.symbols) {
      rows.push_back(row_of(module, command, &symbol));
    }
    for (const CommandForm& form : command.forms) {
      rows.push_back(row_of(module, command, form));
    }
    if (command.symbols.empty() && command.forms.empty()) {
      rows.push_back(row_of(module, command, nullptr));
    }
  }
  return rows;
}

}  // namespace stator::tmcl
