#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/event.hpp"

namespace spdlog {
class logger;
}

namespace stator::rack {

/// Where a rack's events go: one line each in the log, the newest kept for whoever asks, and a
/// count per rule that never forgets.
class EventLog final : public base::EventSink {
 public:
  /// How many events are kept; older ones are dropped, their counts stay.
  static constexpr std::size_t kKept = 1000;

  /// Logs through `logger`, which may be null: then events are only kept and counted.
  explicit EventLog(std::shared_ptr<spdlog::logger> logger = nullptr);

  /// Logs through another logger from now on; null: through none.
  void set_logger(std::shared_ptr<spdlog::logger> logger) { logger_ = std::move(logger); }

  /// Names the devices by their position, for the log lines.
  void set_device_names(std::vector<std::string> names) { device_names_ = std::move(names); }

  void on_event(const base::Event& event) override;

  /// The newest events, oldest first.
  [[nodiscard]] const std::deque<base::Event>& events() const { return events_; }
  /// How many events there were since the rack started: the number of the newest, counted from 1.
  [[nodiscard]] std::uint64_t total() const { return total_; }
  /// Of the device or bus that raised it.
  [[nodiscard]] std::string device_name(const base::Event& event) const;
  /// How often `rule_id` was raised since the rack started.
  [[nodiscard]] std::uint64_t count(std::string_view rule_id) const;

  /// "gantry: SafeOp refused: ...": the line an event makes, without its time.
  [[nodiscard]] std::string line(const base::Event& event) const;

 private:
  std::shared_ptr<spdlog::logger> logger_;
  std::vector<std::string> device_names_;
  std::deque<base::Event> events_;
  std::map<std::string_view, std::uint64_t> counts_;
  std::uint64_t total_ = 0;
};

}  // namespace stator::rack
