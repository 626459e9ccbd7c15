#include "stator/board/peripheral/peripheral_types.hpp"

#include <array>

namespace stator::board {

namespace {

constexpr std::array<const PeripheralType*, 18> kTypes{
    &kStepDirMotor,
    &kBridgeMotor,
    &kThreePhaseMotor,
    &kEncoder,
    &kSpiAdc,
    &kSpiDac,
    &kSpiEeprom,
    &kSpiStepperDriver,
    &kShiftRegister,
    &kI2cEeprom,
    &kI2cTemperatureSensor,
    &kI2cPortExpander,
    &kSwitch,
    &kPushButton,
    &kPotentiometer,
    &kLed,
    &kLoad,
    &kRcFilter,
};

}  // namespace

std::span<const PeripheralType* const> peripheral_types() {
  return kTypes;
}

const PeripheralType* find_peripheral_type(std::string_view name) {
  for (const PeripheralType* type : kTypes) {
    if (type->name == name) {
      return type;
    }
  }
  return nullptr;
}

}  // namespace stator::board
