#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/rack/observe/signal_tap.hpp"
#include "stator/rack/run/task_queue.hpp"
#include "stator/web/message.hpp"
#include "stator/web/state.hpp"
#include "stator/web/stream/message_queue.hpp"

namespace stator::web {

/// Shortest sampling period, and signals at most of one stream.
inline constexpr base::SimDuration kShortestPeriod{50'000};
inline constexpr std::size_t kMostSignals = 256;
/// Values per simulated second that all streams together may sample: twice what an oscilloscope of
/// ten signals at 20 kHz needs.
inline constexpr std::int64_t kMostValuesPerSecond = 400'000;

/// What a client wants to see.
struct Subscription {
  std::vector<std::size_t> signals;  ///< numbers in State::signals(); none: the end of it
  base::SimDuration period{};
  bool binary = false;  ///< samples as in sample_batch.hpp, not as JSON
  bool events = false;  ///< also what the rack's devices tell

  [[nodiscard]] std::int64_t values_per_second() const;
};

/// Reads {"signals": ["gantry.axis0.*"], "period": "1ms", "format": "binary", "events": true}, of
/// which the last three may be left out, or gives the answer that says what is
/// wrong. `values_left` is what other streams leave of kMostValuesPerSecond.
[[nodiscard]] std::variant<Subscription, Response> parse_subscription(std::string_view text,
                                                                      const State& state,
                                                                      std::int64_t values_left);

/// A tap on its way into the rack and out of it again; its owner posts it for each.
class TapTask final : public rack::Act {
 public:
  TapTask(const State& state, const Subscription& subscription);

  bool act(rack::Rack& rack, base::SimTime now) override;
  [[nodiscard]] bool changes() const override { return false; }
  [[nodiscard]] rack::SignalTap& tap() { return tap_; }

 private:
  rack::SignalTap tap_;
  bool inside_ = false;
};

/// Messages that wait for a client, a megabyte at most; the oldest samples give way, and the number
/// of rows lost with them is told in each later message.
class StreamQueue {
 public:
  static constexpr std::size_t kMostBytes = MessageQueue::kMostBytes;

  explicit StreamQueue(ServerCounters& counters) : counters_(counters) {}

  /// The answer to a subscription.
  void push_subscribed(const State& state, const Subscription& subscription);
  void push_problem(const Response& problem);
  /// Turns the rows that wait in `tap` into messages.
  void collect(rack::SignalTap& tap);
  /// The events that `state` got since the last call, if the subscription asked for them.
  void collect_events(const State& state);
  [[nodiscard]] bool wants_events() const { return newest_event_.has_value(); }

  [[nodiscard]] bool empty() const { return messages_.empty(); }
  [[nodiscard]] std::size_t bytes() const { return messages_.bytes(); }
  /// The oldest message, which is on its way then: it cannot be dropped any more.
  [[nodiscard]] std::string take();
  /// It is a batch of samples in binary form; everything else is text.
  [[nodiscard]] bool front_is_binary() const { return messages_.front().binary; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_ + tap_lost_; }
  /// The tap that was collected from is no more.
  void forget_tap();

 private:
  [[nodiscard]] MessageQueue::Message batch(const rack::SignalTap& tap, std::size_t rows) const;
  void push(MessageQueue::Message message);

  ServerCounters& counters_;
  MessageQueue messages_;
  std::uint64_t dropped_ = 0;                  ///< rows
  std::uint64_t tap_lost_ = 0;                 ///< of the present tap
  bool binary_ = false;                        ///< samples of the present subscription
  std::optional<std::uint64_t> newest_event_;  ///< the number sent last; none: not subscribed
};

}  // namespace stator::web
