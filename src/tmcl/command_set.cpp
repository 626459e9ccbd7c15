#include "tmcl/command_set.hpp"

#include <algorithm>

#include "base/spelling.hpp"

namespace stator::tmcl {

namespace {

using enum Command;

constexpr CommandUse kEverywhere{.direct = true, .program = true, .ascii = true};
constexpr CommandUse kDirectAndProgram{.direct = true, .program = true};
constexpr CommandUse kProgram{.program = true};
constexpr CommandUse kDirect{.direct = true};

constexpr Operand kMotor{Field::motor, Meaning::motor};
constexpr Operand kBank{Field::motor, Meaning::bank};
constexpr Operand kValue{Field::value, Meaning::number};
constexpr Operand kOperation{Field::type, Meaning::symbol};
constexpr Operand kAxisParameter{Field::type, Meaning::axis_parameter};
constexpr Operand kGlobalParameter{Field::type, Meaning::global_parameter};
constexpr Operand kCoordinate{Field::type, Meaning::coordinate};
constexpr Operand kPort{Field::type, Meaning::port};
constexpr Operand kAddress{Field::value, Meaning::address};
constexpr Operand kTicks{Field::value, Meaning::ticks};
constexpr Operand kNumberInType{Field::type, Meaning::number};
constexpr Operand kNumberInMotor{Field::motor, Meaning::number};

constexpr std::array<Symbol, 3> kMoves{{{"ABS", 0}, {"REL", 1}, {"COORD", 2}}};
constexpr std::array<Symbol, 3> kSearches{{{"START", 0}, {"STOP", 1}, {"STATUS", 2}}};
constexpr std::array<Symbol, 10> kCalculations{{{"ADD", 0},
                                                {"SUB", 1},
                                                {"MUL", 2},
                                                {"DIV", 3},
                                                {"MOD", 4},
                                                {"AND", 5},
                                                {"OR", 6},
                                                {"XOR", 7},
                                                {"NOT", 8},
                                                {"LOAD", 9}}};
constexpr std::array<Symbol, 11> kCalculationsWithX{{{"ADD", 0},
                                                     {"SUB", 1},
                                                     {"MUL", 2},
                                                     {"DIV", 3},
                                                     {"MOD", 4},
                                                     {"AND", 5},
                                                     {"OR", 6},
                                                     {"XOR", 7},
                                                     {"NOT", 8},
                                                     {"LOAD", 9},
                                                     {"SWAP", 10}}};
constexpr std::array<Symbol, 13> kConditions{{{"ZE", 0},
                                              {"NZ", 1},
                                              {"EQ", 2},
                                              {"NE", 3},
                                              {"GT", 4},
                                              {"GE", 5},
                                              {"LT", 6},
                                              {"LE", 7},
                                              {"ETO", 8},
                                              {"EAL", 9},
                                              {"EDV", 10},
                                              {"EPO", 11},
                                              {"ESD", 12}}};
constexpr std::array<Symbol, 5> kWaits{
    {{"TICKS", 0}, {"POS", 1}, {"REFSW", 2}, {"LIMSW", 3}, {"RFS", 4}}};
constexpr std::array<Symbol, 6> kErrorFlags{
    {{"ALL", 0}, {"ETO", 1}, {"EAL", 2}, {"EDV", 3}, {"EPO", 4}, {"ESD", 5}}};

constexpr std::array<Operand, 3> kUserOperands{{kNumberInType, kNumberInMotor, kValue}};

// TMCM-142 TMCL Firmware Manual, tables of chapter 6.
constexpr std::array<CommandDeclaration, 51> kClassic{{
    {rotate_right, "ROR", "rotate right", kEverywhere, {{kMotor, kValue}}},
    {rotate_left, "ROL", "rotate left", kEverywhere, {{kMotor, kValue}}},
    {motor_stop, "MST", "stop motor", kEverywhere, {{kMotor}}},
    {move_to_position,
     "MVP",
     "move to position",
     kEverywhere,
     {{kOperation, kMotor, kValue}},
     kMoves},
    {set_axis_parameter,
     "SAP",
     "set axis parameter",
     kEverywhere,
     {{kAxisParameter, kMotor, kValue}}},
    {get_axis_parameter, "GAP", "get axis parameter", kEverywhere, {{kAxisParameter, kMotor}}},
    {store_axis_parameter, "STAP", "store axis parameter", kEverywhere, {{kAxisParameter, kMotor}}},
    {restore_axis_parameter,
     "RSAP",
     "restore axis parameter",
     kEverywhere,
     {{kAxisParameter, kMotor}}},
    {set_global_parameter,
     "SGP",
     "set global parameter",
     kEverywhere,
     {{kGlobalParameter, kBank, kValue}}},
    {get_global_parameter, "GGP", "get global parameter", kEverywhere, {{kGlobalParameter, kBank}}},
    {store_global_parameter,
     "STGP",
     "store global parameter",
     kEverywhere,
     {{kGlobalParameter, kBank}}},
    {restore_global_parameter,
     "RSGP",
     "restore global parameter",
     kEverywhere,
     {{kGlobalParameter, kBank}}},
    {reference_search, "RFS", "reference search", kEverywhere, {{kOperation, kMotor}}, kSearches},
    {set_output, "SIO", "set output", kEverywhere, {{kPort, kBank, kValue}}},
    {get_input, "GIO", "get input or output", kEverywhere, {{kPort, kBank}}},
    {calculate,
     "CALC",
     "calculate with a constant",
     kDirectAndProgram,
     {{kOperation, kValue}},
     kCalculations},
    {compare, "COMP", "compare with a constant", kProgram, {{kValue}}},
    {jump_conditionally,
     "JC",
     "jump conditionally",
     kProgram,
     {{kOperation, kAddress}},
     kConditions},
    {jump_always, "JA", "jump always", kProgram, {{kAddress}}},
    {call_subroutine, "CSUB", "call subroutine", kProgram, {{kAddress}}},
    {return_from_subroutine, "RSUB", "return from subroutine", kProgram},
    {wait, "WAIT", "wait", kProgram, {{kOperation, kMotor, kTicks}}, kWaits},
    {stop, "STOP", "end of program", kProgram},
    {set_coordinate, "SCO", "set coordinate", kEverywhere, {{kCoordinate, kMotor, kValue}}},
    {get_coordinate, "GCO", "get coordinate", kEverywhere, {{kCoordinate, kMotor}}},
    {capture_coordinate, "CCO", "capture coordinate", kEverywhere, {{kCoordinate, kMotor}}},
    {calculate_with_x,
     "CALCX",
     "calculate with the X register",
     kDirectAndProgram,
     {{kOperation}},
     kCalculationsWithX},
    {accumulator_to_axis_parameter,
     "AAP",
     "accumulator to axis parameter",
     kDirectAndProgram,
     {{kAxisParameter, kMotor}}},
    {accumulator_to_global_parameter,
     "AGP",
     "accumulator to global parameter",
     kDirectAndProgram,
     {{kGlobalParameter, kBank}}},
    {clear_error_flags, "CLE", "clear error flags", kProgram, {{kOperation}}, kErrorFlags},
    {accumulator_to_coordinate,
     "ACO",
     "accumulator to coordinate",
     kDirectAndProgram,
     {{kCoordinate, kMotor}}},
    {user_function_0, "UF0", "user function 0", kEverywhere, kUserOperands},
    {user_function_1, "UF1", "user function 1", kEverywhere, kUserOperands},
    {user_function_2, "UF2", "user function 2", kEverywhere, kUserOperands},
    {user_function_3, "UF3", "user function 3", kEverywhere, kUserOperands},
    {user_function_4, "UF4", "user function 4", kEverywhere, kUserOperands},
    {user_function_5, "UF5", "user function 5", kEverywhere, kUserOperands},
    {user_function_6, "UF6", "user function 6", kEverywhere, kUserOperands},
    {user_function_7, "UF7", "user function 7", kEverywhere, kUserOperands},
    {stop_application, "", "stop application", kDirect},
    {run_application, "", "run application", kDirect},
    {step_application, "", "step application", kDirect},
    {reset_application, "", "reset application", kDirect},
    {start_download, "", "start download", kDirect},
    {quit_download, "", "quit download", kDirect},
    {read_memory, "", "read memory", kDirect},
    {get_application_status, "", "get application status", kDirect},
    {get_firmware_version, "", "get firmware version", kDirect},
    {restore_factory_settings, "", "restore factory settings", kDirect},
    {request_target_reached_event, "", "request target-reached event", kDirect},
    {enter_ascii_mode, "", "enter ASCII mode", kDirect},
}};

constexpr bool ordered(std::span<const CommandDeclaration> declarations) {
  return std::ranges::is_sorted(declarations, {}, &CommandDeclaration::command);
}
static_assert(ordered(kClassic) && kClassic.back().command == enter_ascii_mode);

constexpr CommandSet kClassicSet{kClassic};

}  // namespace

const CommandDeclaration* CommandSet::find(std::uint8_t command) const {
  const auto number = static_cast<Command>(command);
  const auto found =
      std::ranges::lower_bound(declarations_, number, {}, &CommandDeclaration::command);
  return found != declarations_.end() && found->command == number ? &*found : nullptr;
}

const CommandDeclaration* CommandSet::find(std::string_view mnemonic) const {
  const auto found = std::ranges::find_if(declarations_, [&](const CommandDeclaration& each) {
    return !each.mnemonic.empty() && base::same_word(each.mnemonic, mnemonic);
  });
  return found != declarations_.end() ? &*found : nullptr;
}

const CommandSet& classic_command_set() {
  return kClassicSet;
}

}  // namespace stator::tmcl
