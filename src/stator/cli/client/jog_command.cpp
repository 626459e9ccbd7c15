// stator jog: moves an axis of a running rack by hand, with the small master inside that rack.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/client/rack_client.hpp"
#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/interruption.hpp"
#include "stator/cli/option_values.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/progress.hpp"
#include "stator/manual/command.hpp"

namespace stator::cli {

namespace {

using manual::CommandKind;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// How often the rack is asked.
constexpr milliseconds kPoll{50};
/// How often a velocity is repeated; it holds for manual::kJogHold.
constexpr milliseconds kRepetition{150};

struct JogOptions {
  RackClientOptions client;
  std::string device;
  std::string command;
  std::size_t axis = 0;
  std::optional<std::int64_t> value;
  std::optional<double> revolutions;
  bool relative = false;
  std::string duration = "1s";
};

/// A device under manual control, as its rack tells it.
class Controlled {
 public:
  explicit Controlled(const JogOptions& options)
      : options_(options),
        client_(options.client),
        path_("/api/v1/devices/" + options.device + "/manual") {}

  /// Takes it over unless it is under manual control already.
  void begin() {
    auto state = client_.get(path_);
    if (state["phase"] != "active") {
      state = client_.put(path_);
    }
    while (state["phase"] == "starting") {
      std::this_thread::sleep_for(kPoll);
      state = client_.get(path_);
    }
    if (state["phase"] != "active") {
      throw Failure(fmt::format("{}: {}", options_.device, state.value("text", std::string())));
    }
  }
  void give_back() { client_.remove(path_); }

  /// The axis at present. Throws Failure if it is not under manual control any more.
  [[nodiscard]] nlohmann::json axis() {
    const auto state = client_.get(path_);
    if (state["phase"] != "active") {
      throw Failure(fmt::format("{}: manual control has ended: {}", options_.device,
                                state.value("text", std::string())));
    }
    if (options_.axis >= state["axes"].size()) {
      throw Failure(fmt::format("{} has no axis {}; the last is {}", options_.device, options_.axis,
                                state["axes"].size() - 1));
    }
    return state["axes"][options_.axis];
  }

  /// Hands in a command and waits until it was carried out. Throws Failure with why it was not.
  nlohmann::json execute(const nlohmann::json& command) {
    const auto before = axis().value("executed", std::uint64_t{0});
    client_.post(fmt::format("{}/{}", path_, options_.axis), command);
    auto now = axis();
    while (now.value("executed", std::uint64_t{0}) == before) {
      std::this_thread::sleep_for(kPoll);
      now = axis();
    }
    if (const auto refusal = now.value("refusal", std::string()); !refusal.empty()) {
      throw Failure(fmt::format("{} axis {}: {}", options_.device, options_.axis, refusal));
    }
    return now;
  }

 private:
  const JogOptions& options_;
  RackClient client_;
  std::string path_;
};

void print_axis(const JogOptions& options, const nlohmann::json& axis) {
  fmt::print("{} axis {}: {}, position {:.0f}", options.device, options.axis,
             axis.value("state", std::string()), axis.value("position", 0.0));
  const double per_revolution = axis["position_per_revolution"].is_null()
                                    ? 0.0
                                    : axis["position_per_revolution"].get<double>();
  if (per_revolution != 0.0) {
    fmt::print(" ({:.3f} rev)", axis.value("position", 0.0) / per_revolution);
  }
  fmt::print(", velocity {:.0f}", axis.value("velocity", 0.0));
  if (!axis["statusword"].is_null()) {
    fmt::print(", statusword {:04X}h", axis["statusword"].get<unsigned>());
  }
  fmt::print("\n");
}

/// VALUE, or --revolutions in the units of the device: a position, or a velocity.
std::int64_t value_of(const JogOptions& options, CommandKind kind, const nlohmann::json& axis) {
  if (options.value) {
    return *options.value;
  }
  const char* const unit =
      kind == CommandKind::jog ? "velocity_per_revolution" : "position_per_revolution";
  if (!options.revolutions) {
    throw Failure(fmt::format("\"{}\" needs a VALUE or --revolutions", manual::name_of(kind)));
  }
  if (axis[unit].is_null()) {
    throw Failure(
        fmt::format("it is not known what a revolution is to {}; give a VALUE in its own "
                    "units",
                    options.device));
  }
  return std::llround(*options.revolutions * axis[unit].get<double>());
}

/// Keeps the axis turning until `duration` is over or Ctrl-C comes.
nlohmann::json turn(Controlled& device, const nlohmann::json& command, base::SimDuration duration,
                    const Interruption& interruption) {
  const auto begin = steady_clock::now();
  const std::chrono::duration<double> whole(duration.seconds());
  const auto end = begin + std::chrono::nanoseconds(duration.nanoseconds());
  Progress progress("turning");
  do {
    static_cast<void>(device.execute(command));
    std::this_thread::sleep_for(kRepetition);
    progress.reached(std::min((steady_clock::now() - begin) / whole, 1.0));
  } while (steady_clock::now() < end && !interruption.taken());
  return device.execute({{"command", "stop"}});
}

/// 0 where the device tells none.
double position_of(const nlohmann::json& axis) {
  return axis["position"].is_null() ? 0.0 : axis["position"].get<double>();
}

/// Waits until the axis, which was at `start`, is at `target`; Ctrl-C stops it.
nlohmann::json arrive(Controlled& device, nlohmann::json axis, double start, double target,
                      const Interruption& interruption) {
  Progress progress("moving");
  while (axis["reached"] != true) {
    if (interruption.taken()) {
      return device.execute({{"command", "stop"}});
    }
    std::this_thread::sleep_for(kPoll);
    axis = device.axis();
    if (target != start) {
      progress.reached(std::clamp((position_of(axis) - start) / (target - start), 0.0, 1.0));
    }
    if (axis["fault"] == true) {
      throw Failure(
          fmt::format("the drive is in Fault, error code {:04X}h",
                      axis["error_code"].is_null() ? 0U : axis["error_code"].get<unsigned>()));
    }
  }
  return axis;
}

/// What COMMAND can be.
std::vector<std::string> words() {
  std::vector<std::string> all{"status", "release"};
  for (const std::string_view name : manual::command_names()) {
    all.emplace_back(name);
  }
  return all;
}

void jog(const JogOptions& options) {
  const base::SimDuration duration = duration_option("--for", options.duration);
  Controlled device(options);
  if (options.command == "release") {
    device.give_back();
    fmt::print("{} is given back\n", options.device);
    return;
  }
  if (options.command == "status") {
    device.begin();
    print_axis(options, device.axis());
    return;
  }
  const CommandKind kind = *manual::command_of(options.command);  // it is one of words()
  device.begin();
  nlohmann::json command{{"command", options.command}};
  using enum CommandKind;
  double start = 0.0;
  double target = 0.0;
  if (kind == CommandKind::jog || kind == move || kind == mode || kind == controlword) {
    const auto before = device.axis();
    const std::int64_t value = value_of(options, kind, before);
    command["value"] = value;
    start = position_of(before);
    target = static_cast<double>(value) + (options.relative ? start : 0.0);
  }
  if (kind == move) {
    command["relative"] = options.relative;
  }
  const Interruption interruption;
  auto axis = kind == CommandKind::jog ? turn(device, command, duration, interruption)
                                       : device.execute(command);
  if (kind == move) {
    axis = arrive(device, std::move(axis), start, target, interruption);
  }
  print_axis(options, axis);
}

}  // namespace

void add_jog_command(CLI::App& app) {
  auto options = std::make_shared<JogOptions>();
  CLI::App* command = app.add_subcommand("jog", "Move an axis of a rack that is running by hand");
  command->add_option("DEVICE", options->device, "Name of the device")->required();
  command
      ->add_option(
          "COMMAND", options->command,
          "What the axis shall do; status tells where it is, release gives the device back")
      ->check(one_of(words()))
      ->required();
  command->add_option("VALUE", options->value,
                      "move: position; jog: velocity; mode: its number; controlword: what is "
                      "written; in the units of the device");
  command->add_option("-a,--axis", options->axis, "Axis of the device, 0 = first")
      ->capture_default_str();
  command
      ->add_option("--revolutions", options->revolutions,
                   "move: revolutions of the motor; jog: revolutions per second; instead of "
                   "VALUE")
      ->excludes("VALUE");
  command->add_flag("--by", options->relative, "move: by so much from where the axis is");
  command->add_option("--for", options->duration, "jog: how long")->capture_default_str();
  add_client_options(*command, options->client);
  command->footer(
      "A small master inside the rack takes the device into operation; it steps aside the moment "
      "another master speaks on the device's network.\n"
      "Examples:\n"
      "  stator jog gantry enable --axis 1\n"
      "  stator jog gantry move --axis 1 --revolutions 5 --by\n"
      "  stator jog spindle jog --revolutions -0.5 --for 3s\n"
      "  stator jog gantry release");
  command->callback([options] { jog(*options); });
}

}  // namespace stator::cli
