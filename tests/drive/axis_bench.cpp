#include "drive/axis_bench.hpp"

#include <memory>

#include <gtest/gtest.h>

namespace stator::drive {

namespace {

using namespace base::literals;
using dictionary::EntryDeclaration;
using dictionary::hex;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;

constexpr base::SimDuration kStep = 50_us;
constexpr int kStepsPerTick = 20;

constexpr auto kObjects = std::to_array<EntryDeclaration>({
    {.index = 0x6040, .name = "Controlword", .type = unsigned16},
    {.index = 0x6041, .name = "Statusword", .type = unsigned16},
    {.index = 0x605A, .name = "Quick stop option code", .type = integer16, .default_value = 2},
    {.index = 0x605B, .name = "Shutdown option code", .type = integer16, .default_value = 0},
    {.index = 0x605C, .name = "Disable operation option", .type = integer16, .default_value = 1},
    {.index = 0x605E, .name = "Fault reaction option", .type = integer16, .default_value = 2},
    {.index = 0x6060, .name = "Modes of operation", .type = integer8},
    {.index = 0x6061, .name = "Modes of operation display", .type = integer8},
    {.index = 0x6062, .name = "Position demand value", .type = integer32},
    {.index = 0x6063, .name = "Position actual internal value", .type = integer32},
    {.index = 0x6064, .name = "Position actual value", .type = integer32},
    {.index = 0x6065, .name = "Following error window"},
    {.index = 0x6067, .name = "Position window", .default_value = hex(0xFFFFFFFF)},
    {.index = 0x6068, .name = "Position window time", .type = unsigned16},
    {.index = 0x606A, .name = "Sensor selection code", .type = integer16, .default_value = -1},
    {.index = 0x606C, .name = "Velocity actual value", .type = integer32},
    {.index = 0x6071, .name = "Target torque", .type = integer16},
    {.index = 0x6077, .name = "Torque actual value", .type = integer16},
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
    {.index = 0x6082, .name = "End velocity"},
    {.index = 0x6083, .name = "Profile acceleration"},
    {.index = 0x6084, .name = "Profile deceleration"},
    {.index = 0x6085, .name = "Quick stop deceleration", .default_value = 51200},
    {.index = 0x6086, .name = "Motion profile type", .type = unsigned16},
    {.index = 0x608F, .name = "Entries", .object_code = array, .type = unsigned8},
    {.index = 0x608F,
     .subindex = 1,
     .name = "Encoder increments",
     .object_code = array,
     .default_value = AxisBench::kCountsPerRevolution},
    {.index = 0x6098, .name = "Homing method", .type = integer8},
    {.index = 0x6099, .name = "Entries", .object_code = array, .type = unsigned8},
    {.index = 0x6099, .subindex = 1, .name = "Fast homing speed", .object_code = array},
    {.index = 0x6099, .subindex = 2, .name = "Slow homing speed", .object_code = array},
    {.index = 0x609A, .name = "Homing acceleration"},
    {.index = 0x60A4, .name = "Entries", .object_code = array, .type = unsigned8},
    {.index = 0x60A4, .subindex = 1, .name = "Profile jerk 1", .object_code = array},
    {.index = 0x60A4, .subindex = 2, .name = "Profile jerk 2", .object_code = array},
    {.index = 0x60A4, .subindex = 3, .name = "Profile jerk 3", .object_code = array},
    {.index = 0x60A4, .subindex = 4, .name = "Profile jerk 4", .object_code = array},
    {.index = 0x60B0, .name = "Position offset", .type = integer32},
    {.index = 0x60B1, .name = "Velocity offset", .type = integer32},
    {.index = 0x60B2, .name = "Torque offset", .type = integer16},
    {.index = 0x60C2, .name = "Entries", .object_code = record, .type = unsigned8},
    {.index = 0x60C2,
     .subindex = 1,
     .name = "Interpolation time value",
     .object_code = record,
     .type = unsigned8,
     .default_value = 1},
    {.index = 0x60C2,
     .subindex = 2,
     .name = "Interpolation time index",
     .object_code = record,
     .type = integer8,
     .default_value = -3},
    {.index = 0x60F2, .name = "Positioning option code", .type = unsigned16},
    {.index = 0x60FF, .name = "Target velocity", .type = integer32},
});

constexpr ErrorReactions kReactions{ErrorReaction::fault, ErrorReaction::stop, ErrorReaction::stop,
                                    ErrorReaction::stop, ErrorReaction::stop};

}  // namespace

AxisBench::AxisBench() : ObjectBench(kStep * kStepsPerTick) {
  dictionary.add(kObjects);
  dictionary.finish();
  axis = std::make_unique<StepperAxis>(dictionary,
                                       AxisConfiguration{.number = 0, .reactions = kReactions},
                                       base::EventReporter(this, 0));
  axis->conditions().network_operational = true;
  axis->tick(now);
}

void AxisBench::place(std::uint16_t index, std::int64_t value) {
  dictionary::Entry& entry = *dictionary.find(index, 0);
  ASSERT_TRUE(dictionary.write_from_pdo(entry, static_cast<std::uint64_t>(value)));
}

void AxisBench::obey() {
  read_switches();
  axis->apply(now);
}

void AxisBench::pass(base::SimDuration duration) {
  for (const base::SimTime end = now + duration; now < end;) {
    actuation = axis->step(kStep, sensing_);
    sensing_.coil_current = actuation.coil_current_target;
    const std::int64_t motor = axis->motion().ramp().motor_microsteps();
    if (!blocked) {
      turn_shaft(motor - microsteps_seen_);
    }
    microsteps_seen_ = motor;
    read_switches();
    now += kStep;
    if (++steps_to_tick_ == kStepsPerTick) {
      steps_to_tick_ = 0;
      axis->tick(now);
    }
  }
}

void AxisBench::turn_shaft(std::int64_t microsteps) {
  if (!index_mark) {
    sensing_.encoder_count += microsteps;
    return;
  }
  const std::int64_t way = microsteps < 0 ? -1 : 1;
  for (; microsteps != 0; microsteps -= way) {
    sensing_.encoder_count += way;
    sensing_.encoder_index = (sensing_.encoder_count - *index_mark) % kCountsPerRevolution == 0;
    if (sensing_.encoder_index) {
      ++sensing_.encoder_index_passages;
      sensing_.encoder_index_count = sensing_.encoder_count;
    }
  }
}

void AxisBench::read_switches() {
  if (!left_switch && !right_switch && !home_switch) {
    return;
  }
  const auto on = [this](const std::optional<Cam>& cam) {
    return cam && shaft() >= cam->from && shaft() <= cam->to;
  };
  sensing_.left_switch = on(left_switch);
  sensing_.right_switch = on(right_switch);
  sensing_.home_switch = on(home_switch);
  axis->conditions().set_switches(
      axis->settings().reference.switches.pressed(switch_levels(sensing_)));
}

void AxisBench::enable(ModeCode mode) {
  request_operation(mode);
}

}  // namespace stator::drive
