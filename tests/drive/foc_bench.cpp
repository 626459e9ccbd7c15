#include "drive/foc_bench.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace stator::drive {

namespace {

using namespace base::literals;
using control::foc::field;
using dictionary::EntryDeclaration;
using dictionary::hex;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;

constexpr int kPeriodsPerTick = 5;

constexpr auto kObjects = std::to_array<EntryDeclaration>({
    {.index = 0x6040, .name = "Controlword", .type = unsigned16},
    {.index = 0x6041, .name = "Statusword", .type = unsigned16},
    {.index = 0x605A, .name = "Quick stop option code", .type = integer16, .default_value = 2},
    {.index = 0x605B, .name = "Shutdown option code", .type = integer16},
    {.index = 0x605C, .name = "Disable operation option", .type = integer16, .default_value = 1},
    {.index = 0x605D, .name = "Halt option code", .type = integer16, .default_value = 1},
    {.index = 0x605E, .name = "Fault reaction option", .type = integer16, .default_value = 2},
    {.index = 0x6060, .name = "Modes of operation", .type = integer8},
    {.index = 0x6061, .name = "Modes of operation display", .type = integer8},
    {.index = 0x6062, .name = "Position demand value", .type = integer32},
    {.index = 0x6063, .name = "Position actual internal value", .type = integer32},
    {.index = 0x6064, .name = "Position actual value", .type = integer32},
    {.index = 0x6065, .name = "Following error window", .default_value = hex(0xFFFFFFFF)},
    {.index = 0x6066, .name = "Following error time out", .type = unsigned16},
    {.index = 0x6067, .name = "Position window", .default_value = 1000},
    {.index = 0x6068, .name = "Position window time", .type = unsigned16},
    {.index = 0x606B, .name = "Velocity demand value", .type = integer32},
    {.index = 0x606C, .name = "Velocity actual value", .type = integer32},
    {.index = 0x6071, .name = "Target torque", .type = integer16},
    {.index = 0x6074, .name = "Torque demand value", .type = integer16},
    {.index = 0x6077, .name = "Torque actual value", .type = integer16},
    {.index = 0x6078, .name = "Current actual value", .type = integer16},
    {.index = 0x6079, .name = "DC link circuit voltage"},
    {.index = 0x607A, .name = "Target position", .type = integer32},
    {.index = 0x607C, .name = "Home offset", .type = integer32},
    {.index = 0x607D, .name = "Entries", .object_code = array, .type = unsigned8},
    {.index = 0x607D,
     .subindex = 1,
     .name = "Minimum position limit",
     .object_code = array,
     .type = integer32,
     .default_value = -2147483648},
    {.index = 0x607D,
     .subindex = 2,
     .name = "Maximum position limit",
     .object_code = array,
     .type = integer32,
     .default_value = 2147483647},
    {.index = 0x6081, .name = "Profile velocity", .default_value = 1000},
    {.index = 0x6083, .name = "Profile acceleration", .default_value = 10'000},
    {.index = 0x6084, .name = "Profile deceleration", .default_value = 10'000},
    {.index = 0x6085, .name = "Quick stop deceleration", .default_value = 40'000},
    {.index = 0x6086, .name = "Motion profile type", .type = integer16},
    {.index = 0x6087, .name = "Torque slope", .default_value = 1000},
    {.index = 0x608F, .name = "Entries", .object_code = array, .type = unsigned8},
    {.index = 0x608F,
     .subindex = 1,
     .name = "Encoder increments",
     .object_code = array,
     .default_value = 65536},
    {.index = 0x6098, .name = "Homing method", .type = integer8},
    {.index = 0x6099, .name = "Entries", .object_code = array, .type = unsigned8},
    {.index = 0x6099,
     .subindex = 1,
     .name = "Fast homing speed",
     .object_code = array,
     .default_value = 200},
    {.index = 0x6099,
     .subindex = 2,
     .name = "Slow homing speed",
     .object_code = array,
     .default_value = 20},
    {.index = 0x609A, .name = "Homing acceleration", .default_value = 10'000},
    {.index = 0x60B0, .name = "Position offset", .type = integer32},
    {.index = 0x60B1, .name = "Velocity offset", .type = integer32},
    {.index = 0x60B2, .name = "Torque offset", .type = integer16},
    {.index = 0x60B8, .name = "Touch probe function", .type = unsigned16},
    {.index = 0x60B9, .name = "Touch probe status", .type = unsigned16},
    {.index = 0x60BA, .name = "Touch probe 1 positive edge", .type = integer32},
    {.index = 0x60BB, .name = "Touch probe 1 negative edge", .type = integer32},
    {.index = 0x60BC, .name = "Touch probe 2 positive edge", .type = integer32},
    {.index = 0x60BD, .name = "Touch probe 2 negative edge", .type = integer32},
    {.index = 0x60C2, .name = "Entries", .object_code = record, .type = unsigned8},
    {.index = 0x60C2,
     .subindex = 1,
     .name = "Interpolation period",
     .object_code = record,
     .type = unsigned8,
     .default_value = 1},
    {.index = 0x60C2,
     .subindex = 2,
     .name = "Interpolation index",
     .object_code = record,
     .type = integer8,
     .default_value = -3},
    {.index = 0x60D0, .name = "Entries", .object_code = array, .type = unsigned8},
    {.index = 0x60D0,
     .subindex = 1,
     .name = "Touch probe 1 source",
     .object_code = array,
     .type = integer16,
     .default_value = 1},
    {.index = 0x60D0,
     .subindex = 2,
     .name = "Touch probe 2 source",
     .object_code = array,
     .type = integer16,
     .default_value = 2},
    {.index = 0x60D1, .name = "Touch probe 1 positive edge time"},
    {.index = 0x60D2, .name = "Touch probe 1 negative edge time"},
    {.index = 0x60D3, .name = "Touch probe 2 positive edge time"},
    {.index = 0x60D4, .name = "Touch probe 2 negative edge time"},
    {.index = 0x60F4, .name = "Following error actual value", .type = integer32},
    {.index = 0x60FF, .name = "Target velocity", .type = integer32},
    {.index = 0x6502, .name = "Supported drive modes", .default_value = hex(0x3AD)},
});

ErrorReactions foc_reactions() {
  ErrorReactions reactions{};
  const auto set = [&](AxisError error, ErrorReaction reaction) {
    reactions[static_cast<std::size_t>(error)] = reaction;
  };
  for (const AxisError error :
       {AxisError::positive_software_limit, AxisError::negative_software_limit,
        AxisError::positive_limit_switch, AxisError::negative_limit_switch}) {
    set(error, ErrorReaction::stop);
  }
  for (const AxisError error :
       {AxisError::overcurrent_a, AxisError::overcurrent_c, AxisError::shutdown_switch,
        AxisError::initialisation_error, AxisError::hall_error}) {
    set(error, ErrorReaction::power_off);
  }
  for (const AxisError error :
       {AxisError::undervoltage, AxisError::overvoltage, AxisError::following_error}) {
    set(error, ErrorReaction::fault);
  }
  return reactions;
}

}  // namespace

plant::PwmAxisParameters foc_plant() {
  plant::PwmAxisParameters result;
  plant::ThreePhaseMotorParameters motor;
  motor.viscous_friction = 1e-4;
  motor.coulomb_friction = motor.static_friction = 5e-4;
  result.motor = motor;
  result.supply = {.capacitance = 0.0, .source_resistance = 0.0};
  return result;
}

plant::PwmAxisParameters linear_foc_plant() {
  plant::PwmAxisParameters result = foc_plant();
  plant::ThreePhaseMotorParameters motor;
  motor.viscous_friction = motor.coulomb_friction = motor.static_friction = 0.0;
  motor.resistance_coefficient = motor.flux_coefficient = 0.0;
  result.motor = motor;
  result.inverter.on_resistance = 1e-9;
  result.encoders[0].counts_per_revolution = 65536;
  return result;
}

FocBench::FocBench(const plant::PwmAxisParameters& parameters)
    : ObjectBench(base::SimDuration(kPwmPeriod * kPeriodsPerTick)), plant(parameters) {
  dictionary.add(kObjects);
  dictionary.finish();
  configure_block();
  axis = std::make_unique<FocAxis>(
      dictionary,
      AxisConfiguration{
          .number = 0, .reactions = foc_reactions(), .control_period = base::SimDuration(125'000)},
      base::EventReporter(this, 0), block);
  axis->conditions().network_operational = true;
  axis->foc_settings().commutation.method = CommutationMethod::none;
  const double electrical = std::fmod(
      plant.revolutions() * std::get<plant::ThreePhaseMotorParameters>(parameters.motor).pole_pairs,
      1.0);
  block.set(field("ABN_DECODER_PHI_E_OFFSET"), std::lround(electrical * 65536.0));
  FocBench::pass(2_ms);
}

void FocBench::configure_block() {
  const auto set = [this](const control::foc::Field& f, std::int64_t value) {
    block.set(f, value);
  };
  const auto& motor = std::get<plant::ThreePhaseMotorParameters>(plant.parameters().motor);
  set(field("PWM_MAXCNT"), kPwmPeriod / 10 - 1);
  set(field("PWM_SV"), 1);
  set(field("CFG_DSMODULATOR_A"), 1);
  set(field("ADC_I0_OFFSET"), 32768);
  set(field("ADC_I1_OFFSET"), 32768);
  set(field("MOTOR_TYPE"), 3);
  set(field("N_POLE_PAIRS"), motor.pole_pairs);
  set(field("ABN_DECODER_PPR"), plant.parameters().encoders[0].counts_per_revolution);
  set(field("PIDOUT_UQ_UD_LIMITS"), 32767);
  set(field("MODE_PID_TYPE"), 1);
  set(field("PHI_E_SELECTION"), 3);
  set(field("VELOCITY_SELECTION"), 9);
  set(field("POSITION_SELECTION"), 9);
  // Pole-zero cancellation with 8000 rad/s; 24 V / sqrt(3) per 32768, 1 mA.
  const double period = kPwmPeriod * 1e-9;
  const double unit = 24.0 / std::numbers::sqrt3 / 32768.0;
  const std::int64_t p = std::lround(256.0 * motor.quadrature_inductance * 8000.0 * 1e-3 / unit);
  const std::int64_t i =
      std::lround(32768.0 * period * motor.resistance / motor.quadrature_inductance);
  set(field("PID_TORQUE_P"), p);
  set(field("PID_FLUX_P"), p);
  set(field("PID_TORQUE_I"), i);
  set(field("PID_FLUX_I"), i);
  set(field("PID_VELOCITY_P"), 820);
  set(field("PID_VELOCITY_I"), 41);
  set(field("PID_POSITION_P"), 187);
}

control::foc::Inputs FocBench::inputs() const {
  const plant::PwmSensing& sensing = plant.sensing();
  control::foc::Inputs result;
  result.delta_sigma_a.current = sensing.converter.currents;
  result.delta_sigma_a.motor_supply = sensing.converter.voltage;
  result.halls = halls.value_or(sensing.halls);
  result.abn = {.count = sensing.encoders[0].count,
                .passages = sensing.encoders[0].index_passages,
                .n_count = sensing.encoders[0].index_count,
                .n = sensing.encoders[0].index};
  result.enable = axis && axis->bridge_enabled();
  result.left_switch = !(left_switch && revolutions() <= *left_switch);
  result.right_switch = !(right_switch && revolutions() >= *right_switch);
  result.home_switch =
      !(home_switch && revolutions() >= (*home_switch)[0] && revolutions() <= (*home_switch)[1]);
  return result;
}

void FocBench::step() {
  const control::foc::Outputs& outputs = block.step(inputs());
  plant::PwmActuation actuation;
  actuation.bridge_enabled =
      outputs.enable && outputs.pwm.chopper == control::foc::Chopper::centred;
  for (std::size_t k = 0; k < 3; ++k) {
    actuation.duty[k] = static_cast<double>(outputs.pwm.on_time[k]) / outputs.pwm.period;
  }
  plant.step(actuation, base::SimDuration(kPwmPeriod));
  now += base::SimDuration(kPwmPeriod);
  axis->observe({.probe = probe, .now = now});
  if (++periods_ % kPeriodsPerTick == 0) {
    axis->tick(now);
  }
}

void FocBench::pass(base::SimDuration duration) {
  for (const base::SimTime end = now + duration; now < end;) {
    step();
  }
}

void FocBench::enable(ModeCode mode) {
  request_operation(mode);
  pass(1_ms);
}

double FocBench::rpm() const {
  return plant.speed() * 30.0 / std::numbers::pi;
}

double FocBench::commutation_error() const {
  const auto& motor = std::get<plant::ThreePhaseMotorParameters>(plant.parameters().motor);
  const double rotor = revolutions() * motor.pole_pairs * 65536.0;
  return std::remainder(get(field("PHI_E")) - rotor, 65536.0) * 360.0 / 65536.0;
}

}  // namespace stator::drive
