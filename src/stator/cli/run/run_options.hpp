#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stator/cli/run/web_server.hpp"
#include "stator/rack/core/rack_configuration.hpp"

namespace CLI {
class App;
}

namespace stator::cli {

/// What "stator run" is asked for on the command line.
struct RunOptions {
  std::string rack_file;
  std::vector<std::string> changes;  ///< of the rack file, PATH=VALUE
  std::string device;
  unsigned count = 1;
  std::string link;
  std::vector<std::string> ports;
  std::vector<std::string> serial;
  std::string spi;
  std::string bit_rate;
  std::string redundant;
  std::string wait;
  std::optional<unsigned> cpu;
  std::optional<int> priority;
  std::string clock;
  std::string capture;
  std::string record;   ///< a table of signals, or a recording of everything if is_session()
  std::string restore;  ///< place in such a recording from which to go on
  std::string record_period;
  std::vector<std::string> signals;
  std::string trace;
  std::vector<std::string> trace_pins;
  std::string duration;
  std::string state;
  bool no_emergencies = false;
  bool needs_links = true;  ///< false: a program built the rack, whose masters are inside
  bool keeps_state = true;  ///< false: devices keep nothing in files, whatever the rack file says
  bool show = false;        ///< devices do something worth seeing, see Show
  WebOptions web;
};

/// `path` is that of a recording of everything, not of a table of signals.
[[nodiscard]] bool is_session(const std::string& path);

/// Adds the options of "stator run" to `command`; `options` must outlive it.
void add_run_options(CLI::App& command, RunOptions& options);

/// The rack file's configuration with the command line's options on top. Throws Failure for options
/// that the rack has no place for, or std::runtime_error for a bad rack file.
[[nodiscard]] rack::RackConfiguration configuration_of(const RunOptions& options);

/// Runs what `options` ask for until a signal comes or their duration is over. Throws Failure or
/// std::runtime_error.
void run_until_stopped(RunOptions options);

}  // namespace stator::cli
