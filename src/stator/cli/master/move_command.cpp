// stator move: moves one axis of a CiA 402 drive on an EtherCAT segment, in profile position mode
// or where the drive has none in cyclic synchronous position mode.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/master/cycle_report.hpp"
#include "stator/cli/master/master_session.hpp"
#include "stator/cli/progress.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/settings/words.hpp"

namespace stator::cli {

namespace {

struct MoveOptions {
  BusOptions bus;
  std::size_t position = 0;
  unsigned axis = 0;
  std::optional<double> revolutions;
  std::optional<std::int64_t> by;
  std::optional<std::int64_t> to;
  std::uint32_t units_per_revolution = 51'200;
  std::uint32_t velocity = 256'000;
  std::uint32_t acceleration = 512'000;
  std::optional<std::uint32_t> deceleration;
  std::string settle = "200ms";
};

/// Lets the process data run on for `duration`.
void keep_running(master::Master& master, base::SimDuration duration) {
  const base::SimTime end = master.port().now() + duration;
  while (master.port().now() < end) {
    require(master.run_cycle());
  }
}

/// The absolute target in drive units; Failure when it leaves the range of 607Ah.
std::int32_t target_of(const MoveOptions& options, std::int32_t start) {
  std::int64_t target = options.to.value_or(0);
  if (options.by) {
    target = start + *options.by;
  } else if (options.revolutions) {
    target = start + std::llround(*options.revolutions * options.units_per_revolution);
  }
  if (target < std::numeric_limits<std::int32_t>::min() ||
      target > std::numeric_limits<std::int32_t>::max()) {
    throw Failure(
        fmt::format("the target {} lies outside INTEGER32, the type of target position "
                    "607Ah; choose a shorter move",
                    target));
  }
  return static_cast<std::int32_t>(target);
}

/// The time of the trapezoid in seconds.
double time_of(const MoveOptions& options, double distance) {
  const double acceleration =
      std::min(options.acceleration, options.deceleration.value_or(options.acceleration));
  return distance / options.velocity + options.velocity / acceleration;
}

/// Selects profile position, or cyclic synchronous position where the drive has no profile: by
/// 6502h, by the objects that a profile needs, or because nobody can write its mode.
master::OperationMode select_mode(master::Cia402Client& axis) {
  constexpr std::uint32_t kProfilePosition = 1U << 0;
  constexpr std::uint32_t kCyclicSynchronousPosition = 1U << 7;
  const auto supported = axis.read<std::uint32_t>(0x6502);
  const std::uint32_t modes = supported && *supported != 0 ? *supported : ~0U;
  const bool streams = (modes & kCyclicSynchronousPosition) != 0;
  const bool profiles = (modes & kProfilePosition) != 0 && axis.read<std::uint32_t>(0x6081);
  master::Result<void> selected;
  if (profiles || !streams) {
    selected = axis.set_mode(master::OperationMode::profile_position);
    if (selected || !streams) {
      require(selected);
      return master::OperationMode::profile_position;
    }
  }
  auto streamed = axis.set_mode(master::OperationMode::cyclic_synchronous_position);
  if (!streamed) {
    require(selected);  // what was wanted first tells more
    require(streamed);
  }
  return master::OperationMode::cyclic_synchronous_position;
}

/// Moves and waits, saying how far it is, for twice the time that it should take plus a second.
void move_to_target(master::Master& master, master::Cia402Client& axis, master::OperationMode mode,
                    const master::ProfileMove& move, double seconds) {
  const base::SimTime begin = master.port().now();
  Progress progress("moving");
  const auto told = [&] {
    progress.reached(std::min((master.port().now() - begin).seconds() / seconds, 1.0));
  };
  if (mode == master::OperationMode::cyclic_synchronous_position) {
    require(axis.stream_move(move, told));
    return;
  }
  require(axis.start_move(move));
  require(axis.wait_for_target(
      base::SimDuration(static_cast<std::int64_t>((2.0 * seconds + 1.0) * 1e9)), told));
}

void move(const MoveOptions& options) {
  const auto settle = settings::parse_duration(options.settle);
  if (!settle || *settle < base::SimDuration(0)) {
    throw Failure(
        fmt::format("--settle \"{}\" is no duration; write e.g. 200ms or 0s", options.settle));
  }
  MasterSession session(options.bus);
  master::Master& master = session.master();
  require(master.configure_process_data());
  require(master.go_operational());

  master::Cia402Client axis(master, options.position, options.axis);
  if (require(axis.state()) == master::DriveState::fault) {
    require(axis.reset_fault());
  }
  const master::OperationMode mode = select_mode(axis);
  require(axis.enable());
  const std::int32_t start = require(axis.position_actual());
  const std::int32_t target = target_of(options, start);
  fmt::print("slave {} axis {}: {} -> {} at {} /s, {} /s²\n", options.position, options.axis, start,
             target, options.velocity, options.acceleration);

  const base::SimTime begin = master.port().now();
  move_to_target(
      master, axis, mode,
      {.target = target,
       .velocity = options.velocity,
       .acceleration = options.acceleration,
       .deceleration = options.deceleration.value_or(options.acceleration)},
      time_of(options, std::abs(static_cast<double>(target) - static_cast<double>(start))));
  const double seconds = (master.port().now() - begin).seconds();
  keep_running(master, *settle);
  const std::int32_t reached = require(axis.position_actual());
  fmt::print("target reached after {:.3f} s at {}, {} from the target\n", seconds, reached,
             std::abs(std::int64_t{reached} - target));

  fmt::print("{}\n", cycles_text(master.cycle_statistics()));
  require(axis.disable());
  require(master.stop());
  session.end();
}

}  // namespace

void add_move_command(CLI::App& app) {
  auto options = std::make_shared<MoveOptions>();
  CLI::App* command =
      app.add_subcommand("move", "Move one axis of a CiA 402 drive in profile position mode");
  add_bus_options(*command, options->bus);
  command->add_option("-p,--position", options->position, "Slave on the segment, 0 = first")
      ->capture_default_str();
  command->add_option("-a,--axis", options->axis, "Axis of the slave, 0 = first")
      ->check(CLI::Range(0U, 7U))
      ->capture_default_str();
  CLI::Option_group* target = command->add_option_group("target", "Where to (one of)");
  target->add_option("--revolutions", options->revolutions, "By so many turns of the motor")
      ->check(CLI::Range(-40'000.0, 40'000.0));
  target->add_option("--by", options->by, "By so many drive units");
  target->add_option("--to", options->to, "To this position in drive units");
  target->require_option(1);
  command
      ->add_option("--units-per-revolution", options->units_per_revolution,
                   "Drive units per turn of the motor, for --revolutions")
      ->check(CLI::Range(1U, 1U << 30))
      ->capture_default_str();
  command->add_option("--velocity", options->velocity, "Drive units per second")
      ->check(CLI::Range(1U, std::numeric_limits<std::uint32_t>::max()))
      ->capture_default_str();
  command->add_option("--acceleration", options->acceleration, "Drive units per second squared")
      ->check(CLI::Range(1U, std::numeric_limits<std::uint32_t>::max()))
      ->capture_default_str();
  command->add_option("--deceleration", options->deceleration, "As --acceleration if left out")
      ->check(CLI::Range(1U, std::numeric_limits<std::uint32_t>::max()));
  command
      ->add_option("--settle", options->settle,
                   "How long the motor stays under current after the target is reached")
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  stator move --link ethercat:eth1 --revolutions 10\n"
      "  stator move --device tmcm-3315 --axis 2 --to 512000 --record move.csv");
  command->callback([options] { move(*options); });
}

}  // namespace stator::cli
