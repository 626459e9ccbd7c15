#include "rack/event_log.hpp"

#include <utility>

#include <fmt/format.h>
#include <spdlog/logger.h>

namespace stator::rack {

namespace {

spdlog::level::level_enum level_of(base::Severity severity) {
  switch (severity) {
    case base::Severity::information:
      return spdlog::level::info;
    case base::Severity::refusal:
    case base::Severity::warning:
      return spdlog::level::warn;
    case base::Severity::fault:
      return spdlog::level::err;
  }
  return spdlog::level::info;
}

}  // namespace

EventLog::EventLog(std::shared_ptr<spdlog::logger> logger) : logger_(std::move(logger)) {}

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
  if (logger_ != nullptr) {
    logger_->log(level_of(event.rule->severity), "{:12.6f} s  {}", event.time.seconds(),
                 line(event));
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
