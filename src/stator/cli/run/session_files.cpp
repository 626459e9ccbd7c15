#include "stator/cli/run/session_files.hpp"

#include <charconv>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/cli/program_version.hpp"
#include "stator/replay/recorded_files.hpp"

namespace stator::cli {

namespace {

namespace fs = std::filesystem;
using replay::RecordingHeader;

/// The options that decide what a rack does, in both directions.
template <typename Options, typename Text, typename List>
void for_each_option(Options& options, const Text& text, const List& list) {
  text("device", options.device);
  text("link", options.link);
  text("spi", options.spi);
  text("bit-rate", options.bit_rate);
  text("redundant", options.redundant);
  text("clock", options.clock);
  list("port", options.ports);
  list("serial", options.serial);
  list("set", options.changes);
}

}  // namespace

RecordingHeader header_of(const RunOptions& options, const rack::RackConfiguration& configuration) {
  RecordingHeader header;
  header.program = program_version();
  const auto keep = [&header](const char* name, const std::string& value) {
    if (!value.empty()) {
      header.options.emplace_back(name, value);
    }
  };
  for_each_option(options, keep, [&](const char* name, const std::vector<std::string>& values) {
    for (const std::string& value : values) {
      keep(name, value);
    }
  });
  keep("count", std::to_string(options.count));
  keep("no-emergencies", options.no_emergencies ? "true" : "");
  if (!options.rack_file.empty()) {
    replay::keep_rack(options.rack_file, configuration.named_files, header);
  } else if (!configuration.named_files.empty()) {
    throw Failure(fmt::format(
        "a recording keeps the files that a rack file names, and \"{}\" stands in a --set of a "
        "device without one; write a rack file with the device to record it",
        configuration.named_files.front()));
  }
  if (!configuration.state.empty()) {
    replay::keep_state(configuration.state, header);
  } else if (!options.keeps_state) {
    keep(replay::kStateOption, replay::kStateNone);
  }
  return header;
}

RunOptions options_of(const RecordingHeader& header, const fs::path& folder,
                      const fs::path& state) {
  RunOptions options;
  for_each_option(
      options, [&header](const char* name, std::string& value) { value = header.option(name); },
      [&header](const char* name, std::vector<std::string>& values) {
        for (const auto& [key, value] : header.options) {
          if (key == name) {
            values.push_back(value);
          }
        }
      });
  const std::string_view count = header.option("count");
  std::from_chars(count.data(), count.data() + count.size(), options.count);
  options.no_emergencies = !header.option("no-emergencies").empty();
  options.needs_links = header.option(replay::kBuilderOption) != replay::kProgram;
  options.keeps_state = header.option(replay::kStateOption) != replay::kStateNone;
  options.rack_file = replay::lay_out(header, folder, state);
  if (header.option(replay::kStateOption) == replay::kStateKept) {
    options.state = state.string();
    std::error_code error;
    fs::create_directories(state, error);
  }
  return options;
}

}  // namespace stator::cli
