#include "stator/tmcl/command_set.hpp"

#include <algorithm>

#include "stator/base/spelling.hpp"

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

constexpr std::array<Symbol, 3> kMoves{{{"ABS", 0, "L1007-L1051"},
                                        {"REL", 1, "L1018-L1019;L1029;L1055-L1065"},
                                        {"COORD", 2, "L1020;L1030-L1031;L1066-L1080"}}};
constexpr std::array<Symbol, 3> kSearches{{{"START", 0, "L3497-L3537"},
                                           {"STOP", 1, "L3518;L3521-L3524"},
                                           {"STATUS", 2, "L3519;L3525-L3529"}}};
constexpr std::array<Symbol, 10> kCalculations{{{"ADD", 0, "L3726"},
                                                {"SUB", 1, "L3727"},
                                                {"MUL", 2, "L3728"},
                                                {"DIV", 3, "L3729"},
                                                {"MOD", 4, "L3730"},
                                                {"AND", 5, "L3731"},
                                                {"OR", 6, "L3732"},
                                                {"XOR", 7, "L3733"},
                                                {"NOT", 8, "L3734"},
                                                {"LOAD", 9, "L3735"}}};
constexpr std::array<Symbol, 11> kCalculationsWithX{{{"ADD", 0, "L4278"},
                                                     {"SUB", 1, "L4280"},
                                                     {"MUL", 2, "L4282"},
                                                     {"DIV", 3, "L4284"},
                                                     {"MOD", 4, "L4286"},
                                                     {"AND", 5, "L4287"},
                                                     {"OR", 6, "L4288"},
                                                     {"XOR", 7, "L4290"},
                                                     {"NOT", 8, "L4291"},
                                                     {"LOAD", 9, "L4293"},
                                                     {"SWAP", 10, "L4295"}}};
constexpr std::array<Symbol, 13> kConditions{{{"ZE", 0, "L3830"},
                                              {"NZ", 1, "L3831"},
                                              {"EQ", 2, "L3832"},
                                              {"NE", 3, "L3814"},
                                              {"GT", 4, "L3816"},
                                              {"GE", 5, "L3818"},
                                              {"LT", 6, "L3820"},
                                              {"LE", 7, "L3822"},
                                              {"ETO", 8, "L3824"},
                                              {"EAL", 9, "L3826"},
                                              {"EDV", 10, "L3810"},
                                              {"EPO", 11, "L3810"},
                                              {"ESD", 12, "L3827"}}};
constexpr std::array<Symbol, 5> kWaits{{{"TICKS", 0, "L4008;L4036"},
                                        {"POS", 1, "L4009-L4011;L4038-L4039"},
                                        {"REFSW", 2, "L4012-L4014;L4041-L4042"},
                                        {"LIMSW", 3, "L4015-L4017;L4044-L4045"},
                                        {"RFS", 4, "L4018-L4020;L4047-L4049"}}};
constexpr std::array<Symbol, 6> kErrorFlags{{{"ALL", 0, "L4917"},
                                             {"ETO", 1, "L4919"},
                                             {"EAL", 2, "L4920"},
                                             {"EDV", 3, "L4922"},
                                             {"EPO", 4, "L4923"},
                                             {"ESD", 5, "L4925"}}};

constexpr std::array<CommandForm, 2> kOutputForms{
    {{"SIO", CommandForm::kAny, 2, "L3538-L3573"}, {"SIO all", 255, 2, "L3574-L3592"}}};
constexpr std::array<CommandForm, 4> kInputForms{
    {{"GIO digital", CommandForm::kAny, 0, "L3593-L3689"},
     {"GIO all digital", 255, 0, "L3677-L3688"},
     {"GIO analogue", CommandForm::kAny, 1, "L3690-L3698"},
     {"GIO output", CommandForm::kAny, 2, "L3700-L3708"}}};
constexpr std::array<CommandForm, 2> kRunForms{
    {{"run application (continue)", 0, CommandForm::kAny, "L767-L768;L5068-L5081"},
     {"run application (from address)", 1, CommandForm::kAny, "L769-L771;L5075-L5083"}}};
constexpr std::array<CommandForm, 2> kVersionForms{
    {{"get firmware version (string)", 0, CommandForm::kAny, "L791-L793;L5144-L5199"},
     {"get firmware version (binary)", 1, CommandForm::kAny, "L791-L793;L5201-L5216"}}};

constexpr std::array<Operand, 3> kUserOperands{{kNumberInType, kNumberInMotor, kValue}};

// TMCM-142 TMCL Firmware Manual, tables of chapter 6.
constexpr std::array<CommandDeclaration, 51> kClassic{{
    {rotate_right, "ROR", "rotate right", kEverywhere, {{kMotor, kValue}}, {}, "L874-L915"},
    {rotate_left, "ROL", "rotate left", kEverywhere, {{kMotor, kValue}}, {}, "L916-L957"},
    {motor_stop, "MST", "stop motor", kEverywhere, {{kMotor}}, {}, "L958-L1006"},
    {move_to_position,
     "MVP",
     "move to position",
     kEverywhere,
     {{kOperation, kMotor, kValue}},
     kMoves,
     "L1007-L1051;L1018-L1019;L1029;L1055-L1065;L1020;L1030-L1031;L1066-L1080"},
    {set_axis_parameter,
     "SAP",
     "set axis parameter",
     kEverywhere,
     {{kAxisParameter, kMotor, kValue}},
     {},
     "L1081-L1431"},
    {get_axis_parameter,
     "GAP",
     "get axis parameter",
     kEverywhere,
     {{kAxisParameter, kMotor}},
     {},
     "L1432-L2164"},
    {store_axis_parameter,
     "STAP",
     "store axis parameter",
     kEverywhere,
     {{kAxisParameter, kMotor}},
     {},
     "L2165-L2545"},
    {restore_axis_parameter,
     "RSAP",
     "restore axis parameter",
     kEverywhere,
     {{kAxisParameter, kMotor}},
     {},
     "L2546-L2888"},
    {set_global_parameter,
     "SGP",
     "set global parameter",
     kEverywhere,
     {{kGlobalParameter, kBank, kValue}},
     {},
     "L2889-L3146"},
    {get_global_parameter,
     "GGP",
     "get global parameter",
     kEverywhere,
     {{kGlobalParameter, kBank}},
     {},
     "L3147-L3335"},
    {store_global_parameter,
     "STGP",
     "store global parameter",
     kEverywhere,
     {{kGlobalParameter, kBank}},
     {},
     "L3336-L3419"},
    {restore_global_parameter,
     "RSGP",
     "restore global parameter",
     kEverywhere,
     {{kGlobalParameter, kBank}},
     {},
     "L3420-L3496"},
    {reference_search,
     "RFS",
     "reference search",
     kEverywhere,
     {{kOperation, kMotor}},
     kSearches,
     "L3497-L3537;L3518;L3521-L3524;L3519;L3525-L3529"},
    {set_output,
     "SIO",
     "set output",
     kEverywhere,
     {{kPort, kBank, kValue}},
     {},
     "L3538-L3573;L3574-L3592",
     kOutputForms},
    {get_input,
     "GIO",
     "get input or output",
     kEverywhere,
     {{kPort, kBank}},
     {},
     "L3593-L3689;L3677-L3688;L3690-L3698;L3700-L3708",
     kInputForms},
    {calculate,
     "CALC",
     "calculate with a constant",
     kDirectAndProgram,
     {{kOperation, kValue}},
     kCalculations,
     "L3726;L3727;L3728;L3729;L3730;L3731;L3732;L3733;L3734;L3735"},
    {compare, "COMP", "compare with a constant", kProgram, {{kValue}}, {}, "L3752-L3791"},
    {jump_conditionally,
     "JC",
     "jump conditionally",
     kProgram,
     {{kOperation, kAddress}},
     kConditions,
     "L3830;L3831;L3832;L3814;L3816;L3818;L3820;L3822;L3824;L3826;L3810;L3827"},
    {jump_always, "JA", "jump always", kProgram, {{kAddress}}, {}, "L3857-L3912"},
    {call_subroutine, "CSUB", "call subroutine", kProgram, {{kAddress}}, {}, "L3913-L3953"},
    {return_from_subroutine, "RSUB", "return from subroutine", kProgram, {}, {}, "L3954-L3997"},
    {wait,
     "WAIT",
     "wait",
     kProgram,
     {{kOperation, kMotor, kTicks}},
     kWaits,
     "L4008;L4036;L4009-L4011;L4038-L4039;L4012-L4014;L4041-L4042;L4015-L4017;L4044-L4045;L4018-"
     "L4020;L4047-L4049"},
    {stop, "STOP", "end of program", kProgram, {}, {}, "L653;L4067-L4109"},
    {set_coordinate,
     "SCO",
     "set coordinate",
     kEverywhere,
     {{kCoordinate, kMotor, kValue}},
     {},
     "L4110-L4139"},
    {get_coordinate,
     "GCO",
     "get coordinate",
     kEverywhere,
     {{kCoordinate, kMotor}},
     {},
     "L4140-L4179"},
    {capture_coordinate,
     "CCO",
     "capture coordinate",
     kEverywhere,
     {{kCoordinate, kMotor}},
     {},
     "L4180-L4210"},
    {calculate_with_x,
     "CALCX",
     "calculate with the X register",
     kDirectAndProgram,
     {{kOperation}},
     kCalculationsWithX,
     "L4278;L4280;L4282;L4284;L4286;L4287;L4288;L4290;L4291;L4293;L4295"},
    {accumulator_to_axis_parameter,
     "AAP",
     "accumulator to axis parameter",
     kDirectAndProgram,
     {{kAxisParameter, kMotor}},
     {},
     "L4314-L4710"},
    {accumulator_to_global_parameter,
     "AGP",
     "accumulator to global parameter",
     kDirectAndProgram,
     {{kGlobalParameter, kBank}},
     {},
     "L4711-L4887"},
    {clear_error_flags,
     "CLE",
     "clear error flags",
     kProgram,
     {{kOperation}},
     kErrorFlags,
     "L4917;L4919;L4920;L4922;L4923;L4925"},
    {accumulator_to_coordinate,
     "ACO",
     "accumulator to coordinate",
     kDirectAndProgram,
     {{kCoordinate, kMotor}},
     {},
     "L4211-L4254"},
    {user_function_0, "UF0", "user function 0", kEverywhere, kUserOperands, {}, "L4943-L4986"},
    {user_function_1, "UF1", "user function 1", kEverywhere, kUserOperands, {}, "L4943-L4986"},
    {user_function_2, "UF2", "user function 2", kEverywhere, kUserOperands, {}, "L4943-L4986"},
    {user_function_3, "UF3", "user function 3", kEverywhere, kUserOperands, {}, "L4943-L4986"},
    {user_function_4, "UF4", "user function 4", kEverywhere, kUserOperands, {}, "L4943-L4986"},
    {user_function_5, "UF5", "user function 5", kEverywhere, kUserOperands, {}, "L4943-L4986"},
    {user_function_6, "UF6", "user function 6", kEverywhere, kUserOperands, {}, "L4943-L4986"},
    {user_function_7, "UF7", "user function 7", kEverywhere, kUserOperands, {}, "L4943-L4986"},
    {stop_application, "", "stop application", kDirect, {}, {}, "L765-L766;L5057-L5066"},
    {run_application,
     "",
     "run application",
     kDirect,
     {},
     {},
     "L767-L768;L5068-L5081;L769-L771;L5075-L5083",
     kRunForms},
    {step_application, "", "step application", kDirect, {}, {}, "L772-L773;L5085-L5094"},
    {reset_application, "", "reset application", kDirect, {}, {}, "L774-L777;L5096-L5107"},
    {start_download, "", "start download mode", kDirect, {}, {}, "L778-L781;L5109-L5122"},
    {quit_download, "", "quit download mode", kDirect, {}, {}, "L782-L783;L5124-L5134"},
    {read_memory, "", "read TMCL memory", kDirect, {}, {}, "L784-L785;L5135-L5136"},
    {get_application_status,
     "",
     "get application status",
     kDirect,
     {},
     {},
     "L786-L790;L5137-L5142"},
    {get_firmware_version,
     "",
     "get firmware version",
     kDirect,
     {},
     {},
     "L791-L793;L5144-L5199;L5201-L5216",
     kVersionForms},
    {restore_factory_settings,
     "",
     "restore factory settings",
     kDirect,
     {},
     {},
     "L794-L800;L5158-L5172"},
    {request_target_reached_event,
     "",
     "request target position reached event",
     kDirect,
     {},
     {},
     "L4987-L5022"},
    {enter_ascii_mode, "", "enter ASCII mode", kDirect, {}, {}, "L806-L807;L5174-L5184"},
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
