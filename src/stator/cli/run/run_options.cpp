#include "stator/cli/run/run_options.hpp"

#include <CLI/CLI.hpp>

#include "stator/cli/option_values.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/link/can/can_link_address.hpp"
#include "stator/link/ethernet/link_address.hpp"
#include "stator/link/ethernet/machine.hpp"
#include "stator/link/serial/chip_server.hpp"
#include "stator/link/serial/serial_link.hpp"

namespace stator::cli {

namespace {

/// The rack and the ends of its networks. Returns the option of the rack file.
CLI::Option* add_rack_options(CLI::App& command, RunOptions& options) {
  auto* file = command.add_option("rack", options.rack_file, "Rack file (TOML)")
                   ->check(names(Names::rack_file));
  add_set_option(command, options.changes);
  command.add_option("--device", options.device, "Product to run instead of a rack file")
      ->check(names(Names::product))
      ->excludes(file);
  command
      .add_option("--count", options.count,
                  "How many of --device, wired in line, or with node-IDs or addresses in a row")
      ->check(CLI::Range(1U, 500U))
      ->capture_default_str();
  command
      .add_option("--link", options.link,
                  "Link of the first segment: " + std::string(link::kLinkForms))
      ->check(names(Names::ethernet_link));
  command
      .add_option(
          "--port", options.ports,
          "Port of the first CAN bus, as often as needed: " + std::string(link::kCanLinkForms))
      ->check(names(Names::can_port));
  command
      .add_option("--serial", options.serial,
                  "[INTERFACE=]LINE: serial line of --device, as often as needed; all of --count "
                  "share it: " +
                      std::string(link::kSerialLinkForms))
      ->check(names(Names::serial_line));
  command.add_option("--spi", options.spi,
                     "Socket for the firmware beside a chip given with --device: " +
                         std::string(link::kChipLinkForms));
  command.add_option("--bit-rate", options.bit_rate,
                     "Of the first CAN bus: kbit/s, or \"unlimited\"");
  command
      .add_option("--redundant", options.redundant,
                  "ethercat:INTERFACE at the end of the first segment, for cable redundancy")
      ->check(names(Names::ethernet_link));
  return file;
}

/// How the rack's threads run.
void add_thread_options(CLI::App& command, RunOptions& options) {
  command
      .add_option("--wait", options.wait,
                  "block: no load when idle; spin: fastest, takes a processor; adaptive: both")
      ->check(one_of({"block", "spin", "adaptive"}));
  command.add_option("--cpu", options.cpu, "Processor for the first segment's thread");
  command
      .add_option(
          "--priority", options.priority,
          "Real-time priority (SCHED_FIFO) of the threads that answer masters and programs, "
          "1 to 99, so that a loaded machine does not delay them")
      ->check(CLI::Range(link::kLowestPriority, link::kHighestPriority));
  command
      .add_option("--clock", options.clock,
                  "real: the machine's time; lockstep: time moves only with the master's frames")
      ->check(one_of({"real", "lockstep"}));
}

/// What is kept of a run, and the recording that it goes on from instead of a rack `file`.
void add_recording_options(CLI::App& command, RunOptions& options, CLI::Option* file) {
  command.add_option("--capture", options.capture, "Write all frames to this pcap file")
      ->check(names(Names::file));
  command
      .add_option("--record", options.record,
                  "Write signals to this CSV file; NAME.stator: record all that masters do, for "
                  "\"stator replay\"")
      ->check(names(Names::file));
  command
      .add_option("--restore", options.restore,
                  "FILE.stator[@TIME|@SNAPSHOT]: go on from that place of a recording")
      ->check(names(Names::recording))
      ->excludes(file);
  command.add_option("--record-period", options.record_period,
                     "Simulated time between two rows, e.g. 1ms");
  command.add_option("--signals", options.signals, "Signals to record, e.g. \"*.axis0.*\"");
  auto* trace =
      command
          .add_option("--trace", options.trace,
                      "[DEVICE=]FILE: write the edges at the pins of a TMC8461 to this value "
                      "change dump, for GTKWave")
          ->check(names(Names::file));
  command
      .add_option(
          "--trace-pins", options.trace_pins,
          "Pins to trace, e.g. MFCIO04,MFC_HV0; without it those wired to something, but for DAC0")
      ->delimiter(',')
      ->needs(trace);
}

}  // namespace

bool is_session(const std::string& path) {
  return path.ends_with(".stator");
}

void add_run_options(CLI::App& command, RunOptions& options) {
  CLI::Option* const file = add_rack_options(command, options);
  add_thread_options(command, options);
  add_recording_options(command, options, file);
  command.add_option("--duration", options.duration, "Stop after this time, e.g. 10s");
  command
      .add_option("--state", options.state,
                  "Directory in which devices keep EEPROM content, parameters and firmware")
      ->check(names(Names::directory));
  command.add_flag("--no-emergencies", options.no_emergencies,
                   "Devices send no CoE emergencies, for masters that cannot take any");
  auto* http = command.add_option(
      "--http", options.web.http,
      "[ADDRESS:]PORT of a web server with REST, signals and metrics; without ADDRESS this machine "
      "only");
  command
      .add_option("--http-token", options.web.token_file,
                  "File with the token that writes need, and from other machines all access")
      ->check(names(Names::file))
      ->needs(http);
  command.footer(
      "Examples:\n"
      "  stator run racks/gantry.toml --link ethercat:eth1\n"
      "  stator run --device tmcm-3315 --link ethercat:eth1 --wait spin --cpu 1\n"
      "  stator run --device tmcm-3315 --link udp:0.0.0.0\n"
      "  stator run racks/five-devices.toml --http 8080\n"
      "  stator run --device tmcc160 --port slcan:/tmp/stator-can0 --port socketcand:29536\n"
      "  stator run --device tmcm-142 --serial pty:/tmp/stator-serial\n"
      "  stator run --device tmc8461 --link ethercat:eth1 --spi unix:/tmp/stator-chip\n"
      "  stator run --device tmcm-3315 --link ethercat:eth1 --record run.csv --signals "
      "\"*.axis0.*\"");
}

}  // namespace stator::cli
