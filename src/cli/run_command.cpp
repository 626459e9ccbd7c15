#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/logger.h>

#include "cli/commands.hpp"
#include "cli/failure.hpp"
#include "cli/logging.hpp"
#include "cli/run_options.hpp"
#include "cli/run_report.hpp"
#include "rack/runner.hpp"

namespace stator::cli {

namespace {

void print_trace_end(const rack::PinTrace& trace, const std::string& file) {
  fmt::print("{}: {} edges and words", file, trace.written());
  if (trace.dropped() != 0) {
    fmt::print(", {} lost because they came faster than they could be written", trace.dropped());
  }
  fmt::print("\n");
  if (!trace.good()) {
    throw Failure(fmt::format("tracing to {} failed; is the disk full?", file));
  }
}

/// Blocks the signals that end the program in this and all later threads and waits for them here.
class StopSignals {
 public:
  StopSignals() {
    ::sigemptyset(&set_);
    ::sigaddset(&set_, SIGINT);
    ::sigaddset(&set_, SIGTERM);
    ::sigaddset(&set_, SIGHUP);
    ::pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }

  /// Returns when a signal came or `limit` (if any) has passed.
  void wait(std::optional<base::SimDuration> limit) const {
    if (!limit) {
      int signal = 0;
      ::sigwait(&set_, &signal);
      return;
    }
    const std::int64_t nanoseconds = limit->nanoseconds();
    const timespec time{nanoseconds / 1'000'000'000, nanoseconds % 1'000'000'000};
    while (::sigtimedwait(&set_, nullptr, &time) < 0 && errno == EINTR) {
    }
  }

 private:
  sigset_t set_{};
};

void run(const RunOptions& options) {
  const rack::RackConfiguration configuration = configuration_of(options);
  std::optional<base::SimDuration> limit;
  if (!options.duration.empty()) {
    limit = duration_option("--duration", options.duration);
  }
  const StopSignals signals;
  const auto logger = make_logger();
  rack::EventLog log(logger);
  rack::Rack rack(configuration, log);
  std::unique_ptr<web::Server> server;  // goes after the runner, which may have tasks of it
  rack::Runner runner(rack, configuration, logger);
  print_networks(configuration, rack, runner);
  server = open_web_server(options.web, rack, configuration, log, runner);
  fmt::print("Running; Ctrl-C ends it.\n");
  std::fflush(stdout);
  runner.start();
  if (server != nullptr) {
    server->start();
  }
  signals.wait(limit);
  if (server != nullptr) {
    server->stop();
  }
  runner.stop();
  print_end(configuration, rack, runner);
  if (rack.trace() != nullptr) {
    rack.trace()->finish(runner.now());
    print_trace_end(*rack.trace(), configuration.trace->file);
  }
  if (rack.recorder() && !rack.recorder()->good()) {
    throw Failure(
        fmt::format("recording to {} failed; is the disk full?", configuration.record->file));
  }
}

}  // namespace

void add_run_command(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Run a rack of virtual devices on real interfaces");
  add_run_options(*command, *options);
  command->callback([options] { run(*options); });
}

}  // namespace stator::cli
