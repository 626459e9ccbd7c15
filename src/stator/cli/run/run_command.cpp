// stator run: runs the devices of a rack file on interfaces of this machine until it is stopped.
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/logging.hpp"
#include "stator/cli/option_values.hpp"
#include "stator/cli/run/live_session.hpp"
#include "stator/cli/run/next_name.hpp"
#include "stator/cli/run/run_options.hpp"
#include "stator/cli/run/run_report.hpp"
#include "stator/cli/run/running_rack_file.hpp"
#include "stator/cli/run/show.hpp"
#include "stator/cli/run/standard_output.hpp"
#include "stator/cli/run/stop_signals.hpp"
#include "stator/link/ethernet/machine.hpp"
#include "stator/link/system/file_descriptor.hpp"
#include "stator/rack/file/shared_addresses.hpp"
#include "stator/rack/kept/directory_place.hpp"
#include "stator/rack/observe/output_files.hpp"
#include "stator/rack/observe/pin_trace.hpp"
#include "stator/rack/run/runner.hpp"

namespace stator::cli {

namespace {

void print_trace_end(const rack::PinTrace& trace, const std::string& file) {
  fmt::print("{}: {} edges and words", file, trace.written());
  if (trace.dropped() != 0) {
    fmt::print(", {} lost because they came faster than they could be written", trace.dropped());
  }
  fmt::print("\n");
}

/// Ends all that was written while the rack ran; `asked`: when the end was asked for
/// (link::BackgroundOutput::drain()). Throws Failure if something is missing in a file that
/// somebody wants.
void end_files(rack::Rack& rack, base::SimTime now, LiveSession& session,
               link::BackgroundOutput::Clock::time_point asked) {
  std::vector<std::string> missing;
  if (rack::PinTrace* trace = rack.trace(); trace != nullptr) {
    trace->finish(now, asked);
    print_trace_end(*trace, trace->output().name());
    if (trace->dropped() != 0) {
      missing.push_back(fmt::format("trace {} is not complete: {} edges are missing",
                                    trace->output().name(), trace->dropped()));
    }
  }
  std::ranges::copy(rack.outputs().finish(asked), std::back_inserter(missing));
  if (std::string broken_off = session.finish(asked); !broken_off.empty()) {
    missing.push_back(std::move(broken_off));
  }
  if (const std::uint64_t lost = log_output()->lost(); lost != 0) {
    fmt::print("{} lines of the log were lost, because standard error was not read in time\n",
               lost);
  }
  if (!missing.empty()) {
    throw Failure(fmt::format("{}", fmt::join(missing, "\nstator: ")));
  }
}

/// Ends the program, with status 1, if this lives longer than kPatience and `waits` says that it is
/// for the disk of the state directory: nobody can take back a call that waits for a disk.
class DiskWatch {
 public:
  static constexpr std::chrono::milliseconds kPatience{700};

  DiskWatch(std::string directory, std::function<bool()> waits)
      : thread_([directory = std::move(directory),
                 waits = std::move(waits)](const std::stop_token& over) {
          std::mutex mutex;
          std::unique_lock lock(mutex);
          std::condition_variable_any never;
          never.wait_for(lock, over, kPatience, [] { return false; });
          if (!over.stop_requested() && waits()) {
            say_failure(fmt::format(
                "{}: the disk of the state directory does not answer; what devices were ordered to "
                "keep last may be missing there, and nobody was told that it is kept",
                directory));
            std::_Exit(EXIT_FAILURE);
          }
        }) {}

 private:
  std::jthread thread_;
};

/// Stops the threads, which in lockstep may wait for the state directory's disk, and waits for what
/// was ordered to be kept.
void stop(rack::Runner& runner, rack::Rack& rack, const std::string& state) {
  rack::DeviceStorage* const storage = rack.storage();
  if (storage == nullptr) {
    runner.stop();
    return;
  }
  {
    const DiskWatch watch(state, [storage] { return storage->busy(); });
    runner.stop();
  }
  const DiskWatch watch(state, [] { return true; });
  storage->flush(runner.now());
}

/// Throws Failure if contents that devices take for kept are not on the disk, or if the next start
/// will not find the state directory at its path. `state`: the directory as it was at the start.
void require_kept(rack::Rack& rack, const std::string& path, const link::FileDescriptor& state) {
  if (rack.storage() == nullptr) {
    return;
  }
  if (const std::string gone = rack::displacement(state.get(), path); !gone.empty()) {
    throw Failure(fmt::format(
        "{}: the state directory {}; the next start will not find there what devices have kept",
        path, gone));
  }
  if (const auto unkept = rack.storage()->unkept(); !unkept.empty()) {
    throw Failure(fmt::format("not everything is kept that devices should keep:\n  {}",
                              fmt::join(unkept, "\n  ")));
  }
}

void announce(const rack::RackConfiguration& configuration, rack::Rack& rack, rack::Runner& runner,
              const OpenedWebServer& web) {
  drain_log();  // what is printed follows on it
  print_networks(configuration, rack, runner);
  fmt::print("{}Running; Ctrl-C ends it.\n", web.announcement);
  static_cast<void>(std::fflush(stdout));
}

/// Where a run begins, and how far it has come.
struct Start {
  std::optional<RecordingPlace> from;  ///< nothing: at power-on
  std::string refusal{};               ///< why another rack, which was asked for, did not start
  bool running = false;                ///< nothing can fail any more
};

/// Throws Failure if a run cannot begin anew for a recording: it would write its files anew, too.
void require_recordable(const rack::RackConfiguration& configuration, bool goes_on) {
  if (goes_on) {
    throw Failure(
        "this run goes on from a recording; end it and start the rack anew to record it from "
        "power-on on");
  }
  const bool writes =
      configuration.record || configuration.trace ||
      std::ranges::any_of(configuration.segments,
                          [](const auto& segment) { return !segment.capture.empty(); }) ||
      std::ranges::any_of(configuration.buses, [](const rack::BusConfiguration& bus) {
        return !bus.log.empty() || !bus.capture.empty();
      });
  if (writes) {
    throw Failure(
        "this run writes other files (signals, captures, logs, traces), which would begin anew as "
        "well; start it with --record NAME.stator");
  }
}

void begin(rack::Runner& runner, const OpenedWebServer& web, const RunOptions& options,
           rack::Log& logger) {
  runner.start();
  if (options.priority) {
    if (const auto locked = link::lock_memory(); !locked) {
      logger.warning(locked.error().text);
    }
  }
  if (web.server != nullptr) {
    web.server->start();
  }
}

/// What somebody who looks at the run wishes to have next; nothing: they go on looking.
std::optional<NextRun> wish(LiveSession& session, RunningRackFile& rack_file) {
  if (auto path = rack_file.wished()) {
    return NextRun{.rack_file = std::move(*path)};
  }
  return session.wished();
}

void forget_ended_recording(LiveSession& session, RunOptions& given) {
  if (session.recorder() != nullptr && !session.recording().running) {
    given.record.clear();
  }
}

/// One rack from `start_at` until a signal comes, `limit` has passed or somebody wishes another
/// run; then returns which. A port that the system was to choose for the web server is kept in
/// `given`, which loses a recording that was ended meanwhile: no run goes on with that.
std::optional<NextRun> run_rack(RunOptions& given, Start& start_at, StopSignals& signals,
                                StandardOutput& output, std::optional<base::SimDuration> limit) {
  const std::optional<RecordingPlace>& from = start_at.from;
  signals.starting();
  std::optional<RecordedRack> recorded;
  RunOptions options = given;
  if (from) {
    recorded.emplace(from->path, state_for(*from, given));
    options = continued(given, recorded->options());
  }
  const rack::RackConfiguration configuration = configuration_of(options);
  if (from) {
    require_same_ports(configuration, recorded->configuration());
  }
  const auto logger = make_logger();
  rack::EventLog log(from ? nullptr : logger);
  std::optional<replay::RecordingHeader> header;
  if (is_session(options.record)) {
    header = header_of(options, configuration);  // kept files are those of power-on
  }
  for (const std::string& warning : rack::shared_addresses(configuration)) {
    logger->warning(warning);
  }
  rack::Rack rack(configuration, log);
  const link::FileDescriptor state(
      ::open(configuration.state.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  rack.outputs().add(*log_output(),
                     {.name = "standard error", .records = "lines", .wanted_complete = false});
  RunningRackFile rack_file(
      options, from ? "this rack came out of a recording; start one with \"stator run\"" : "",
      start_at.refusal);
  LiveSession session(configuration.state, [&](const std::string& path) {
    require_recordable(configuration, from.has_value());
    RunOptions next = options;
    next.record = path;
    static_cast<void>(header_of(next, configuration_of(next)));  // the rack file may have changed
  });
  if (header) {
    session.record(rack, options.record, std::move(*header));
  }
  base::SimTime start;
  if (from) {
    start = LiveSession::go_to(*from, *recorded, rack, log);
    log.set_logger(logger);
    fmt::print("Going on from {:.6f} s of {}\n", start.seconds(), from->path);
  }
  OpenedWebServer web;  // goes after the runner, which may have tasks of it
  rack::Runner runner(rack, configuration, logger, start, options.priority);
  manual::ManualControl manual(runner, configuration, log);
  web =
      open_web_server(options.web, rack, configuration, log, runner, &session, &rack_file, &manual);
  signals.running();
  start_at.running = true;
  // Only now, when nothing can fail any more.
  announce(configuration, rack, runner, web);
  output.drain();  // what is logged follows on it
  if (web.server != nullptr) {
    given.web.http = web.server->address().text();
  }
  begin(runner, web, options, *logger);
  std::optional<Show> show;
  if (given.show) {
    show.emplace(manual, runner, configuration, options.rack_file);
  }
  while (signals.wait(limit) == SIGUSR1 && !wish(session, rack_file)) {
  }
  const auto asked = link::BackgroundOutput::Clock::now();
  rack.outputs().stop_waiting();
  if (web.server != nullptr) {
    web.server->stop();
  }
  show.reset();
  manual.stop();
  stop(runner, rack, configuration.state);
  drain_log(asked);  // what is printed follows on it
  print_end(configuration, rack, runner);
  end_files(rack, runner.now(), session, asked);
  require_kept(rack, configuration.state, state);
  forget_ended_recording(session, given);
  return wish(session, rack_file);
}

/// Runs racks one after the other, the next one as somebody wished who looked at the one before.
/// One that does not start gives way to the one before it.
void run_racks(RunOptions& options, std::optional<RecordingPlace> from, StopSignals& signals,
               StandardOutput& output, std::optional<base::SimDuration> limit) {
  Start start{.from = std::move(from)};
  std::string former;
  while (!signals.stopped()) {
    std::optional<NextRun> next;
    start.running = false;
    try {
      next = run_rack(options, start, signals, output, limit);
      start.refusal.clear();
      former.clear();
    } catch (const std::runtime_error& error) {
      if (start.running || former.empty()) {
        throw;
      }
      start.refusal = error.what();
      fmt::print("{} does not start: {}\n", options.rack_file, start.refusal);
      next = NextRun{.rack_file = std::exchange(former, {})};
    }
    if (!next) {
      return;
    }
    if (!next->record.empty()) {
      options.record = next->record;
      continue;
    }
    if (!next->rack_file.empty()) {
      if (start.running) {
        former = options.rack_file;
      }
      options.rack_file = next->rack_file;
      fmt::print("Going on with {}\n", options.rack_file);
    } else {
      start.from = std::move(next->from);
      options.rack_file.clear();
      options.device.clear();
      options.state.clear();
    }
    if (is_session(options.record)) {
      options.record = next_name(options.record);
    }
  }
}

}  // namespace

void run_until_stopped(RunOptions options) {
  const auto logger = make_logger();
  StandardOutput output;
  if (options.priority) {
    // Asked here, so that nothing has begun; threads that are made from now on have no priority of
    // the program's own start ("chrt") either.
    if (const auto permitted = link::may_run_in_real_time(*options.priority); !permitted) {
      throw Failure("--priority: " + permitted.error().text);
    }
  }
  std::optional<base::SimDuration> limit;
  if (!options.duration.empty()) {
    limit = duration_option("--duration", options.duration);
  }
  StopSignals signals;
  options.web.token = web::make_token();  // pages that are open outlast going back
  std::optional<RecordingPlace> from;
  if (!options.restore.empty()) {
    from = parse_place(options.restore);
    if (is_session(options.record) && std::filesystem::exists(options.record)) {
      throw Failure(
          fmt::format("{} exists; name another file for the run that goes on", options.record));
    }
  }
  run_racks(options, std::move(from), signals, output, limit);
}

void add_run_command(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Run a rack of virtual devices on real interfaces");
  add_run_options(*command, *options);
  command->callback([options] { run_until_stopped(*options); });
}

}  // namespace stator::cli
