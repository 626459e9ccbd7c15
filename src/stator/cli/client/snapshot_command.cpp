// stator snapshot: keeps moments of a running rack to come back to.

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/client/rack_client.hpp"
#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/progress.hpp"
#include "stator/web/api/session_api.hpp"

namespace stator::cli {

namespace {

struct SnapshotOptions {
  RackClientOptions client;
  std::string name;
  std::string format = "text";
};

double seconds_of(const nlohmann::json& answer) {
  return answer.value("time_ns", 0.0) * 1e-9;
}

void list_snapshots(const SnapshotOptions& options) {
  const auto answer = RackClient(options.client).get("/api/v1/snapshots");
  if (options.format == "json") {
    fmt::print("{}\n", answer["snapshots"].dump(2));
    return;
  }
  if (answer["snapshots"].empty()) {
    fmt::print("no snapshots\n");
    return;
  }
  fmt::print("{:>14}  {}\n", "TAKEN AT", "NAME");
  for (const auto& snapshot : answer["snapshots"]) {
    fmt::print("{:>12.6f} s  {}\n", seconds_of(snapshot), snapshot.value("name", std::string()));
  }
}

/// A name that no snapshot can have must not get into a path of the server.
void check_name(const std::string& name) {
  if (!web::is_snapshot_name(name)) {
    throw Failure(fmt::format(
        "\"{}\" cannot be the name of a snapshot: that has 1 to 64 letters of ASCII, digits, \"-\" "
        "and \"_\", no digit first",
        name));
  }
}

void take_snapshot(const SnapshotOptions& options) {
  check_name(options.name);
  const auto done = RackClient(options.client).post("/api/v1/snapshots", {{"name", options.name}});
  fmt::print("snapshot {} taken at {:.6f} s\n", options.name, seconds_of(done));
}

/// The file that is being recorded; empty while the server is away.
std::string recording_of(const SnapshotOptions& options) {
  try {
    return RackClient(options.client).get("/api/v1/recording").value("file", std::string());
  } catch (const Failure&) {
    return {};
  }
}

/// Returns when the rack is back: it is built again meanwhile, and records to another file.
void restore_snapshot(const SnapshotOptions& options) {
  constexpr std::chrono::minutes kPatience{5};
  constexpr std::chrono::milliseconds kPause{50};
  check_name(options.name);
  RackClient client(options.client);
  const auto before = client.get("/api/v1/recording");
  client.post(fmt::format("/api/v1/snapshots/{}/restore", options.name), nlohmann::json::object());
  const auto end = std::chrono::steady_clock::now() + kPatience;
  std::string now;
  std::optional<Progress> progress("going back");
  do {
    if (std::chrono::steady_clock::now() >= end) {
      throw Failure("the rack has not come back from going to the snapshot; see its log");
    }
    std::this_thread::sleep_for(kPause);
    now = recording_of(options);
  } while (now.empty() || now == before.value("file", std::string()));
  progress.reset();
  fmt::print("snapshot {} restored; from there on {} is recorded\n", options.name, now);
}

}  // namespace

void add_snapshot_command(CLI::App& app) {
  auto options = std::make_shared<SnapshotOptions>();
  CLI::App* command =
      app.add_subcommand("snapshot", "Keep moments of a rack that is running and go back to them");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n"
      "  stator snapshot take before-homing\n"
      "  stator snapshot restore before-homing\n"
      "The rack must have been started with --http and --record; its token is in STATOR_TOKEN or "
      "--http-token.");
  const auto add = [&](const char* name, const char* summary, auto* action) {
    CLI::App* sub = command->add_subcommand(name, summary);
    add_client_options(*sub, options->client);
    sub->callback([options, action] { action(*options); });
    return sub;
  };
  add("list", "List what has been kept", &list_snapshots)
      ->add_option("--format", options->format, "text or json")
      ->check(one_of({"text", "json"}))
      ->capture_default_str();
  add("take", "Keep the rack as it is now", &take_snapshot)
      ->add_option("name", options->name, "What it is to be called; begins with a letter")
      ->required();
  add("restore", "Bring the rack back to what was kept", &restore_snapshot)
      ->add_option("name", options->name, "What it was called")
      ->required();
}

}  // namespace stator::cli
