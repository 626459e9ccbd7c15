#include "stator/manual/cia402_axis.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

namespace stator::manual {

using master::DriveState;
using master::ErrorCode;
using master::OperationMode;
using master::Result;

namespace {

// Objects of CiA 402-2, of axis 0.
constexpr std::uint16_t kErrorCode = 0x603F;
constexpr std::uint16_t kModesOfOperationDisplay = 0x6061;
constexpr std::uint16_t kProfileVelocity = 0x6081;
constexpr std::uint16_t kProfileAcceleration = 0x6083;
constexpr std::uint16_t kProfileDeceleration = 0x6084;
constexpr std::uint16_t kHomingMethod = 0x6098;
constexpr std::uint16_t kHomingSpeeds = 0x6099;
constexpr std::uint16_t kHomingAcceleration = 0x609A;
constexpr std::uint16_t kSupportedDriveModes = 0x6502;
constexpr std::uint16_t kTargetReached = 1U << 10;

/// Bit n - 1 of 6502h is mode n; the upper half is the manufacturer's.
constexpr int kStandardModes = 16;

/// Of a profile that the drive has no acceleration for.
constexpr double kRevolutionsPerSecondSquared = 4.0;
/// Of a homing run that the drive has no speeds for: on the search for the switch, and away from
/// it.
constexpr std::array<double, 2> kHomingRevolutionsPerSecond{1.0, 0.25};

Result<void> out_of_range(const char* what, std::int64_t value) {
  return master::fail(ErrorCode::argument, std::string(what) + " " + std::to_string(value) +
                                               " is no 32-bit number with sign, which is what the "
                                               "drive's object holds");
}

}  // namespace

Cia402Axis::Cia402Axis(std::unique_ptr<master::DrivePort> port, const AxisPlace& place)
    : port_(std::move(port)), client_(*port_, place.number) {
  using enum CommandKind;
  description_.commands = {enable, disable, reset_fault, jog,  move,
                           home,   stop,    quick_stop,  mode, controlword};
  if (const auto modes = client_.read<std::uint32_t>(kSupportedDriveModes)) {
    for (int each = 1; each <= kStandardModes; ++each) {
      if ((*modes >> (each - 1) & 1U) != 0) {
        description_.modes.push_back(each);
      }
    }
  }
  description_.units = place.units;
  if (const auto velocity = client_.read<std::uint32_t>(kProfileVelocity)) {
    description_.velocity = *velocity;
  }
  if (description_.velocity == 0.0 && place.units) {
    description_.velocity = place.units->velocity;  // one revolution per second
  }
}

// A drive that does not tell its modes is taken at its word when it is asked for one.
bool Cia402Axis::has(OperationMode mode) const {
  return description_.modes.empty() ||
         std::ranges::find(description_.modes, static_cast<int>(mode)) != description_.modes.end();
}

Result<AxisStatus> Cia402Axis::look() {
  const auto word = client_.statusword();
  if (!word) {
    return base::Unexpected{word.error()};
  }
  const auto position = client_.position_actual();
  if (!position) {
    return base::Unexpected{position.error()};
  }
  const auto state = master::drive_state(*word);
  AxisStatus status{.state = std::string(state ? master::to_text(*state) : "no state of CiA 402"),
                    .enabled = state == DriveState::operation_enabled,
                    .fault = state == DriveState::fault,
                    .reached = (*word & kTargetReached) != 0,
                    .position = static_cast<double>(*position),
                    .statusword = *word,
                    .controlword = client_.controlword()};
  if (const auto velocity = client_.velocity_actual()) {
    status.velocity = *velocity;
  }
  if (const auto mode = client_.read<std::int8_t>(kModesOfOperationDisplay)) {
    status.mode = *mode;
  }
  if (status.fault) {
    if (const auto code = client_.read<std::uint16_t>(kErrorCode)) {
      status.error_code = *code;
    }
  }
  return status;
}

Result<void> Cia402Axis::choose(OperationMode mode) {
  const auto shown = client_.read<std::int8_t>(kModesOfOperationDisplay);
  if (shown && *shown == static_cast<std::int8_t>(mode)) {
    return {};
  }
  return client_.set_mode(mode);
}

Result<void> Cia402Axis::complete_profile() {
  if (!description_.units) {
    return {};
  }
  for (const std::uint16_t object : {kProfileAcceleration, kProfileDeceleration}) {
    if (auto written =
            complete(object, 0, kRevolutionsPerSecondSquared * description_.units->velocity);
        !written) {
      return written;
    }
  }
  return {};
}

Result<void> Cia402Axis::home() {
  const auto method = client_.read<std::int8_t>(kHomingMethod);
  if (method && *method == 0) {
    return master::fail(ErrorCode::argument,
                        "its homing method (6098h) is 0, which finds no home; write another one "
                        "first, e.g. 35, which takes the present position for home");
  }
  if (auto completed = complete_homing(); !completed) {
    return completed;
  }
  if (auto chosen = choose(OperationMode::homing); !chosen) {
    return chosen;
  }
  return client_.start_homing();
}

Result<void> Cia402Axis::complete(std::uint16_t index, std::uint8_t subindex, double value) {
  const auto present = client_.read<std::uint32_t>(index, subindex);
  if (!present || *present != 0) {
    return {};  // what a drive has not got, it does not need
  }
  return client_.write<std::uint32_t>(index, subindex, static_cast<std::uint32_t>(value));
}

Result<void> Cia402Axis::complete_homing() {
  if (!description_.units) {
    return {};
  }
  const double revolution = description_.units->velocity;
  for (std::size_t i = 0; i < kHomingRevolutionsPerSecond.size(); ++i) {
    if (auto written = complete(kHomingSpeeds, static_cast<std::uint8_t>(i + 1),
                                kHomingRevolutionsPerSecond[i] * revolution);
        !written) {
      return written;
    }
  }
  return complete(kHomingAcceleration, 0, kRevolutionsPerSecondSquared * revolution);
}

Result<void> Cia402Axis::jog(std::int64_t velocity) {
  if (!is_integer32(velocity)) {
    return out_of_range("velocity", velocity);
  }
  const OperationMode mode = has(OperationMode::profile_velocity)
                                 ? OperationMode::profile_velocity
                                 : OperationMode::cyclic_synchronous_velocity;
  if (!has(mode)) {
    return master::fail(ErrorCode::argument,
                        "the drive has no mode in which it turns at a velocity (6502h); move it to "
                        "positions instead");
  }
  if (auto completed = complete_profile(); !completed) {
    return completed;
  }
  if (auto chosen = choose(mode); !chosen) {
    return chosen;
  }
  return client_.run_at(static_cast<std::int32_t>(velocity));
}

Result<void> Cia402Axis::move(const Command& command) {
  std::int64_t target = command.value;
  if (command.relative) {
    const auto position = client_.position_actual();
    if (!position) {
      return base::Unexpected{position.error()};
    }
    target += *position;
  }
  if (!is_integer32(target)) {
    return out_of_range("position", target);
  }
  if (auto completed = complete_profile(); !completed) {
    return completed;
  }
  if (auto chosen = choose(OperationMode::profile_position); !chosen) {
    return chosen;
  }
  return client_.start_move(
      {.target = static_cast<std::int32_t>(target),
       .velocity = command.velocity.value_or(static_cast<std::uint32_t>(description_.velocity))});
}

Result<void> Cia402Axis::stop() {
  const auto state = client_.state();
  if (!state) {
    return base::Unexpected{state.error()};
  }
  if (*state != DriveState::operation_enabled) {
    return {};  // nothing drives it, and Halt would be no command in this state
  }
  const auto mode = client_.read<std::int8_t>(kModesOfOperationDisplay);
  const bool at_velocity =
      mode && (*mode == static_cast<std::int8_t>(OperationMode::profile_velocity) ||
               *mode == static_cast<std::int8_t>(OperationMode::cyclic_synchronous_velocity));
  return at_velocity ? client_.run_at(0) : client_.halt();
}

Result<void> Cia402Axis::execute(const Command& command) {
  switch (command.kind) {
    case CommandKind::enable:
      return client_.enable();
    case CommandKind::disable:
      return client_.disable();
    case CommandKind::reset_fault:
      return client_.reset_fault();
    case CommandKind::jog:
      return jog(command.value);
    case CommandKind::move:
      return move(command);
    case CommandKind::home:
      return home();
    case CommandKind::stop:
      return stop();
    case CommandKind::quick_stop:
      return client_.quick_stop();
    case CommandKind::mode:
      if (command.value < std::numeric_limits<std::int8_t>::min() ||
          command.value > std::numeric_limits<std::int8_t>::max()) {
        return master::fail(ErrorCode::argument,
                            "a mode of operation is a number from -128 to 127");
      }
      return client_.set_mode(static_cast<OperationMode>(command.value));
    case CommandKind::controlword:
      if (command.value < 0 || command.value > std::numeric_limits<std::uint16_t>::max()) {
        return master::fail(ErrorCode::argument, "a controlword is a number from 0 to FFFFh");
      }
      return client_.write_controlword(static_cast<std::uint16_t>(command.value));
  }
  return {};
}

Result<void> Cia402Axis::leave() {
  const auto state = client_.state();
  if (!state) {
    return base::Unexpected{state.error()};
  }
  return *state == DriveState::fault || *state == DriveState::switch_on_disabled
             ? Result<void>()
             : client_.disable();
}

}  // namespace stator::manual
