#include "devices/drive_sequences/vocabulary.hpp"

#include <array>

namespace stator::tests {

namespace {

constexpr DriveStep object(std::uint16_t index, std::int64_t value, std::uint8_t subindex = 0) {
  return {.action = DriveAction::write, .index = index, .subindex = subindex, .value = value};
}

constexpr std::array kEveryMode{1, 3, 8, 9, 6, 4, 10, 0};
constexpr std::array kServoModes{1, 3, 10, 6, 0};
constexpr std::array kStepperModes{1, 3, 8, 9, 6, 0};
constexpr std::array kQuickStops{2, 1, 5, 6, 0};
constexpr std::array kQuickStopsWithRamp{2, 1, 5, 6};
constexpr std::array kHalts{1, 2, 3, 4};
constexpr std::array kFaultReactions{2, 1, 0};
constexpr std::array kChipHoming{34, 33, 17, 18, 35, 37, 1, 2, -1};
constexpr std::array kServoHoming{17, 18, 35, -1, -2};
constexpr std::array kModuleHoming{17, 18, 35, 21, 1};
constexpr std::array kAlStates{4, 2, 1};
constexpr std::array kNmtCommands{0x80, 2};
constexpr std::array kSupplies{24.0, 20.0, 14.0, 27.0, 6.0};
constexpr std::array kChipSupplies{24.0, 18.0, 30.0, 12.0, 6.0};
constexpr std::array kModuleSupplies{24.0, 20.0, 14.0, 27.0};

constexpr std::array kChipPreparation{object(0x6081, 2000)};
// Ramps up to 20,000 rpm/s, and a chopper that takes what the motor feeds back.
constexpr std::array kServoPreparation{
    object(0x2020, 20'000, 3), object(0x2090, 1, 1),   object(0x6081, 1500),
    object(0x6083, 10'000),    object(0x6084, 10'000), object(0x6085, 20'000),
    object(0x6099, 300, 1),    object(0x6099, 60, 2),  object(0x609A, 5000)};
constexpr std::array kModulePreparation{object(0x6081, 256'000),   object(0x6083, 512'000),
                                        object(0x6084, 512'000),   object(0x6085, 2'048'000),
                                        object(0x6099, 64'000, 1), object(0x6099, 12'800, 2),
                                        object(0x609A, 512'000)};

constexpr Vocabulary kTmc8670{.counts = 65'536.0,
                              .velocity = 60.0,
                              .acceleration = 60.0,
                              .slowest = 0.3,
                              .fastest = 66.0,
                              .gentlest = 15.0,
                              .steepest = 3000.0,
                              .farthest = 40.0,
                              .modes = kEveryMode,
                              .quick_stop_options = kQuickStops,
                              .halt_options = kHalts,
                              .other_options = kFaultReactions,
                              .homing_methods = kChipHoming,
                              .network_states = kAlStates,
                              .operational = 8,
                              .load = 0.12,
                              .inertia = 4e-5,
                              .supplies = kChipSupplies,
                              .torque = 800,
                              .torque_limit_index = 0x6072,
                              .torque_limit_minimum = 200,
                              .torque_limit_maximum = 2000,
                              .process_data = true,
                              .following_error = true,
                              .following_time_out = true,
                              .maximum_profile_velocity = true,
                              .interpolation = true,
                              .preparation = kChipPreparation};

constexpr Vocabulary kTmcm3315{.counts = 51'200.0,
                               .velocity = 51'200.0,
                               .acceleration = 51'200.0,
                               .slowest = 0.05,
                               .fastest = 12.0,
                               .gentlest = 4.0,
                               .steepest = 60.0,
                               .farthest = 20.0,
                               .modes = kStepperModes,
                               .quick_stop_options = kQuickStopsWithRamp,
                               .halt_options = kHalts,
                               .other_options = kFaultReactions,
                               .homing_methods = kModuleHoming,
                               .network_states = kAlStates,
                               .operational = 8,
                               .load = 0.3,
                               .inertia = 2e-5,
                               .supplies = kModuleSupplies,
                               .process_data = true,
                               .following_error = true,
                               .interpolation = true,
                               .preparation = kModulePreparation};

constexpr Vocabulary servo(double counts) {
  return {.counts = counts,
          .velocity = 60.0,
          .acceleration = 60.0,
          .slowest = 2.0,
          .fastest = 60.0,
          .gentlest = 15.0,
          .steepest = 330.0,
          .farthest = 30.0,
          .modes = kServoModes,
          .quick_stop_options = kQuickStopsWithRamp,
          .halt_options = {},
          .other_options = {},
          .homing_methods = kServoHoming,
          .network_states = kNmtCommands,
          .operational = 1,
          .load = 0.06,
          .inertia = 2e-5,
          .supplies = kSupplies,
          .torque = 3000,
          .torque_limit_index = 0x2020,
          .torque_limit_subindex = 1,
          .torque_limit_minimum = 1500,
          .torque_limit_maximum = 6000,
          .preparation = kServoPreparation};
}
constexpr Vocabulary kTmcc160Hall = servo(24.0);
constexpr Vocabulary kTmcc160Encoder = servo(4000.0);

}  // namespace

const Vocabulary& vocabulary_of(Product product) {
  switch (product) {
    case Product::tmc8670:
      return kTmc8670;
    case Product::tmcc160_hall:
      return kTmcc160Hall;
    case Product::tmcc160_encoder:
      return kTmcc160Encoder;
    case Product::tmcm_3315:
    case Product::tmcm_142:
      return kTmcm3315;
  }
  return kTmc8670;
}

}  // namespace stator::tests
