#include "drive/servo_bench.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "stator/base/trigonometry.hpp"

namespace stator::drive {

namespace {

using namespace base::literals;
using dictionary::EntryDeclaration;
using dictionary::hex;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;

constexpr double kStep = 50e-6;
constexpr int kStepsPerTick = 20;
constexpr double kPolePairs = 4.0;
constexpr double kResistance = 0.5;   // ohm
constexpr double kInductance = 5e-4;  // H
constexpr double kFlux = 5e-3;        // Vs
constexpr double kInertia = 1e-5;     // kg m^2
constexpr double kFriction = 2e-5;    // Nm s
constexpr double kSqrt3 = 1.7320508075688772;

constexpr auto kObjects = std::to_array<EntryDeclaration>({
    {.index = 0x6040, .name = "Controlword", .type = unsigned16},
    {.index = 0x6041, .name = "Statusword", .type = unsigned16},
    {.index = 0x605A, .name = "Quick stop option code", .type = integer16, .default_value = 2},
    {.index = 0x605B, .name = "Shutdown option code", .type = integer16},
    {.index = 0x605C, .name = "Disable operation option", .type = integer16, .default_value = 1},
    {.index = 0x605E, .name = "Fault reaction option", .type = integer16, .default_value = 2},
    {.index = 0x6060, .name = "Modes of operation", .type = integer8},
    {.index = 0x6061, .name = "Modes of operation display", .type = integer8},
    {.index = 0x6062, .name = "Position demand value", .type = integer32},
    {.index = 0x6063, .name = "Position actual internal value", .type = integer32},
    {.index = 0x6064, .name = "Position actual value", .type = integer32},
    {.index = 0x6067, .name = "Position window", .default_value = hex(0xFFFFFFFF)},
    {.index = 0x606C, .name = "Velocity actual value", .type = integer32},
    {.index = 0x6071, .name = "Target torque", .type = integer32},
    {.index = 0x6077, .name = "Torque actual value", .type = integer32},
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
    {.index = 0x6081, .name = "Profile velocity"},
    {.index = 0x6082, .name = "End velocity", .type = integer32},
    {.index = 0x6083, .name = "Profile acceleration", .default_value = 2000},
    {.index = 0x6084, .name = "Profile deceleration", .default_value = 2000},
    {.index = 0x6085, .name = "Quick stop deceleration", .default_value = 2000},
    {.index = 0x608F, .name = "Entries", .object_code = array, .type = unsigned8},
    {.index = 0x608F,
     .subindex = 1,
     .name = "Encoder increments",
     .object_code = array,
     .default_value = 4000},
    {.index = 0x6098, .name = "Homing method", .type = integer8},
    {.index = 0x6099, .name = "Entries", .object_code = array, .type = unsigned8},
    {.index = 0x6099, .subindex = 1, .name = "Fast homing speed", .object_code = array},
    {.index = 0x6099, .subindex = 2, .name = "Slow homing speed", .object_code = array},
    {.index = 0x609A, .name = "Homing acceleration", .default_value = 2000},
    {.index = 0x60B2, .name = "Torque offset", .type = integer32},
    {.index = 0x60FF, .name = "Target velocity", .type = integer32},
});

ErrorReactions servo_reactions() {
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
       {AxisError::overcurrent_a, AxisError::overcurrent_b, AxisError::overcurrent_c,
        AxisError::overcurrent_high_side, AxisError::over_temperature, AxisError::shutdown_switch,
        AxisError::overvoltage}) {
    set(error, ErrorReaction::power_off);
  }
  for (const AxisError error :
       {AxisError::undervoltage, AxisError::hall_error, AxisError::initialisation_error}) {
    set(error, ErrorReaction::fault);
  }
  set(AxisError::over_temperature_warning, ErrorReaction::warning);
  return reactions;
}

}  // namespace

void ServoMotor::step(const base::ServoActuation& actuation) {
  const base::SineCosine angle =
      base::sine_cosine(std::fmod(revolutions_ * kPolePairs, 1.0) * base::kTwoPi);
  const double induced = speed_ * kPolePairs * kFlux;
  if (actuation.bridge_enabled) {
    constexpr double kSupply = 24.0;
    const auto [u, v, w] = actuation.duty;
    const double voltage_alpha = kSupply * (2.0 * u - v - w) / 3.0;
    const double voltage_beta = kSupply * (v - w) / kSqrt3;
    alpha_ += kStep / kInductance * (voltage_alpha - kResistance * alpha_ + induced * angle.sine);
    beta_ += kStep / kInductance * (voltage_beta - kResistance * beta_ - induced * angle.cosine);
  } else {
    alpha_ = 0.0;
    beta_ = 0.0;
  }
  const double torque_current = beta_ * angle.cosine - alpha_ * angle.sine;
  const double torque = 1.5 * kPolePairs * kFlux * torque_current + load - kFriction * speed_;
  speed_ += kStep / kInertia * torque;
  if (blocked) {
    speed_ = 0.0;
  }
  revolutions_ += kStep * speed_ / base::kTwoPi;
  keep_between_stops();
}

void ServoMotor::keep_between_stops() {
  if (lower_stop && counts() < *lower_stop) {
    turn_to(*lower_stop);
    speed_ = 0.0;
  }
  if (upper_stop && counts() > *upper_stop) {
    turn_to(*upper_stop);
    speed_ = 0.0;
  }
}

double ServoMotor::rpm() const {
  return speed_ * 60.0 / base::kTwoPi;
}

void ServoMotor::read(base::ServoSensing& sensing) const {
  constexpr std::array<std::uint8_t, 6> kCodes{0b001, 0b011, 0b010, 0b110, 0b100, 0b101};
  sensing.phase_current = {alpha_, -0.5 * alpha_ + 0.5 * kSqrt3 * beta_,
                           -0.5 * alpha_ - 0.5 * kSqrt3 * beta_};
  const auto sector = static_cast<std::int64_t>(std::floor(revolutions_ * kPolePairs * 6.0 + 0.5));
  sensing.halls = kCodes[static_cast<std::size_t>(((sector % 6) + 6) % 6)];
  sensing.encoder_count = static_cast<std::int64_t>(std::floor(counts()));
}

ServoBench::ServoBench() : ObjectBench(control::ServoController::kPeriod * kStepsPerTick) {
  dictionary.add(kObjects);
  dictionary.finish();
  axis = std::make_unique<ServoAxis>(dictionary,
                                     AxisConfiguration{.number = 0, .reactions = servo_reactions()},
                                     base::EventReporter(this, 0));
  axis->conditions().network_operational = true;
  ServoSettings& settings = axis->servo_settings();
  settings.controller.commutation = control::ServoCommutation::encoder;
  settings.maximum_acceleration = 100'000;
  motor.read(sensing);
  axis->tick(now);
}

void ServoBench::pass(base::SimDuration duration) {
  for (const base::SimTime end = now + duration; now < end;) {
    motor.step(actuation);
    motor.read(sensing);
    read_switches();
    actuation = axis->step(sensing);
    now += control::ServoController::kPeriod;
    if (++steps_to_tick_ == kStepsPerTick) {
      steps_to_tick_ = 0;
      axis->conditions().set_switches(
          axis->settings().reference.switches.pressed(switch_levels(sensing)));
      axis->tick(now);
    }
  }
}

void ServoBench::read_switches() {
  sensing.left_switch = left_switch && motor.counts() <= *left_switch;
  sensing.right_switch = right_switch && motor.counts() >= *right_switch;
}

void ServoBench::enable(ModeCode mode) {
  request_operation(mode);
  pass(2_ms);  // the commutation is found
}

}  // namespace stator::drive
