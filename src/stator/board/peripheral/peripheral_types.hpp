#pragma once

#include <span>
#include <string_view>

#include "stator/board/peripheral/declaration.hpp"

namespace stator::board {

// Each is declared beside its model. Constants, though the check sees no initialiser here.
// NOLINTBEGIN(readability-identifier-naming)
extern const PeripheralType kSwitch;
extern const PeripheralType kPushButton;
extern const PeripheralType kPotentiometer;
extern const PeripheralType kLed;
extern const PeripheralType kLoad;
extern const PeripheralType kRcFilter;
extern const PeripheralType kEncoder;
extern const PeripheralType kStepDirMotor;
extern const PeripheralType kBridgeMotor;
extern const PeripheralType kThreePhaseMotor;
extern const PeripheralType kSpiAdc;
extern const PeripheralType kSpiDac;
extern const PeripheralType kSpiEeprom;
extern const PeripheralType kSpiStepperDriver;
extern const PeripheralType kShiftRegister;
extern const PeripheralType kI2cEeprom;
extern const PeripheralType kI2cTemperatureSensor;
extern const PeripheralType kI2cPortExpander;
// NOLINTEND(readability-identifier-naming)

/// All kinds of peripherals, in the order people should see them.
[[nodiscard]] std::span<const PeripheralType* const> peripheral_types();
/// The kind of that name, or null.
[[nodiscard]] const PeripheralType* find_peripheral_type(std::string_view name);

}  // namespace stator::board
