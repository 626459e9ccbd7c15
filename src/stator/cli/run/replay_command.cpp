// stator replay: plays a recording again, compares each output bit by bit, and writes signals as
// CSV.
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/option_values.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/progress.hpp"
#include "stator/cli/run/recorded_run.hpp"
#include "stator/rack/observe/output_files.hpp"

namespace stator::cli {

namespace {

struct ReplayOptions {
  std::string recording;
  std::string until;
  std::string csv;
  std::string period = "1ms";
  std::vector<std::string> signals{"*"};
};

void print_end(const ReplayOptions& options, const replay::Player& player,
               std::chrono::duration<double> took) {
  const replay::PlayerCounts& counts = player.counts();
  const double simulated = player.now().seconds();
  fmt::print("{}: {:.3f} s with {} EtherCAT frames, {} CAN frames and {} serial bytes of masters\n",
             options.recording, simulated, counts.frames, counts.can_frames, counts.bytes);
  fmt::print(
      "everything that came out is the same to the last bit; replayed in {:.2f} s, {:.1f} "
      "times real time\n",
      took.count(), simulated / std::max(took.count(), 1e-9));
}

/// Plays up to `until`, a second of simulated time after the other, to say how far it is.
std::optional<replay::Difference> play(replay::Player& player,
                                       const replay::RecordingReader& reader, base::SimTime until) {
  constexpr base::SimDuration kSlice{1'000'000'000};
  Progress progress("replaying");
  for (;;) {
    const base::SimTime next = std::min(until, player.now() + kSlice);
    auto difference = player.play(next);
    if (difference || next == until || !player.reached()) {
      return difference;
    }
    progress.reached(reader.part_read());
  }
}

void replay_recording(const ReplayOptions& options, RecordedRack& recorded) {
  base::SimTime until = base::SimTime::never();
  if (!options.until.empty()) {
    until = base::SimTime(duration_option("--until", options.until));
  }
  if (!options.csv.empty()) {
    recorded.configuration().record = {.file = options.csv,
                                       .period = duration_option("--period", options.period),
                                       .signals = options.signals};
  }
  rack::EventLog log;
  std::optional<rack::Rack> built;
  try {
    built.emplace(recorded.configuration(), log);
  } catch (const std::runtime_error& error) {
    throw Failure(fmt::format("{}: its rack cannot be built: {}", options.recording, error.what()));
  }
  rack::Rack& rack = *built;
  replay::Player player(recorded.reader(), rack, recorded.configuration());
  const auto began = std::chrono::steady_clock::now();
  if (const auto difference = play(player, recorded.reader(), until)) {
    throw Failure(fmt::format("{}: {}", options.recording, explain(*difference, log)));
  }
  print_end(options, player, std::chrono::steady_clock::now() - began);
  if (const auto missing = rack.outputs().finish(); !missing.empty()) {
    throw Failure(missing.front());
  }
  if (recorded.reader().ending() == replay::RecordingEnding::cut) {
    throw RecordingCut(fmt::format("{}: replayed to the bit up to the cut at {:.6f} s ({})",
                                   options.recording, player.now().seconds(),
                                   recorded.reader().damage()));
  }
  if (!recorded.reader().damage().empty()) {
    throw Failure(fmt::format("{}: all that was read is the same, but {}", options.recording,
                              recorded.reader().damage()));
  }
}

/// Adds the recording's name to errors of the player and of devices built from a forged recording,
/// which do not know it.
void run_replay(const ReplayOptions& options) {
  RecordedRack recorded(options.recording);
  try {
    replay_recording(options, recorded);
  } catch (const Failure&) {
    throw;
  } catch (const RecordingCut&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw Failure(fmt::format("{}: {}", options.recording, error.what()));
  }
}

}  // namespace

void add_replay_command(CLI::App& app) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand(
      "replay", "Do again what \"stator run --record NAME.stator\" recorded, and compare");
  command->add_option("recording", options->recording, "File of the recording")
      ->required()
      ->check(names(Names::recording));
  command->add_option("--until", options->until, "Simulated time at which to stop, e.g. 12.5s");
  auto* csv = command->add_option("--csv", options->csv, "Write signals to this CSV file")
                  ->check(names(Names::file));
  command->add_option("--period", options->period, "Simulated time between two rows of it")
      ->needs(csv)
      ->capture_default_str();
  command->add_option("--signals", options->signals, "Signals of it, e.g. \"*.axis0.*\"")
      ->needs(csv);
  command->footer(
      "Examples:\n"
      "  stator run racks/gantry.toml --link ethercat:eth1 --record run.stator\n"
      "  stator replay run.stator\n"
      "  stator replay run.stator --until 3s --csv run.csv --period 100us\n"
      "Exit status: 0 all is the same; 1 something is not, or the recording cannot be read; 3 all "
      "is\n"
      "the same up to a place where the recording is cut, because the program was killed or its "
      "disk\n"
      "was full.");
  command->callback([options] { run_replay(*options); });
}

}  // namespace stator::cli
