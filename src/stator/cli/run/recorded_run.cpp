#include "stator/cli/run/recorded_run.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/settings/words.hpp"

namespace stator::cli {

namespace {

/// Events that are shown beside a difference.
constexpr std::size_t kEventsShown = 5;

void forget_files(rack::RackConfiguration& configuration) {
  configuration.record.reset();
  configuration.trace.reset();
  for (rack::SegmentConfiguration& segment : configuration.segments) {
    segment.capture.clear();
  }
  for (rack::BusConfiguration& bus : configuration.buses) {
    bus.log.clear();
    bus.capture.clear();
  }
}

RunOptions options_in(const std::string& path, const replay::RecordingHeader& header,
                      const std::filesystem::path& folder, const std::filesystem::path& state) {
  try {
    return options_of(header, folder, state);
  } catch (const std::runtime_error& error) {
    throw Failure(fmt::format("{}: its files cannot be laid out: {}", path, error.what()));
  }
}

rack::RackConfiguration configuration_in(const std::string& path, const RunOptions& options) {
  try {
    return configuration_of(options);
  } catch (const std::runtime_error& error) {
    throw Failure(fmt::format("{}: its rack cannot be built: {}", path, error.what()));
  }
}

}  // namespace

RecordedRack::RecordedRack(const std::string& path, const std::filesystem::path& state)
    : reader_(path),
      options_(options_in(path, reader_.header(), folder_.path(),
                          state.empty() ? folder_.path() / "kept" : state)),
      configuration_(configuration_in(path, options_)) {
  forget_files(configuration_);
}

RecordingPlace parse_place(const std::string& text) {
  const std::size_t sign = text.rfind('@');
  if (sign == std::string::npos || std::filesystem::exists(text)) {
    return {.path = text};
  }
  RecordingPlace place{.path = text.substr(0, sign)};
  const std::string rest = text.substr(sign + 1);
  if (const auto time = settings::parse_duration(rest)) {
    place.time = base::SimTime(*time);
  } else {
    place.mark = rest;
  }
  return place;
}

std::string explain(const replay::Difference& difference, const rack::EventLog& log) {
  std::string text = fmt::format(
      "the first difference is at {:.9f} s, step {}, {}:\n  recorded: {}\n  now:      {}",
      difference.time.seconds(), difference.step, difference.place, difference.expected,
      difference.got);
  const auto& events = log.events();
  const std::size_t shown = std::min(events.size(), kEventsShown);
  for (std::size_t i = events.size() - shown; i < events.size(); ++i) {
    text += fmt::format("\n  before:   {:.6f} s {}", events[i].time.seconds(), log.line(events[i]));
  }
  return text;
}

}  // namespace stator::cli
