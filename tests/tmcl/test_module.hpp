// A TMCL module of two axes with few parameters, for tests of sessions, interpreter and assembler.
#pragma once

#include <array>

#include "stator/tmcl/module/module_description.hpp"

namespace stator::tmcl::tests {

inline constexpr std::array kAxisParameters{
    ParameterDeclaration{.number = 0, .name = "Target position", .symbol = "TARGET_POSITION"},
    ParameterDeclaration{.number = 5,
                         .name = "Max. acceleration",
                         .symbol = "MAX_ACCELERATION",
                         .minimum = 1,
                         .maximum = 16777215,
                         .unit = ParameterUnit::acceleration},
    ParameterDeclaration{.number = 6,
                         .name = "Max. current",
                         .symbol = "MAX_CURRENT",
                         .stored = true,
                         .minimum = 0,
                         .maximum = 15},
    ParameterDeclaration{
        .number = 8, .name = "Position reached", .symbol = "POSITION_REACHED", .writable = false},
};

inline constexpr std::array kGlobalParameters{
    ParameterDeclaration{
        .number = 65, .name = "baud rate", .symbol = "BAUD_RATE", .minimum = 0, .maximum = 11},
    ParameterDeclaration{
        .number = 73, .name = "lock", .symbol = "LOCK", .minimum = 0, .maximum = 4321},
    ParameterDeclaration{.number = 128, .name = "status", .symbol = "STATUS", .writable = false},
    ParameterDeclaration{.number = 7, .bank = 2, .name = "variable 7", .symbol = "VARIABLE_7"},
};

/// A module of two axes with few parameters and ports and no more coordinates than 0 to 4.
inline ModuleDescription test_module() {
  return {.product = "test-2",
          .commands = classic_command_set(),
          .axis_parameters = kAxisParameters,
          .global_parameters = kGlobalParameters,
          .axes = 2,
          .coordinates = 5,
          .digital_inputs = 0x0F,
          .analog_inputs = 0x01,
          .outputs = 0x87};
}

}  // namespace stator::tmcl::tests
