#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/event.hpp"
#include "rack/inheriting_mutex.hpp"

namespace spdlog {
class logger;
}

namespace stator::rack {

/// Where a rack's events go: one line each in the log, the newest kept for whoever asks, and a
/// count per rule that never forgets. Takes events from any thread: links raise some while nobody
/// holds the rack.
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

  /// The newest events, oldest first; only while nobody raises any.
  [[nodiscard]] const std::deque<base::Event>& events() const { return events_; }
  /// Calls `look(number, event)` for the kept events with a higher number than `after`, the oldest
  /// first, until it returns false. Safe while others raise events, which wait meanwhile.
  template <typename Look>
  void visit(std::uint64_t after, Look look) const {
    const std::scoped_lock lock(mutex_);
    const std::uint64_t before = total_ - events_.size();
    for (std::uint64_t i = std::max(after, before); i < total_; ++i) {
      if (!look(i + 1, events_[i - before])) {
        return;
      }
    }
  }
  /// How many events there were since the rack started: the number of the newest, counted from 1.
  [[nodiscard]] std::uint64_t total() const {
    const std::scoped_lock lock(mutex_);
    return total_;
  }
  /// Of the device or bus that raised it.
  [[nodiscard]] std::string device_name(const base::Event& event) const;
  /// How often `rule_id` was raised since the rack started.
  [[nodiscard]] std::uint64_t count(std::string_view rule_id) const;

  /// "gantry: SafeOp refused: ...": the line an event makes, without its time.
  [[nodiscard]] std::string line(const base::Event& event) const;

 private:
  mutable InheritingMutex mutex_;  ///< of all below but the names
  std::shared_ptr<spdlog::logger> logger_;
  std::vector<std::string> device_names_;
  std::deque<base::Event> events_;
  std::map<std::string_view, std::uint64_t> counts_;
  std::uint64_t total_ = 0;
};

}  // namespace stator::rack
