#include "stator/manual/tmcl_axis.hpp"

#include <cstdlib>
#include <string>
#include <utility>

#include "stator/tmcl/command.hpp"

namespace stator::manual {

using master::ErrorCode;
using master::Result;

namespace {

// Axis parameters (TMCL reference of Trinamic's modules, "axis parameters").
constexpr std::uint8_t kTargetPosition = 0;
constexpr std::uint8_t kActualPosition = 1;
constexpr std::uint8_t kTargetSpeed = 2;
constexpr std::uint8_t kActualSpeed = 3;
constexpr std::uint8_t kMaximumPositioningSpeed = 4;
constexpr std::uint8_t kPositionReached = 8;
constexpr std::uint8_t kRampMode = 128;

/// Of kRampMode: the motor turns with its target speed, wherever its target position is.
constexpr std::int32_t kVelocityMode = 2;

// Types of MVP and RFS.
constexpr std::uint8_t kAbsolute = 0;
constexpr std::uint8_t kRelative = 1;
constexpr std::uint8_t kStartSearch = 0;
constexpr std::uint8_t kStopSearch = 1;
constexpr std::uint8_t kSearchStatus = 2;

/// What get_application_status answers while a program runs.
constexpr std::int32_t kProgramRuns = 1;

constexpr std::uint8_t number_of(tmcl::Command command) {
  return static_cast<std::uint8_t>(command);
}

Result<void> done(const Result<std::int32_t>& result) {
  return result ? Result<void>() : base::Unexpected{result.error()};
}

}  // namespace

TmclAxis::TmclAxis(Ask ask, const AxisPlace& place, Owe owe)
    : ask_(std::move(ask)), owe_(std::move(owe)), motor_(static_cast<std::uint8_t>(place.number)) {
  description_.units = place.units;
  description_.commands = {CommandKind::jog, CommandKind::move, CommandKind::home,
                           CommandKind::stop};
  const auto status = ask_({.command = number_of(tmcl::Command::get_application_status)});
  program_ran_ = status && status->value == kProgramRuns;
  if (program_ran_) {
    static_cast<void>(ask_({.command = number_of(tmcl::Command::stop_application)}));
    note_motion();
  }
  if (const auto speed = parameter(kMaximumPositioningSpeed)) {
    description_.velocity = *speed;
  }
}

Result<std::int32_t> TmclAxis::command(tmcl::Instruction instruction) {
  instruction.motor = motor_;
  const auto reply = ask_(instruction);
  if (!reply) {
    return base::Unexpected{reply.error()};
  }
  if (reply->status != tmcl::Status::success) {
    return master::fail(ErrorCode::protocol,
                        std::string(tmcl::name_of(instruction.command).view()) +
                            " was answered with \"" +
                            std::string(tmcl::status_text(reply->status)) + '"');
  }
  return reply->value;
}

Result<std::int32_t> TmclAxis::parameter(std::uint8_t number) {
  return command({.command = number_of(tmcl::Command::get_axis_parameter), .type = number});
}

Result<AxisStatus> TmclAxis::look() {
  const auto position = parameter(kActualPosition);
  const auto speed = position ? parameter(kActualSpeed) : position;
  const auto reached = speed ? parameter(kPositionReached) : speed;
  if (!reached) {
    return base::Unexpected{reached.error()};
  }
  if (*reached != 0) {
    if (const auto given_back = give_back_speed(); !given_back) {
      return base::Unexpected{given_back.error()};
    }
  }
  const auto search =
      command({.command = number_of(tmcl::Command::reference_search), .type = kSearchStatus});
  const bool searches = search && *search != 0;
  return AxisStatus{.state = searches      ? "reference search"
                             : *speed != 0 ? "turning"
                                           : "at rest",
                    .enabled = true,
                    .reached = *reached != 0,
                    .position = static_cast<double>(*position),
                    .velocity = static_cast<double>(*speed)};
}

Result<void> TmclAxis::set_speed(std::int32_t speed) {
  if (!own_speed_) {
    const auto own = parameter(kMaximumPositioningSpeed);
    if (!own) {
      return base::Unexpected{own.error()};
    }
    own_speed_ = *own;
    owe_(tmcl::Instruction{.command = number_of(tmcl::Command::set_axis_parameter),
                           .type = kMaximumPositioningSpeed,
                           .motor = motor_,
                           .value = *own});
  }
  return done(command({.command = number_of(tmcl::Command::set_axis_parameter),
                       .type = kMaximumPositioningSpeed,
                       .value = speed}));
}

Result<void> TmclAxis::give_back_speed() {
  if (!own_speed_) {
    return {};
  }
  auto set = set_speed(*own_speed_);
  if (set) {
    own_speed_.reset();
    owe_(std::nullopt);
  }
  return set;
}

Result<void> TmclAxis::jog(std::int64_t velocity) {
  if (!is_integer32(velocity) || !is_integer32(-velocity)) {
    return master::fail(ErrorCode::argument,
                        "velocity " + std::to_string(velocity) + " is no 32-bit number");
  }
  return done(command({.command = number_of(velocity < 0 ? tmcl::Command::rotate_left
                                                         : tmcl::Command::rotate_right),
                       .value = static_cast<std::int32_t>(std::llabs(velocity))}));
}

Result<void> TmclAxis::move(const Command& given) {
  if (!is_integer32(given.value)) {
    return master::fail(ErrorCode::argument,
                        "position " + std::to_string(given.value) + " is no 32-bit number");
  }
  if (auto set = given.velocity ? set_speed(static_cast<std::int32_t>(*given.velocity))
                                : give_back_speed();
      !set) {
    return set;
  }
  return done(command({.command = number_of(tmcl::Command::move_to_position),
                       .type = given.relative ? kRelative : kAbsolute,
                       .value = static_cast<std::int32_t>(given.value)}));
}

Result<void> TmclAxis::execute(const Command& given) {
  switch (given.kind) {
    case CommandKind::jog:
    case CommandKind::home:
      if (auto given_back = give_back_speed(); !given_back) {
        return given_back;
      }
      return given.kind == CommandKind::jog
                 ? jog(given.value)
                 : done(command({.command = number_of(tmcl::Command::reference_search),
                                 .type = kStartSearch}));
    case CommandKind::move:
      return move(given);
    case CommandKind::stop:
      return stop();
    case CommandKind::enable:
    case CommandKind::disable:
    case CommandKind::reset_fault:
    case CommandKind::quick_stop:
    case CommandKind::mode:
    case CommandKind::controlword:
      break;
  }
  return master::fail(ErrorCode::argument, "a module with TMCL has no \"" +
                                               std::string(name_of(given.kind)) +
                                               "\"; it takes jog, move, home and stop");
}

// A search that is under way would move the motor again.
Result<void> TmclAxis::stop() {
  for (const auto& halt : {tmcl::Instruction{.command = number_of(tmcl::Command::reference_search),
                          .type = kStopSearch},
                           tmcl::Instruction{.command = number_of(tmcl::Command::motor_stop)}}) {
    if (const auto sent = command(halt); !sent) {
      return base::Unexpected{sent.error()};
    }
  }
  return give_back_speed();
}

void TmclAxis::note_motion() {
  const auto mode = parameter(kRampMode);
  if (mode && *mode != kVelocityMode) {
    if (const auto target = parameter(kTargetPosition)) {
      program_target_ = *target;
    }
  } else if (const auto velocity = parameter(kTargetSpeed)) {
    program_velocity_ = *velocity;
  }
}

// A program that waits for the end of its move (WAIT POS) would wait for ever.
void TmclAxis::resume_motion() {
  if (program_target_) {
    static_cast<void>(command({.command = number_of(tmcl::Command::move_to_position),
                               .type = kAbsolute,
                               .value = *program_target_}));
  } else if (program_velocity_ != 0) {
    static_cast<void>(jog(program_velocity_));
  }
}

Result<void> TmclAxis::leave() {
  auto stopped = stop();
  if (program_ran_) {
    resume_motion();
    static_cast<void>(ask_({.command = number_of(tmcl::Command::run_application)}));
  }
  return stopped;
}

}  // namespace stator::manual
