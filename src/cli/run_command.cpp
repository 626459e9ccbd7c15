#include <cerrno>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/logger.h>

#include "cli/bus.hpp"
#include "cli/commands.hpp"
#include "cli/connection_hints.hpp"
#include "cli/failure.hpp"
#include "cli/logging.hpp"
#include "rack/product_catalogue.hpp"
#include "rack/rack_file.hpp"
#include "rack/runner.hpp"
#include "rack/text.hpp"
#include "rack/wiring.hpp"

namespace stator::cli {

namespace {

struct RunOptions {
  std::string rack_file;
  std::string device;
  unsigned count = 1;
  std::string link;
  std::string redundant;
  std::string wait;
  std::optional<unsigned> cpu;
  std::string clock;
  std::string capture;
  std::string record;
  std::string record_period;
  std::vector<std::string> signals;
  std::string duration;
  std::string state;
  bool no_emergencies = false;
};

base::SimDuration duration_option(const std::string& name, const std::string& text) {
  const auto duration = rack::parse_duration(text);
  if (!duration || *duration <= base::SimDuration(0)) {
    throw Failure(
        fmt::format("{} \"{}\" is no duration; write e.g. 1ms, 250us or 10s", name, text));
  }
  return *duration;
}

rack::RackConfiguration base_configuration(const RunOptions& options) {
  if (!options.rack_file.empty()) {
    return rack::load_rack_file(options.rack_file);
  }
  if (options.device.empty()) {
    throw Failure(
        "nothing to run; name a rack file, or a product with --device and a link with "
        "--link ethercat:INTERFACE");
  }
  rack::RackConfiguration configuration = rack::single_device_rack(options.device);
  auto& devices = configuration.segments.front().devices;
  for (unsigned i = 1; i < options.count; ++i) {
    devices.push_back(devices.front());
    devices.back().name = fmt::format("{}-{}", devices.front().name, i + 1);
  }
  return configuration;
}

void switch_emergencies_off(rack::RackConfiguration& configuration) {
  for (rack::SegmentConfiguration& segment : configuration.segments) {
    for (rack::DeviceConfiguration& device : segment.devices) {
      std::visit([](auto& product) { product.emergencies = false; }, device.product);
    }
  }
}

/// The rack file's configuration with the command line's options on top.
rack::RackConfiguration configuration_of(const RunOptions& options) {
  rack::RackConfiguration configuration = base_configuration(options);
  rack::SegmentConfiguration& segment = configuration.segments.front();
  if (!options.link.empty()) {
    segment.link = link_of(options.link);
  }
  if (!options.redundant.empty()) {
    segment.redundant_link = link_of(options.redundant);
  }
  if (!options.wait.empty()) {
    segment.wait = rack::wait_modes().at(options.wait);
  }
  if (options.cpu) {
    segment.cpu = options.cpu;
  }
  if (!options.capture.empty()) {
    segment.capture = options.capture;
  }
  if (!options.clock.empty()) {
    configuration.clock = rack::clock_kinds().at(options.clock);
  }
  if (!options.record.empty()) {
    configuration.record.emplace();
    configuration.record->file = options.record;
  }
  if (configuration.record && !options.record_period.empty()) {
    configuration.record->period = duration_option("--record-period", options.record_period);
  }
  if (configuration.record && !options.signals.empty()) {
    configuration.record->signals = options.signals;
  }
  if (!options.state.empty()) {
    configuration.state = options.state;
  }
  if (options.no_emergencies) {
    switch_emergencies_off(configuration);
  }
  if (segment.link.in_process()) {
    throw Failure(
        fmt::format("the rack has no link to a master; give it with --link as {}. To try Stator "
                    "without any, run \"stator demo\"",
                    link::kLinkForms));
  }
  return configuration;
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

void print_start(const rack::RackConfiguration& configuration, rack::Rack& rack,
                 const rack::Runner& runner) {
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    const rack::SegmentConfiguration& segment = configuration.segments[i];
    const std::string redundant =
        segment.redundant() ? " and " + runner.link(i, ethercat::MasterInterface::secondary).name()
                            : std::string();
    fmt::print("Segment on {}{}: {} device{}\n", runner.link(i).name(), redundant,
               segment.devices.size(), segment.devices.size() == 1 ? "" : "s");
    for (const rack::NamedDevice& member : rack.devices(i)) {
      fmt::print("  {}  ({})\n", member.name, member.device->description().name);
    }
    fmt::print("{}", connection_hints(segment.link));
  }
  fmt::print("Running; Ctrl-C ends it.\n");
  std::fflush(stdout);
}

void print_end(const rack::RackConfiguration& configuration, rack::Runner& runner) {
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    const rack::SegmentStatistics statistics = runner.statistics(i);
    const double mean = statistics.frames == 0 ? 0.0
                                               : static_cast<double>(statistics.processing_ns) /
                                                     static_cast<double>(statistics.frames) * 1e-3;
    fmt::print(
        "{}: {} frames answered in {:.1f} us on average (worst {:.1f} us), {} others "
        "ignored, {} dropped by the system, {} overruns\n",
        runner.link(i).name(), statistics.frames, mean,
        static_cast<double>(statistics.worst_processing_ns) * 1e-3, statistics.frames_ignored,
        runner.link(i).statistics().frames_dropped, statistics.overruns);
  }
}

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
  rack::Runner runner(rack, configuration, logger);
  print_start(configuration, rack, runner);
  runner.start();
  signals.wait(limit);
  runner.stop();
  print_end(configuration, runner);
  if (rack.recorder() && !rack.recorder()->good()) {
    throw Failure(
        fmt::format("recording to {} failed; is the disk full?", configuration.record->file));
  }
}

}  // namespace

void add_run_command(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Run a rack of virtual devices on real interfaces");
  auto* file = command->add_option("rack", options->rack_file, "Rack file (TOML)");
  command->add_option("--device", options->device, "Product to run instead of a rack file")
      ->excludes(file);
  command->add_option("--count", options->count, "How many of --device, wired in line")
      ->check(CLI::Range(1U, 500U))
      ->capture_default_str();
  command->add_option("--link", options->link,
                      "Link of the first segment: " + std::string(link::kLinkForms));
  command->add_option("--redundant", options->redundant,
                      "ethercat:INTERFACE at the end of the first segment, for cable redundancy");
  command
      ->add_option("--wait", options->wait,
                   "block: no load when idle; spin: fastest, takes a processor; adaptive: both")
      ->check(CLI::IsMember({"block", "spin", "adaptive"}));
  command->add_option("--cpu", options->cpu, "Processor for the first segment's thread");
  command
      ->add_option("--clock", options->clock,
                   "real: the machine's time; lockstep: time moves only with the master's frames")
      ->check(CLI::IsMember({"real", "lockstep"}));
  command->add_option("--capture", options->capture, "Write all frames to this pcap file");
  command->add_option("--record", options->record, "Write signals to this CSV file");
  command->add_option("--record-period", options->record_period,
                      "Simulated time between two rows, e.g. 1ms");
  command->add_option("--signals", options->signals, "Signals to record, e.g. \"*.axis0.*\"");
  command->add_option("--duration", options->duration, "Stop after this time, e.g. 10s");
  command->add_option("--state", options->state,
                      "Directory in which devices keep EEPROM content and firmware images");
  command->add_flag("--no-emergencies", options->no_emergencies,
                    "Devices send no CoE emergencies, for masters that cannot take any");
  command->footer(
      "Examples:\n"
      "  stator run racks/gantry.toml --link ethercat:eth1\n"
      "  stator run --device tmcm-3315 --link ethercat:eth1 --wait spin --cpu 1\n"
      "  stator run --device tmcm-3315 --link udp:0.0.0.0\n"
      "  stator run --device tmcm-3315 --link ethercat:eth1 --record run.csv --signals "
      "\"*.axis0.*\"");
  command->callback([options] { run(*options); });
}

}  // namespace stator::cli
