#include "stator/master/cia402/cia402_client.hpp"

#include <algorithm>
#include <cmath>

#include "stator/master/cia402/slave_drive_port.hpp"
#include "stator/master/text.hpp"

namespace stator::master {

namespace {

constexpr std::uint16_t kAxisDistance = 0x800;

// Objects of CiA 402-2, of axis 0.
constexpr std::uint16_t kErrorCode = 0x603F;
constexpr std::uint16_t kControlword = 0x6040;
constexpr std::uint16_t kStatusword = 0x6041;
constexpr std::uint16_t kModesOfOperation = 0x6060;
constexpr std::uint16_t kModesOfOperationDisplay = 0x6061;
constexpr std::uint16_t kPositionActualValue = 0x6064;
constexpr std::uint16_t kVelocityActualValue = 0x606C;
constexpr std::uint16_t kTargetPosition = 0x607A;
constexpr std::uint16_t kProfileVelocity = 0x6081;
constexpr std::uint16_t kProfileAcceleration = 0x6083;
constexpr std::uint16_t kProfileDeceleration = 0x6084;
constexpr std::uint16_t kTargetVelocity = 0x60FF;

// Controlword (CiA 402-2 table 27): commands of the power state machine, then bits.
constexpr std::uint16_t kDisableVoltage = 0x0000;
constexpr std::uint16_t kQuickStop = 0x0002;
constexpr std::uint16_t kShutdown = 0x0006;
constexpr std::uint16_t kSwitchOn = 0x0007;
constexpr std::uint16_t kEnableOperation = 0x000F;
constexpr std::uint16_t kNewSetPoint = 1U << 4;
constexpr std::uint16_t kChangeImmediately = 1U << 5;
constexpr std::uint16_t kRelative = 1U << 6;
constexpr std::uint16_t kHomingOperationStart = 1U << 4;
constexpr std::uint16_t kFaultReset = 1U << 7;
constexpr std::uint16_t kHalt = 1U << 8;

// Statusword.
constexpr std::uint16_t kTargetReached = 1U << 10;
constexpr std::uint16_t kSetPointAcknowledge = 1U << 12;

/// The controlword that brings a drive nearer to Operation enabled; nothing where the drive leaves
/// the state by itself or only a fault reset helps.
std::optional<std::uint16_t> next_command(DriveState state) {
  switch (state) {
    case DriveState::switch_on_disabled:
      return kShutdown;
    case DriveState::ready_to_switch_on:
      return kSwitchOn;
    case DriveState::switched_on:
    case DriveState::operation_enabled:
      return kEnableOperation;
    case DriveState::quick_stop_active:
      return kDisableVoltage;
    case DriveState::not_ready_to_switch_on:
    case DriveState::fault_reaction_active:
    case DriveState::fault:
      return std::nullopt;
  }
  return std::nullopt;
}

/// A way with constant acceleration, velocity and deceleration, from standstill to standstill.
class Trapezoid {
 public:
  Trapezoid(double distance, double velocity, double acceleration, double deceleration)
      : distance_(distance), acceleration_(acceleration), deceleration_(deceleration) {
    const double highest = std::sqrt(2.0 * std::abs(distance) * acceleration * deceleration /
                                     (acceleration + deceleration));
    velocity_ = std::min(velocity, highest);
    ramps_ = velocity_ / acceleration + velocity_ / deceleration;
    cruise_ = velocity_ > 0.0 ? std::abs(distance) / velocity_ - ramps_ / 2.0 : 0.0;
  }

  [[nodiscard]] double duration() const { return ramps_ + cruise_; }
  /// How far it is after so many seconds, with the sign of the distance.
  [[nodiscard]] double at(double seconds) const {
    const double left = duration() - seconds;
    const double speeding = velocity_ / acceleration_;
    double way = std::abs(distance_);
    if (seconds < speeding) {
      way = acceleration_ * seconds * seconds / 2.0;
    } else if (seconds < speeding + cruise_) {
      way = velocity_ * (seconds - speeding / 2.0);
    } else if (left > 0.0) {
      way -= deceleration_ * left * left / 2.0;
    }
    return std::copysign(way, distance_);
  }

 private:
  double distance_;
  double acceleration_;
  double deceleration_;
  double velocity_ = 0.0;
  double ramps_ = 0.0;   // seconds of both
  double cruise_ = 0.0;  // seconds between them
};

}  // namespace

Cia402Client::Cia402Client(DrivePort& port, unsigned axis) : port_(port), axis_(axis) {}

Cia402Client::Cia402Client(Master& master, std::size_t position, unsigned axis)
    : own_port_(std::make_unique<SlaveDrivePort>(master, position)),
      port_(*own_port_),
      axis_(axis) {}

std::uint16_t Cia402Client::axis_index(std::uint16_t index) const {
  return static_cast<std::uint16_t>(index + axis_ * kAxisDistance);
}

std::string Cia402Client::name() const {
  return "axis " + std::to_string(axis_) + " of " + port_.name();
}

Result<void> Cia402Client::write_controlword(std::uint16_t controlword) {
  controlword_ = controlword;
  return write<std::uint16_t>(kControlword, 0, controlword);
}

Result<std::uint16_t> Cia402Client::statusword() {
  return read<std::uint16_t>(kStatusword);
}

Result<std::int32_t> Cia402Client::position_actual() {
  return read<std::int32_t>(kPositionActualValue);
}

Result<std::int32_t> Cia402Client::velocity_actual() {
  return read<std::int32_t>(kVelocityActualValue);
}

Result<DriveState> Cia402Client::state() {
  const auto word = statusword();
  if (!word) {
    return base::Unexpected{word.error()};
  }
  const auto shown = drive_state(*word);
  if (!shown) {
    return fail(ErrorCode::protocol, name() + " shows statusword " + hexadecimal(*word, 4) +
                                         ", which is no state of CiA 402");
  }
  return *shown;
}

Error Cia402Client::fault_error() {
  const auto code = read<std::uint16_t>(kErrorCode);
  const std::string shown = code ? hexadecimal(*code, 4) : "unknown";
  return {ErrorCode::drive_fault, code ? *code : 0U,
          name() + " is in Fault, error code 603Fh = " + shown +
              "; remove the cause and reset the fault"};
}

Result<void> Cia402Client::wait_for_state(DriveState wanted, bool fault_is_failure) {
  const base::SimTime deadline = port_.now() + response_timeout_;
  while (true) {
    if (auto waited = port_.run_cycle(); !waited) {
      return waited;
    }
    const auto now = state();
    if (!now) {
      return base::Unexpected{now.error()};
    }
    if (*now == wanted) {
      return {};
    }
    if (*now == DriveState::fault && fault_is_failure) {
      return base::Unexpected{fault_error()};
    }
    if (port_.now() >= deadline) {
      return timeout(std::string(to_text(wanted)) + ", it is in " + std::string(to_text(*now)),
                     response_timeout_);
    }
  }
}

Result<void> Cia402Client::wait_for_statusword(std::uint16_t mask, std::uint16_t value,
                                               base::SimDuration limit, std::string_view awaited,
                                               const std::function<void()>& each_cycle) {
  const base::SimTime deadline = port_.now() + limit;
  while (true) {
    if (auto waited = port_.run_cycle(); !waited) {
      return waited;
    }
    const auto word = statusword();
    if (!word) {
      return base::Unexpected{word.error()};
    }
    if (drive_state(*word) == DriveState::fault) {
      return base::Unexpected{fault_error()};
    }
    if ((*word & mask) == value) {
      return {};
    }
    if (port_.now() >= deadline) {
      return timeout(std::string(awaited) + ", statusword " + hexadecimal(*word, 4), limit);
    }
    if (each_cycle) {
      each_cycle();
    }
  }
}

Result<void> Cia402Client::timeout(const std::string& awaited, base::SimDuration limit) const {
  return fail(ErrorCode::drive_timeout, name() + " did not show " + awaited + " within " +
                                            std::to_string(limit.nanoseconds() / 1'000'000) +
                                            " ms; controlword was " + hexadecimal(controlword_, 4));
}

Result<void> Cia402Client::reset_fault() {
  const auto now = state();
  if (!now) {
    return base::Unexpected{now.error()};
  }
  if (*now != DriveState::fault && *now != DriveState::fault_reaction_active) {
    return {};
  }
  if (*now == DriveState::fault_reaction_active) {
    if (auto ended = wait_for_state(DriveState::fault, false); !ended) {
      return ended;
    }
  }
  // The reset is the rising edge of bit 7, so it must be seen low first.
  if (auto written = write_controlword(kDisableVoltage); !written) {
    return written;
  }
  if (auto waited = port_.run_cycle(); !waited) {
    return waited;
  }
  if (auto written = write_controlword(kFaultReset); !written) {
    return written;
  }
  auto reached = wait_for_state(DriveState::switch_on_disabled, false);
  if (!reached && reached.error().code == ErrorCode::drive_timeout) {
    return base::Unexpected{fault_error()};
  }
  if (!reached) {
    return reached;
  }
  return write_controlword(kDisableVoltage);
}

/// With a mapped target position the first cycle of Operation enabled must not ask for position 0.
Result<void> Cia402Client::hold_position() {
  if (!port_.cyclic({axis_index(kTargetPosition), 0})) {
    return {};
  }
  const auto position = position_actual();
  return position ? write<std::int32_t>(kTargetPosition, 0, *position)
                  : base::Unexpected{position.error()};
}

Result<void> Cia402Client::enable() {
  const base::SimTime deadline = port_.now() + response_timeout_;
  if (auto held = hold_position(); !held) {
    return held;
  }
  while (true) {
    const auto now = state();
    if (!now) {
      return base::Unexpected{now.error()};
    }
    if (*now == DriveState::operation_enabled) {
      return {};
    }
    if (*now == DriveState::fault) {
      return base::Unexpected{fault_error()};
    }
    if (port_.now() >= deadline) {
      return timeout("Operation enabled, it is in " + std::string(to_text(*now)),
                     response_timeout_);
    }
    if (const auto command = next_command(*now); command.has_value()) {
      if (auto written = write_controlword(*command); !written) {
        return written;
      }
    }
    if (auto waited = port_.run_cycle(); !waited) {
      return waited;
    }
  }
}

Result<void> Cia402Client::disable() {
  if (auto written = write_controlword(kDisableVoltage); !written) {
    return written;
  }
  return wait_for_state(DriveState::switch_on_disabled, true);
}

Result<void> Cia402Client::quick_stop() {
  return write_controlword(kQuickStop);
}

Result<void> Cia402Client::halt() {
  return write_controlword(kEnableOperation | kHalt);
}

Result<void> Cia402Client::set_mode(OperationMode mode) {
  const auto number = static_cast<std::int8_t>(mode);
  if (auto written = write<std::int8_t>(kModesOfOperation, 0, number); !written) {
    const auto shown = read<std::int8_t>(kModesOfOperationDisplay);
    return shown && *shown == number ? Result<void>() : written;
  }
  const base::SimTime deadline = port_.now() + response_timeout_;
  while (true) {
    if (auto waited = port_.run_cycle(); !waited) {
      return waited;
    }
    const auto shown = read<std::int8_t>(kModesOfOperationDisplay);
    if (!shown) {
      return base::Unexpected{shown.error()};
    }
    if (*shown == number) {
      return {};
    }
    if (port_.now() >= deadline) {
      return timeout(
          "mode of operation " + std::to_string(number) + ", 6061h is " + std::to_string(*shown),
          response_timeout_);
    }
  }
}

Result<void> Cia402Client::write_profile(const ProfileMove& move) {
  struct Parameter {
    std::uint16_t index;
    const std::optional<std::uint32_t>& value;
  };
  for (const Parameter& parameter : {Parameter{kProfileVelocity, move.velocity},
                                     Parameter{kProfileAcceleration, move.acceleration},
                                     Parameter{kProfileDeceleration, move.deceleration}}) {
    if (!parameter.value.has_value()) {
      continue;
    }
    if (auto written = write<std::uint32_t>(parameter.index, 0, *parameter.value); !written) {
      return written;
    }
  }
  return write<std::int32_t>(kTargetPosition, 0, move.target);
}

Result<void> Cia402Client::require_enabled(std::string_view what) {
  const auto now = state();
  if (!now) {
    return base::Unexpected{now.error()};
  }
  if (*now == DriveState::fault) {
    return base::Unexpected{fault_error()};
  }
  if (*now != DriveState::operation_enabled) {
    return fail(ErrorCode::argument, name() + " is in " + std::string(to_text(*now)) + ", " +
                                         std::string(what) +
                                         " needs Operation enabled; enable it first");
  }
  return {};
}

Result<void> Cia402Client::stream_move(const ProfileMove& move,
                                       const std::function<void()>& each_cycle) {
  if (auto ready = require_enabled("moving"); !ready) {
    return ready;
  }
  const double velocity = move.velocity.value_or(0);
  const double acceleration = move.acceleration.value_or(0);
  const double deceleration = move.deceleration.value_or(move.acceleration.value_or(0));
  if (velocity <= 0.0 || acceleration <= 0.0 || deceleration <= 0.0) {
    return fail(ErrorCode::argument,
                name() + ": a streamed move needs velocity and acceleration; give both");
  }
  const auto start = position_actual();
  if (!start) {
    return base::Unexpected{start.error()};
  }
  const double from = *start;
  const double distance = move.relative ? move.target : move.target - from;
  const Trapezoid way(distance, velocity, acceleration, deceleration);
  const base::SimTime begin = port_.now();
  while (true) {
    const double seconds = (port_.now() - begin).seconds();
    const auto target = static_cast<std::int32_t>(std::llround(from + way.at(seconds)));
    if (auto written = write<std::int32_t>(kTargetPosition, 0, target); !written) {
      return written;
    }
    if (auto exchanged = port_.run_cycle(); !exchanged) {
      return exchanged;
    }
    // Also what the drive falls into behind the first target.
    if (auto ready = require_enabled("moving"); !ready || seconds >= way.duration()) {
      return ready;
    }
    if (each_cycle) {
      each_cycle();
    }
  }
}

Result<void> Cia402Client::run_at(std::int32_t velocity) {
  if (auto ready = require_enabled("turning"); !ready) {
    return ready;
  }
  if (auto written = write<std::int32_t>(kTargetVelocity, 0, velocity); !written) {
    return written;
  }
  return write_controlword(kEnableOperation);
}

Result<void> Cia402Client::start_homing() {
  if (auto ready = require_enabled("homing"); !ready) {
    return ready;
  }
  // It begins with the rising edge of bit 4, so that must be seen low first.
  if (auto written = write_controlword(kEnableOperation); !written) {
    return written;
  }
  if (auto waited = port_.run_cycle(); !waited) {
    return waited;
  }
  return write_controlword(kEnableOperation | kHomingOperationStart);
}

Result<void> Cia402Client::start_move(const ProfileMove& move) {
  if (auto ready = require_enabled("a move"); !ready) {
    return ready;
  }
  // The drive takes a set-point at the rising edge of bit 4, and only when it has released the
  // acknowledge of the one before.
  const auto idle =
      static_cast<std::uint16_t>(kEnableOperation | (move.immediately ? kChangeImmediately : 0U) |
                                 (move.relative ? kRelative : 0U));
  if (auto written = write_profile(move); !written) {
    return written;
  }
  if (auto written = write_controlword(idle); !written) {
    return written;
  }
  if (auto released = wait_for_statusword(kSetPointAcknowledge, 0, response_timeout_,
                                          "set-point acknowledge = 0 (bit 12)");
      !released) {
    return released;
  }
  if (auto written = write_controlword(static_cast<std::uint16_t>(idle | kNewSetPoint)); !written) {
    return written;
  }
  if (auto taken = wait_for_statusword(kSetPointAcknowledge, kSetPointAcknowledge,
                                       response_timeout_, "set-point acknowledge (bit 12)");
      !taken) {
    return taken;
  }
  if (auto written = write_controlword(idle); !written) {
    return written;
  }
  return wait_for_statusword(kSetPointAcknowledge, 0, response_timeout_,
                             "set-point acknowledge = 0 (bit 12)");
}

Result<bool> Cia402Client::target_reached() {
  const auto word = statusword();
  if (!word) {
    return base::Unexpected{word.error()};
  }
  if (drive_state(*word) == DriveState::fault) {
    return base::Unexpected{fault_error()};
  }
  return (*word & kTargetReached) != 0;
}

Result<void> Cia402Client::wait_for_target(base::SimDuration limit,
                                           const std::function<void()>& each_cycle) {
  return wait_for_statusword(kTargetReached, kTargetReached, limit, "target reached (bit 10)",
                             each_cycle);
}

}  // namespace stator::master
