// Steps of a CiA 402 master.
#include <map>
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

const std::map<std::string, OperationMode>& modes() {
  using enum OperationMode;
  static const std::map<std::string, OperationMode> words{
      {"profile-position", profile_position},
      {"profile-velocity", profile_velocity},
      {"profile-torque", profile_torque},
      {"homing", homing},
      {"interpolated-position", interpolated_position},
      {"cyclic-synchronous-position", cyclic_synchronous_position},
      {"cyclic-synchronous-velocity", cyclic_synchronous_velocity},
      {"cyclic-synchronous-torque", cyclic_synchronous_torque}};
  return words;
}

constexpr base::SimDuration kResponse = 1_s;
constexpr base::SimDuration kMove = 30_s;

/// What every step of an axis has.
struct AxisStep {
  rack::DeviceAddress device;
  unsigned axis = 0;
  base::SimDuration within;

  /// Calls `act` with a client of the axis.
  template <typename Act>
  Outcome run(bench::Bench& bench, const Act& act) const {
    const auto port = bench.drive(device);
    if (!port) {
      return fail(port.error().text);
    }
    Cia402Client client(**port, axis);
    client.set_response_timeout(within);
    return outcome_of(act(client));
  }
};

AxisStep read_axis(rack::TableReader& section, StepReader& reader, base::SimDuration otherwise) {
  AxisStep step;
  step.device = reader.device(section);
  step.axis = StepReader::axis(section);
  step.within = StepReader::within(section, otherwise);
  return step;
}

std::string title_of(const char* what, const AxisStep& step, StepReader& reader) {
  return fmt::format("{} {}", what, axis_text(reader.name_of(step.device), step.axis));
}

}  // namespace

ReadStep read_enable(rack::TableReader& section, StepReader& reader) {
  const AxisStep step = read_axis(section, reader, kResponse);
  std::set<std::string> names;
  for (const auto& [name, mode] : modes()) {
    names.insert(name);
  }
  const auto mode = section.choice({"mode", "Mode of operation that is chosen before"}, names);
  std::string title = title_of("enable", step, reader);
  if (mode) {
    title += " in mode " + *mode;
  }
  return {std::move(title), [=](bench::Bench& bench) {
            return step.run(bench, [&](Cia402Client& client) {
              if (mode) {
                if (auto set = client.set_mode(modes().at(*mode)); !set) {
                  return set;
                }
              }
              return client.enable();
            });
          }};
}

ReadStep read_disable(rack::TableReader& section, StepReader& reader) {
  const AxisStep step = read_axis(section, reader, kResponse);
  return {title_of("disable", step, reader), [=](bench::Bench& bench) {
            return step.run(bench, [](Cia402Client& client) { return client.disable(); });
          }};
}

ReadStep read_reset_fault(rack::TableReader& section, StepReader& reader) {
  const AxisStep step = read_axis(section, reader, kResponse);
  return {title_of("reset the fault of", step, reader), [=](bench::Bench& bench) {
            return step.run(bench, [](Cia402Client& client) { return client.reset_fault(); });
          }};
}

ReadStep read_move(rack::TableReader& section, StepReader& reader) {
  AxisStep step = read_axis(section, reader, kMove);
  const base::SimDuration limit = step.within;
  step.within = kResponse;
  master::ProfileMove move;
  const auto target = section.integer({"target", "Target position in the drive's units"},
                                      std::numeric_limits<std::int32_t>::min(),
                                      std::numeric_limits<std::int32_t>::max());
  section.boolean({"relative", "The target is counted from the one before"}, move.relative);
  const auto unsigned32 = [&section](const settings::KeyWords& key) {
    const auto value = section.integer(key, 0, std::numeric_limits<std::uint32_t>::max());
    return value ? std::optional(static_cast<std::uint32_t>(*value)) : std::nullopt;
  };
  move.velocity = unsigned32({"velocity", "Profile velocity 6081h in the drive's units"});
  move.acceleration =
      unsigned32({"acceleration", "Profile acceleration 6083h in the drive's units"});
  move.deceleration = unsigned32(
      {"deceleration", "Profile deceleration 6084h; without it what `acceleration` says"});
  if (!move.deceleration) {
    move.deceleration = move.acceleration;
  }
  bool wait = true;
  section.boolean({"wait", "The step ends when the target is reached, else when the drive has it"},
                  wait);
  if (!target) {
    section.missing("target", "it is the position to go to, in the drive's units");
  }
  move.target = static_cast<std::int32_t>(*target);
  std::string title =
      fmt::format("{} {} {}{}", title_of("move", step, reader), move.relative ? "by" : "to",
                  move.target, wait ? "" : ", without waiting");
  return {std::move(title), [=](bench::Bench& bench) {
            return step.run(bench, [&](Cia402Client& client) -> master::Result<void> {
              if (auto set = client.set_mode(OperationMode::profile_position); !set) {
                return set;
              }
              if (auto enabled = client.enable(); !enabled) {
                return enabled;
              }
              if (auto started = client.start_move(move); !started) {
                return started;
              }
              return wait ? client.wait_for_target(limit) : master::Result<void>();
            });
          }};
}

}  // namespace stator::scenario
