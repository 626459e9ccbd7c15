#include "stator/web/stream/signal_stream.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/settings/words.hpp"
#include "stator/web/json_text.hpp"
#include "stator/web/problem.hpp"
#include "stator/web/stream/sample_batch.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr base::SimDuration kLongestPeriod{10 * kSecond};
constexpr std::size_t kMostPatterns = 64;
/// Values in one message at most.
constexpr std::size_t kValuesPerMessage = 4096;

std::vector<product::Signal> tapped(const State& state, const Subscription& subscription) {
  std::vector<product::Signal> signals;
  signals.reserve(subscription.signals.size());
  for (const std::size_t i : subscription.signals) {
    signals.push_back(state.signals()[i]);
  }
  return signals;
}

/// Room for half a second, so that the server's thread may be late.
std::size_t rows_of(base::SimDuration period) {
  constexpr std::int64_t kHalfSecond = kSecond / 2;
  return static_cast<std::size_t>(
      std::clamp<std::int64_t>(kHalfSecond / period.nanoseconds(), 16, 10'000));
}

}  // namespace

std::int64_t Subscription::values_per_second() const {
  return signals.empty() ? 0
                         : static_cast<std::int64_t>(signals.size()) * kSecond /
                               std::max<std::int64_t>(period.nanoseconds(), 1);
}

std::variant<Subscription, Response> parse_subscription(std::string_view text, const State& state,
                                                        std::int64_t values_left) {
  const Json message = Json::parse(text, nullptr, false);
  const char* const form =
      R"(write e.g. {"signals": ["gantry.axis0.*"], "period": "1ms"}; no signals end the stream)";
  if (!message.is_object() || !message.contains("signals") || !message["signals"].is_array() ||
      message["signals"].size() > kMostPatterns) {
    return problem(400, form);
  }
  const Json format = message.value("format", Json("json"));
  if (format != "json" && format != "binary") {
    return problem(422, R"("format" of samples is "json" or "binary")");
  }
  const Json events = message.value("events", Json(false));
  if (!events.is_boolean()) {
    return problem(422, R"("events" is true or false)");
  }
  std::string patterns;
  for (const Json& pattern : message["signals"]) {
    if (!pattern.is_string()) {
      return problem(400, form);
    }
    const auto& name = pattern.get_ref<const std::string&>();
    if (state.matching(name).empty()) {
      return problem(404,
                     fmt::format(R"(no signal matches "{}"; /api/v1/signals lists all)", name));
    }
    patterns += (patterns.empty() ? "" : ",") + name;
  }
  Subscription subscription{.signals = state.matching(patterns),
                            .binary = format == "binary",
                            .events = events.get<bool>()};
  if (subscription.signals.empty()) {
    return subscription;
  }
  if (subscription.signals.size() > kMostSignals) {
    return problem(422, fmt::format("a stream has {} signals at most, not {}", kMostSignals,
                                    subscription.signals.size()));
  }
  const Json period = message.value("period", Json("10ms"));
  const auto duration = period.is_string()
                            ? settings::parse_duration(period.get_ref<const std::string&>())
                            : std::nullopt;
  if (!duration || *duration < kShortestPeriod || *duration > kLongestPeriod ||
      *duration % kShortestPeriod != base::SimDuration(0)) {
    return problem(422, R"("period" is a multiple of 50us, 10s at most, e.g. "1ms")");
  }
  subscription.period = *duration;
  if (subscription.values_per_second() > values_left) {
    return problem(
        422, fmt::format("{} values per second are too many, {} are left of {} for all "
                         "streams; take fewer signals or a longer period",
                         subscription.values_per_second(), values_left, kMostValuesPerSecond));
  }
  return subscription;
}

TapTask::TapTask(const State& state, const Subscription& subscription)
    : tap_(tapped(state, subscription), subscription.period, rows_of(subscription.period)) {}

bool TapTask::act(rack::Rack& rack, base::SimTime now) {
  if (inside_) {
    rack.remove(tap_);
  } else {
    rack.add(tap_, now);
  }
  inside_ = !inside_;
  return true;
}

void StreamQueue::push_subscribed(const State& state, const Subscription& subscription) {
  binary_ = subscription.binary;
  if (!subscription.events) {
    newest_event_.reset();
  } else if (!newest_event_) {
    newest_event_ = state.events().empty() ? 0 : state.events().back().number;
  }
  Json signals = Json::array();
  for (const std::size_t i : subscription.signals) {
    signals.push_back({{"name", state.signals()[i].name}, {"unit", state.signals()[i].unit}});
  }
  push({text_of({{"type", "subscribed"},
                 {"period_ns", subscription.period.nanoseconds()},
                 {"format", subscription.binary ? "binary" : "json"},
                 {"events", subscription.events},
                 {"signals", signals}})});
}

void StreamQueue::push_problem(const Response& problem) {
  push({fmt::format(R"({{"type":"problem","problem":{}}})", problem.body)});
}

void StreamQueue::collect(rack::SignalTap& tap) {
  const std::uint64_t lost = tap.lost();
  counters_.stream_rows_dropped += lost - std::exchange(tap_lost_, lost);
  const std::size_t at_once = std::max<std::size_t>(1, kValuesPerMessage / tap.signals().size());
  for (std::size_t waiting = tap.size(); waiting > 0;) {
    const std::size_t rows = std::min(waiting, at_once);
    push(batch(tap, rows));
    tap.release(rows);
    waiting -= rows;
  }
}

void StreamQueue::collect_events(const State& state) {
  if (!newest_event_ || state.events().empty() || state.events().back().number <= *newest_event_) {
    return;
  }
  Json events = Json::array();
  for (const EventRecord& event : state.events()) {
    if (event.number > *newest_event_) {
      events.push_back(to_json(event));
    }
  }
  newest_event_ = state.events().back().number;
  push({text_of({{"type", "events"}, {"events", std::move(events)}})});
}

std::string StreamQueue::take() {
  MessageQueue::Message message = messages_.take();
  counters_.stream_rows_sent += message.rows;
  return std::move(message.text);
}

void StreamQueue::forget_tap() {
  dropped_ += std::exchange(tap_lost_, 0);
}

void StreamQueue::push(MessageQueue::Message message) {
  const std::size_t dropped = messages_.push(std::move(message));
  dropped_ += dropped;
  counters_.stream_rows_dropped += dropped;
}

MessageQueue::Message StreamQueue::batch(const rack::SignalTap& tap, std::size_t rows) const {
  if (binary_) {
    return {.text = sample_batch(tap, rows, dropped()), .rows = rows, .binary = true};
  }
  MessageQueue::Message message{
      .text = fmt::format(R"({{"type":"samples","dropped":{},"time_ns":[)", dropped()),
      .rows = rows};
  const auto out = std::back_inserter(message.text);
  for (std::size_t row = 0; row < rows; ++row) {
    fmt::format_to(out, "{}{}", row == 0 ? "" : ",", tap.time(row).nanoseconds());
  }
  message.text += "],\"values\":[";
  for (std::size_t signal = 0; signal < tap.signals().size(); ++signal) {
    message.text += signal == 0 ? "[" : ",[";
    for (std::size_t row = 0; row < rows; ++row) {
      const double value = tap.values(row)[signal];
      message.text += row == 0 ? "" : ",";
      if (std::isfinite(value)) {
        fmt::format_to(out, "{}", value);
      } else {
        message.text += "null";
      }
    }
    message.text += ']';
  }
  message.text += "]}";
  return message;
}

}  // namespace stator::web
