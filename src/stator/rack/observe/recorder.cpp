#include "stator/rack/observe/recorder.hpp"

#include <iterator>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/base/name_pattern.hpp"

namespace stator::rack {

Recorder::Recorder(const std::string& path, std::vector<product::Signal> signals,
                   base::SimDuration period)
    : signals_(std::move(signals)), period_(period) {
  if (signals_.empty()) {
    throw std::runtime_error(
        fmt::format("recording to {}: no signal is chosen; name at least one, e.g. \"*\"", path));
  }
  if (period <= base::SimDuration(0)) {
    throw std::runtime_error(
        fmt::format("recording to {}: the sampling period must be longer than 0", path));
  }
  row_ = "time [s]";
  for (const product::Signal& signal : signals_) {
    fmt::format_to(std::back_inserter(row_), ",{} [{}]", signal.name, signal.unit);
  }
  row_ += '\n';
  auto output = link::BackgroundOutput::create(path, std::as_bytes(std::span(row_)));
  if (!output) {
    throw std::runtime_error("recording: " + output.error().text +
                             "; choose a file in a directory that exists and can be written");
  }
  output_ = std::move(*output);
}

void Recorder::sample(base::SimTime now) {
  row_.clear();
  // Integer arithmetic: a time such as 0.3 s stays "0.300000000" however long the run is.
  const std::int64_t nanoseconds = now.nanoseconds();
  fmt::format_to(std::back_inserter(row_), "{}.{:09}", nanoseconds / 1'000'000'000,
                 nanoseconds % 1'000'000'000);
  for (const product::Signal& signal : signals_) {
    fmt::format_to(std::back_inserter(row_), ",{}", signal.read());
  }
  row_ += '\n';
  output_->write(row_);
  next_sample_ = now + period_;
}

std::vector<product::Signal> select_signals(const std::vector<product::Signal>& available,
                                            const std::vector<std::string>& patterns) {
  std::vector<bool> chosen(available.size(), false);
  for (const std::string& pattern : patterns) {
    bool matched = false;
    for (std::size_t i = 0; i < available.size(); ++i) {
      if (base::matches(pattern, available[i].name)) {
        chosen[i] = true;
        matched = true;
      }
    }
    if (!matched) {
      std::string names;
      for (const product::Signal& signal : available) {
        names += "\n  " + signal.name;
      }
      throw std::runtime_error(
          fmt::format("no signal matches \"{}\"; the rack has:{}", pattern, names));
    }
  }
  std::vector<product::Signal> result;
  for (std::size_t i = 0; i < available.size(); ++i) {
    if (chosen[i]) {
      result.push_back(available[i]);
    }
  }
  return result;
}

}  // namespace stator::rack
