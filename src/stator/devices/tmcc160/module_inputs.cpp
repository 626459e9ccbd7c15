#include "stator/devices/tmcc160/module_inputs.hpp"

#include <algorithm>
#include <cmath>

namespace stator::devices::tmcc160 {

namespace {

using dictionary::Entry;

constexpr std::uint32_t kLeft = 1U << 0;
constexpr std::uint32_t kRight = 1U << 1;
constexpr std::uint32_t kEnable = 1U << 2;

// The scales of the converter the document does not state. Taken: 12 bits; currents from
// mid-scale with 20 counts/A; 100 V and 200 K to full scale, the temperature from -50 degC.
constexpr double kFullScale = 4095.0;
constexpr double kMidScale = 2048.0;
constexpr double kCountsPerAmpere = 20.0;
constexpr double kVoltageRange = 100.0;
constexpr double kLowestTemperature = -50.0;
constexpr double kTemperatureRange = 200.0;

std::uint64_t counts(double value) {
  return static_cast<std::uint64_t>(std::lround(std::clamp(value, 0.0, kFullScale)));
}

}  // namespace

ModuleInputs::ModuleInputs(dictionary::Dictionary& dictionary, const base::ServoSensing& sensing)
    : sensing_(sensing) {
  using Read = Entry::ReadHook;
  dictionary.on_read(0x2702, 0, Read::bind<&ModuleInputs::show_digital>(*this));
  dictionary.on_read(0x60FD, 0, Read::bind<&ModuleInputs::show_limit_switches>(*this));
  for (std::uint8_t channel = 1; channel <= 7; ++channel) {
    dictionary.on_read(0x270E, channel, Read::bind<&ModuleInputs::show_analog>(*this));
  }
}

std::uint32_t ModuleInputs::limit_switches() const {
  return (sensing_.left_switch ? kLeft : 0U) | (sensing_.right_switch ? kRight : 0U);
}

void ModuleInputs::show_digital(Entry& entry) {
  entry.set_value(limit_switches() | (enable_ ? kEnable : 0U));
}

void ModuleInputs::show_limit_switches(Entry& entry) {
  entry.set_value(limit_switches());
}

void ModuleInputs::show_analog(Entry& entry) {
  switch (entry.subindex()) {
    case 1:
    case 2:
      entry.set_value(static_cast<std::uint64_t>(noise_.disturb(
          analog_.at(entry.subindex() - 1U), static_cast<std::int32_t>(kFullScale))));
      break;
    case 3:
    case 4:
    case 5:
      entry.set_value(
          counts(kMidScale + kCountsPerAmpere * sensing_.phase_current.at(entry.subindex() - 3U)));
      break;
    case 6:
      entry.set_value(counts(kFullScale / kVoltageRange * sensing_.supply_voltage));
      break;
    default:
      entry.set_value(counts(kFullScale / kTemperatureRange *
                             (sensing_.driver_temperature - kLowestTemperature)));
      break;
  }
}

}  // namespace stator::devices::tmcc160
