// Steps of a CiA 402 master.
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "stator/bench/bench.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/scenario/step_kinds.hpp"

namespace stator::scenario {

namespace {

using namespace base::literals;
using master::Cia402Client;
using master::OperationMode;
using settings::Section;
using settings::WholeRange;
using settings::Word;

constexpr base::SimDuration kResponse = 1_s;
constexpr base::SimDuration kLongMove = 30_s;

/// An axis of a device, and for how long it is waited for.
struct DriveAxis {
  unsigned axis = 0;
  base::SimDuration within = kResponse;
};
constexpr std::array kDriveAxisRows{axis_key<&DriveAxis::axis>(), within_key<&DriveAxis::within>()};
constexpr Section<DriveAxis> kDriveAxisKeys{kDriveAxisRows};
/// The rows of steps that have no keys but those of their axis.
template <typename T>
constexpr std::array kAxisRows{settings::keys<kDriveAxisKeys, &T::drive>()};

/// Calls `act` with a client of the axis.
template <typename T, typename Act>
Outcome run(bench::Bench& bench, const T& step, base::SimDuration response, const Act& act) {
  const auto port = bench.drive(*step.on.device);
  if (!port) {
    return fail(port.error().text);
  }
  Cia402Client client(**port, step.drive.axis);
  client.set_response_timeout(response);
  return outcome_of(act(client));
}

/// A step that calls `act` with a client of its axis and waits for it for the time that the step
/// names.
template <typename T, typename Act>
ReadStep axis_step(const char* what, const T& step, const StepReader& reader, const Act& act) {
  return {fmt::format("{} {}", what, axis_text(reader.name_of(*step.on.device), step.drive.axis)),
          [=](bench::Bench& bench) { return run(bench, step, step.drive.within, act); }};
}

constexpr std::array kModes{
    Word{"profile-position", OperationMode::profile_position},
    Word{"profile-velocity", OperationMode::profile_velocity},
    Word{"profile-torque", OperationMode::profile_torque},
    Word{"homing", OperationMode::homing},
    Word{"interpolated-position", OperationMode::interpolated_position},
    Word{"cyclic-synchronous-position", OperationMode::cyclic_synchronous_position},
    Word{"cyclic-synchronous-velocity", OperationMode::cyclic_synchronous_velocity},
    Word{"cyclic-synchronous-torque", OperationMode::cyclic_synchronous_torque}};

struct Enable {
  Target on{};
  DriveAxis drive{};
  std::optional<OperationMode> mode{};
};
constexpr std::array kEnableRows{
    settings::keys<kDriveAxisKeys, &Enable::drive>(),
    settings::word<&Enable::mode>("mode", kModes, "Mode of operation that is chosen before")};
constexpr Section<Enable> kEnableKeys{kEnableRows};

ReadStep step_of(const Enable& step, const StepReader& reader) {
  ReadStep read = axis_step("enable", step, reader, [mode = step.mode](Cia402Client& client) {
    const auto set = mode ? client.set_mode(*mode) : master::Result<void>();
    return set ? client.enable() : set;
  });
  if (step.mode) {
    read.title += fmt::format(" in mode {}", settings::name_of(kModes, *step.mode));
  }
  return read;
}

struct Disable {
  Target on{};
  DriveAxis drive{};
};
constexpr Section<Disable> kDisableKeys{kAxisRows<Disable>};

ReadStep step_of(const Disable& step, const StepReader& reader) {
  return axis_step("disable", step, reader, [](Cia402Client& client) { return client.disable(); });
}

struct ResetFault {
  Target on{};
  DriveAxis drive{};
};
constexpr Section<ResetFault> kResetFaultKeys{kAxisRows<ResetFault>};

ReadStep step_of(const ResetFault& step, const StepReader& reader) {
  return axis_step("reset the fault of", step, reader,
                   [](Cia402Client& client) { return client.reset_fault(); });
}

constexpr WholeRange kUnsigned32{0, std::numeric_limits<std::uint32_t>::max()};

struct Move {
  Target on{};
  DriveAxis drive{.axis = 0, .within = kLongMove};
  std::optional<std::int32_t> target{};
  master::ProfileMove profile{};
  bool wait = true;
};
constexpr std::array kMoveRows{
    settings::keys<kDriveAxisKeys, &Move::drive>(),
    settings::needed(settings::whole<&Move::target>("target",
                                                    {std::numeric_limits<std::int32_t>::min(),
                                                     std::numeric_limits<std::int32_t>::max()},
                                                    "Target position in the drive's units"),
                     "it is the position to go to, in the drive's units"),
    settings::boolean<&Move::profile, &master::ProfileMove::relative>(
        "relative", "The target is counted from the one before"),
    settings::whole<&Move::profile, &master::ProfileMove::velocity>(
        "velocity", kUnsigned32, "Profile velocity 6081h in the drive's units"),
    settings::whole<&Move::profile, &master::ProfileMove::acceleration>(
        "acceleration", kUnsigned32, "Profile acceleration 6083h in the drive's units"),
    settings::whole<&Move::profile, &master::ProfileMove::deceleration>(
        "deceleration", kUnsigned32,
        "Profile deceleration 6084h; without it what `acceleration` says"),
    settings::boolean<&Move::wait>(
        "wait", "The step ends when the target is reached, else when the drive has it")};
constexpr Section<Move> kMoveKeys{kMoveRows};

ReadStep step_of(const Move& step, const StepReader& reader) {
  master::ProfileMove move = step.profile;
  move.target = *step.target;
  move.deceleration = move.deceleration ? move.deceleration : move.acceleration;
  std::string title =
      fmt::format("move {} {} {}{}", axis_text(reader.name_of(*step.on.device), step.drive.axis),
                  move.relative ? "by" : "to", move.target, step.wait ? "" : ", without waiting");
  return {std::move(title), [=](bench::Bench& bench) {
            return run(bench, step, kResponse, [&](Cia402Client& client) -> master::Result<void> {
              if (auto set = client.set_mode(OperationMode::profile_position); !set) {
                return set;
              }
              if (auto enabled = client.enable(); !enabled) {
                return enabled;
              }
              if (auto started = client.start_move(move); !started) {
                return started;
              }
              return step.wait ? client.wait_for_target(step.drive.within) : master::Result<void>();
            });
          }};
}

}  // namespace

constinit const StepKind kEnable = step_kind<Enable, &StepReader::device, &kEnableKeys>(
    "enable", "An axis is taken to Operation enabled");
constinit const StepKind kDisable = step_kind<Disable, &StepReader::device, &kDisableKeys>(
    "disable", "An axis is taken to Switch on disabled");
constinit const StepKind kResetFault = step_kind<ResetFault, &StepReader::device, &kResetFaultKeys>(
    "reset-fault", "The fault of an axis is acknowledged");
constinit const StepKind kMove = step_kind<Move, &StepReader::device, &kMoveKeys>(
    "move", "An axis moves in profile position mode");

}  // namespace stator::scenario
