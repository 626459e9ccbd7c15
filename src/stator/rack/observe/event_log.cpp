#include "stator/rack/observe/event_log.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace stator::rack {

namespace {

Log::Level level_of(base::Severity severity) {
  switch (severity) {
    case base::Severity::information:
      return Log::Level::information;
    case base::Severity::refusal:
    case base::Severity::warning:
      return Log::Level::warning;
    case base::Severity::fault:
      return Log::Level::error;
  }
  return Log::Level::information;
}

constexpr base::SimDuration kSecond{1'000'000'000};

bool tells_the_same(const base::Event& a, const base::Event& b) {
  return a.rule == b.rule && a.device == b.device && a.arguments == b.arguments;
}

}  // namespace

EventLog::EventLog(std::shared_ptr<Log> logger) : logger_(std::move(logger)) {}

EventLog::~EventLog() {
  for (const Recent& recent : recent_) {
    log_repetitions(recent);
  }
}

void EventLog::on_event(const base::Event& event) {
  if (event.rule == nullptr) {
    return;
  }
  const std::scoped_lock lock(mutex_);
  ++total_;
  ++counts_[event.rule->id];
  events_.push_back(event);
  if (events_.size() > kKept) {
    events_.pop_front();
  }
  if (logger_ == nullptr) {
    return;
  }
  settle_all(event.time);
  const auto found = std::ranges::find_if(
      recent_, [&event](const Recent& recent) { return tells_the_same(recent.newest, event); });
  if (found != recent_.end()) {
    found->newest = event;
    ++found->more;
    repeated_ = true;
    return;
  }
  if (recent_.size() == kRecent) {
    log_repetitions(recent_.front());
    recent_.erase(recent_.begin());
  }
  recent_.push_back({.newest = event, .begin = event.time});
  log(event);
}

void EventLog::settle(base::SimTime now) {
  if (!repeated_) [[likely]] {
    return;
  }
  const std::scoped_lock lock(mutex_);
  settle_all(now);
}

// Events that were repeated go on being counted second by second; those that came once are
// forgotten.
void EventLog::settle_all(base::SimTime now) {
  for (Recent& recent : recent_) {
    if (now - recent.begin >= kSecond && recent.more != 0) {
      log_repetitions(recent);
      recent.more = 0;
      recent.begin = recent.newest.time;
    }
  }
  repeated_ = std::ranges::any_of(recent_, [](const Recent& recent) { return recent.more != 0; });
  std::erase_if(recent_, [now](const Recent& recent) {
    return recent.more == 0 && now - recent.begin >= kSecond;
  });
}

void EventLog::log(const base::Event& event) const {
  if (logger_ != nullptr) {
    logger_->write(level_of(event.rule->severity),
                   fmt::format("{:12.6f} s  {}", event.time.seconds(), line(event)));
  }
}

/// A single repetition is logged as the event itself, which takes a line as a count would.
void EventLog::log_repetitions(const Recent& recent) const {
  if (recent.more == 1) {
    log(recent.newest);
  } else if (recent.more != 0 && logger_ != nullptr) {
    logger_->write(level_of(recent.newest.rule->severity),
                   fmt::format("{:12.6f} s  {}: {} more of these in the last second: {}",
                               recent.newest.time.seconds(), device_name(recent.newest),
                               recent.more, base::to_sentence(recent.newest)));
  }
}

std::uint64_t EventLog::count(std::string_view rule_id) const {
  const std::scoped_lock lock(mutex_);
  const auto found = counts_.find(rule_id);
  return found == counts_.end() ? 0 : found->second;
}

std::string EventLog::device_name(const base::Event& event) const {
  return event.device < device_names_.size() ? device_names_[event.device]
                                             : fmt::format("device {}", event.device);
}

std::string EventLog::line(const base::Event& event) const {
  return device_name(event) + ": " + base::to_sentence(event);
}

}  // namespace stator::rack
