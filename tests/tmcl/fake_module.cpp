#include "tmcl/fake_module.hpp"

namespace stator::tests {

namespace {

using tmcl::ParameterDeclaration;
using tmcl::Status;

constexpr std::uint8_t kTarget = 0;
constexpr std::uint8_t kActual = 1;
constexpr std::uint8_t kTargetSpeed = 2;
/// Clears itself by reading.
constexpr std::uint8_t kErrorFlags = 207;
/// Of its values 0 to 3 the 1 has no meaning.
constexpr std::uint8_t kRampMode = 128;
constexpr std::int32_t kReserved = 1;

constexpr std::array kAxisParameters{
    ParameterDeclaration{.number = kTarget, .name = "target position", .storable = true},
    ParameterDeclaration{.number = kActual, .name = "actual position", .storable = true},
    ParameterDeclaration{.number = kTargetSpeed, .name = "target speed", .storable = true},
    ParameterDeclaration{
        .number = 4, .name = "maximum speed", .stored = true, .minimum = 0, .initial = 500000},
    ParameterDeclaration{.number = 5,
                         .name = "maximum acceleration",
                         .stored = true,
                         .minimum = 1,
                         .maximum = 16777215,
                         .initial = 50000},
    ParameterDeclaration{.number = 6,
                         .name = "maximum current",
                         .stored = true,
                         .minimum = 0,
                         .maximum = 15,
                         .initial = 8},
    ParameterDeclaration{.number = 8, .name = "position reached", .writable = false},
    ParameterDeclaration{.number = 34, .name = "integral sum"},  // writable, but nothing to keep
    ParameterDeclaration{
        .number = kRampMode, .name = "ramp mode", .storable = true, .minimum = 0, .maximum = 3},
    ParameterDeclaration{.number = kErrorFlags, .name = "error flags", .writable = false},
};

constexpr ParameterDeclaration configuration(std::uint8_t number, std::int32_t maximum,
                                             std::int32_t initial) {
  return {.number = number, .stored = true, .minimum = 0, .maximum = maximum, .initial = initial};
}

constexpr std::size_t kVariables = 56;
constexpr std::array kConfiguration{
    configuration(64, 255, 228),
    configuration(65, 11, 0),
    configuration(66, 255, 1),
    configuration(67, 255, 0),
    configuration(69, 8, 8),
    configuration(70, 0x7FF, 2),
    configuration(71, 0x7FF, 1),
    configuration(73, 1, 0),
    configuration(75, 255, 0),
    configuration(76, 255, 2),
    configuration(77, 1, 0),
    configuration(80, 2, 0),
    configuration(81, 3, 0),
    configuration(83, 0x7FF, 0),
    configuration(84, 1, 0),
    ParameterDeclaration{.number = 128, .writable = false},
    ParameterDeclaration{.number = 129, .writable = false},
    ParameterDeclaration{.number = 130, .writable = false},
    ParameterDeclaration{.number = 132},
    ParameterDeclaration{.number = 133, .writable = false},
};

constexpr auto kGlobalParameters = [] {
  std::array<ParameterDeclaration, kConfiguration.size() + kVariables> all{};
  for (std::size_t i = 0; i < kConfiguration.size(); ++i) {
    all[i] = kConfiguration[i];
  }
  for (std::size_t i = 0; i < kVariables; ++i) {
    all[kConfiguration.size() + i] = {
        .number = static_cast<std::uint8_t>(i), .bank = 2, .stored = true};
  }
  return all;
}();

}  // namespace

const tmcl::ModuleDescription& FakeModule::description() {
  static const tmcl::ModuleDescription description{.product = "fake",
                                                   .commands = tmcl::classic_command_set(),
                                                   .axis_parameters = kAxisParameters,
                                                   .global_parameters = kGlobalParameters,
                                                   .version_text = "142V4.45",
                                                   .version_value = 4 << 8 | 45,
                                                   .digital_inputs = 0x1FF,
                                                   .analog_inputs = 0x7,
                                                   .outputs = 0x87};
  return description;
}

FakeModule::FakeModule()
    : axis_table_(kAxisParameters),
      global_table_(kGlobalParameters),
      axis_values_(kAxisParameters),
      global_values_(kGlobalParameters) {}

void FakeModule::power_on() {
  axis_values_.power_on();
  global_values_.power_on();
}

std::size_t FakeModule::axis_place(std::uint8_t number) const {
  return axis_table_.index_of(*axis_table_.find(number));
}

std::size_t FakeModule::global_place(std::uint8_t bank, std::uint8_t number) const {
  return global_table_.index_of(*global_table_.find(bank, number));
}

// What the module's own unit could not take is refused by it, not by the table.
Status FakeModule::rotate(std::uint8_t /*motor*/, std::int32_t speed) {
  constexpr std::int32_t kMost = 2'000'000'000;
  if (speed > kMost || speed < -kMost) {
    return Status::invalid_value;
  }
  velocity = speed;
  if (remember) {
    velocities.push_back(speed);
  }
  return Status::success;
}

void FakeModule::stop(std::uint8_t /*motor*/) {
  velocity = 0;
  if (remember) {
    velocities.push_back(0);
  }
}

Status FakeModule::move_to(std::uint8_t /*motor*/, std::int32_t microsteps) {
  target = microsteps;
  if (remember) {
    targets.push_back(microsteps);
  }
  return Status::success;
}

std::int32_t FakeModule::read_axis_parameter(std::uint8_t /*motor*/, std::uint8_t number) {
  switch (number) {
    case kTarget:
      return target;
    case kActual:
      return position;
    case kTargetSpeed:
      return velocity;
    case 8:
      return reached ? 1 : 0;
    case kErrorFlags: {
      const std::int32_t flags = axis_values_.get(axis_place(number));
      axis_values_.set(axis_place(number), 0);
      return flags;
    }
    default:
      return axis_values_.get(axis_place(number));
  }
}

Status FakeModule::write_axis_parameter(std::uint8_t motor, std::uint8_t number,
                                        std::int32_t value) {
  if (number == kTarget) {
    return move_to(motor, value);
  }
  if (number == kRampMode && value == kReserved) {
    return Status::invalid_value;
  }
  if (number == kActual) {
    position = value;
  }
  axis_values_.set(axis_place(number), value);
  return Status::success;
}

void FakeModule::store_axis_parameter(std::uint8_t /*motor*/, std::uint8_t number) {
  axis_values_.store(axis_place(number));
}

void FakeModule::restore_axis_parameter(std::uint8_t /*motor*/, std::uint8_t number) {
  axis_values_.restore(axis_place(number));
}

std::int32_t FakeModule::read_global_parameter(std::uint8_t bank, std::uint8_t number) const {
  return global_values_.get(global_place(bank, number));
}

void FakeModule::write_global_parameter(std::uint8_t bank, std::uint8_t number,
                                        std::int32_t value) {
  const std::size_t place = global_place(bank, number);
  global_values_.set(place, value);
  if (bank == 0) {
    global_values_.store(place);
  }
}

void FakeModule::store_global_parameter(std::uint8_t bank, std::uint8_t number) {
  global_values_.store(global_place(bank, number));
}

void FakeModule::restore_global_parameter(std::uint8_t bank, std::uint8_t number) {
  global_values_.restore(global_place(bank, number));
}

void FakeModule::restore_factory_settings() {
  axis_values_.restore_factory_settings();
  global_values_.restore_factory_settings();
  ++factory_resets;
}

}  // namespace stator::tests
