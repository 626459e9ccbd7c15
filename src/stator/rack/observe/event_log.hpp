#pragma once

#include <algorithm>
#include <atomic>
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

#include "stator/base/event.hpp"
#include "stator/rack/observe/inheriting_mutex.hpp"
#include "stator/rack/observe/log.hpp"

namespace stator::rack {

/// Where a rack's events go: one line each in the log, the newest kept for whoever asks, and a
/// count per rule that never forgets. Takes events from any thread: links raise some while nobody
/// holds the rack.
///
/// Equal events of one device, with the same rule and the same arguments, have one line in each
/// second of simulated time and after it a line that says how many more there were. That is so in
/// the log only: kept and counted are all.
class EventLog final : public base::EventSink {
 public:
  /// How many events are kept; older ones are dropped, their counts stay.
  static constexpr std::size_t kKept = 1000;

  /// Logs through `logger`, which may be null: then events are only kept and counted.
  explicit EventLog(std::shared_ptr<Log> logger = nullptr);
  EventLog(const EventLog&) = delete;
  EventLog& operator=(const EventLog&) = delete;
  /// Logs what was counted and not told yet.
  ~EventLog() override;

  /// Logs through another logger from now on; null: through none.
  void set_logger(std::shared_ptr<Log> logger) { logger_ = std::move(logger); }

  /// Names the devices by their position, for the log lines.
  void set_device_names(std::vector<std::string> names) { device_names_ = std::move(names); }

  void on_event(const base::Event& event) override;
  /// Nothing has happened until `now`: logs how many equal events there were in seconds that are
  /// over. Cheap when there were none.
  void settle(base::SimTime now);

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
  /// An event that has its line, and those like it in the second after.
  struct Recent {
    base::Event newest;
    base::SimTime begin;     ///< of the second
    std::uint64_t more = 0;  ///< without a line
  };
  /// How many different events are looked after; the oldest gives way.
  static constexpr std::size_t kRecent = 32;

  void log(const base::Event& event) const;
  void log_repetitions(const Recent& recent) const;
  void settle_all(base::SimTime now);

  mutable InheritingMutex mutex_;  ///< of all below but the names
  std::shared_ptr<Log> logger_;
  std::vector<std::string> device_names_;
  std::deque<base::Event> events_;
  std::map<std::string_view, std::uint64_t> counts_;
  std::uint64_t total_ = 0;
  std::vector<Recent> recent_;
  std::atomic<bool> repeated_ = false;  ///< some of them have more
};

}  // namespace stator::rack
