// Streams of signals: rows that become messages, slow clients, events beside samples.
#include "stator/web/stream/signal_stream.hpp"

#include <cmath>
#include <limits>
#include <span>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stator/base/byte_order.hpp"
#include "stator/web/stream/sample_batch.hpp"
#include "web/served_rack.hpp"

namespace stator::web {
namespace {

using namespace base::literals;

struct Ramp {
  mutable double value = 0.0;  ///< rises with each reading
  [[nodiscard]] double read() const { return value++; }
};

class StreamQueueTest : public testing::Test {
 protected:
  StreamQueueTest() { tap.begin({}); }
  void sample(std::size_t rows) {
    for (std::size_t i = 0; i < rows; ++i) {
      tap.sample(tap.next_sample());
    }
  }

  Ramp ramp;
  rack::SignalTap tap{{{"ramp", "rev", base::SignalReader::bind<&Ramp::read>(ramp)}}, 1_ms, 4096};
  ServerCounters counters;
  StreamQueue queue{counters};
};

TEST_F(StreamQueueTest, MakesMessagesOfRows) {
  sample(3);
  queue.collect(tap);
  const auto message = nlohmann::json::parse(queue.take());
  EXPECT_EQ(message["type"], "samples");
  EXPECT_EQ(message["dropped"], 0);
  EXPECT_EQ(message["time_ns"], (nlohmann::json{0, 1'000'000, 2'000'000}));
  EXPECT_EQ(message["values"], (nlohmann::json{{0.0, 1.0, 2.0}}));
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.bytes(), 0U);
  EXPECT_EQ(counters.stream_rows_sent, 3U);
}

TEST_F(StreamQueueTest, DropsTheOldestOfASlowClientAndCountsThem) {
  std::uint64_t rows = 0;
  while (queue.dropped() == 0) {
    sample(4096);
    rows += 4096;
    queue.collect(tap);
    ASSERT_LE(queue.bytes(), StreamQueue::kMostBytes);
    ASSERT_LT(rows, 10'000'000U) << "grows without end";
  }
  EXPECT_EQ(counters.stream_rows_dropped, queue.dropped());
  sample(1);
  queue.collect(tap);
  std::uint64_t told = 0;
  std::uint64_t got = 0;
  double last = -1;
  while (!queue.empty()) {
    const auto message = nlohmann::json::parse(queue.take());
    told = message["dropped"];
    got += message["time_ns"].size();
    EXPECT_GT(message["values"][0][0], last) << "not in order";
    last = message["values"][0].back();
  }
  EXPECT_EQ(last, static_cast<double>(rows)) << "the newest is kept";
  EXPECT_EQ(told, queue.dropped());
  EXPECT_EQ(got + told, rows + 1);
}

TEST_F(StreamQueueTest, CountsRowsThatTheTapLost) {
  sample(5000);
  queue.collect(tap);
  EXPECT_EQ(queue.dropped(), 5000U - 4096U);
  EXPECT_EQ(counters.stream_rows_dropped, 5000U - 4096U);
  queue.forget_tap();
  EXPECT_EQ(queue.dropped(), 5000U - 4096U);
}

TEST(SampleBatch, HasTimesAndColumnsWhereTheHeaderSays) {
  Ramp ramp;
  Ramp other{.value = std::numeric_limits<double>::quiet_NaN()};
  rack::SignalTap tap({{"ramp", "rev", base::SignalReader::bind<&Ramp::read>(ramp)},
                       {"gap", "", base::SignalReader::bind<&Ramp::read>(other)}},
                      50_us, 8);
  tap.begin({});
  for (int i = 0; i < 3; ++i) {
    tap.sample(tap.next_sample());
  }
  tap.release(1);
  const std::string message = sample_batch(tap, 2, 7);
  const auto bytes = std::as_bytes(std::span(message));
  ASSERT_EQ(message.size(), 24U + 3U * 2U * 8U);
  EXPECT_EQ(message.substr(0, 4), "SSB1");
  EXPECT_EQ(base::load_le<std::uint32_t>(bytes, 4), 24U);
  EXPECT_EQ(base::load_le<std::uint32_t>(bytes, 8), 2U);
  EXPECT_EQ(base::load_le<std::uint32_t>(bytes, 12), 2U);
  EXPECT_EQ(base::load_le<std::uint64_t>(bytes, 16), 7U);
  EXPECT_EQ(base::load_le<std::int64_t>(bytes, 24), 50'000);
  EXPECT_EQ(base::load_le<std::int64_t>(bytes, 32), 100'000);
  EXPECT_EQ(base::load_le<double>(bytes, 40), 1.0);
  EXPECT_EQ(base::load_le<double>(bytes, 48), 2.0);
  EXPECT_TRUE(std::isnan(base::load_le<double>(bytes, 56)));
}

// A rack, since a subscription names its signals.
class SubscriptionTest : public testing::Test {
 protected:
  SubscriptionTest()
      : configuration(ServedRack::configuration(rack::ClockKind::lockstep, {})),
        rack(configuration, log),
        runner(rack, configuration, nullptr),
        state(rack, configuration, log, runner) {}

  std::variant<Subscription, Response> parse(const std::string& text) {
    return parse_subscription(text, state, kMostValuesPerSecond);
  }

  rack::RackConfiguration configuration;
  rack::EventLog log;
  rack::Rack rack;
  rack::Runner runner;
  State state;
};

TEST_F(SubscriptionTest, IsTextWithoutEventsUnlessAskedOtherwise) {
  const auto plain = parse(R"({"signals": ["drive.axis0.torque"]})");
  EXPECT_FALSE(std::get<Subscription>(plain).binary);
  EXPECT_FALSE(std::get<Subscription>(plain).events);
  const auto asked =
      parse(R"({"signals": ["drive.axis0.torque"], "format": "binary", "events": true})");
  EXPECT_TRUE(std::get<Subscription>(asked).binary);
  EXPECT_TRUE(std::get<Subscription>(asked).events);
  EXPECT_EQ(std::get<Response>(parse(R"({"signals": [], "format": "xml"})")).status, 422U);
  EXPECT_EQ(std::get<Response>(parse(R"({"signals": [], "format": 1})")).status, 422U);
  EXPECT_EQ(std::get<Response>(parse(R"({"signals": [], "events": 1})")).status, 422U);
}

TEST_F(SubscriptionTest, GetsTheEventsThatComeAfterItOnce) {
  static constexpr base::EventRule kRule{
      .id = "test", .severity = base::Severity::fault, .text = "it broke"};
  ServerCounters counters;
  StreamQueue queue(counters);
  const auto raise = [this](std::uint64_t number) {
    state.take_event(number, {.time = base::SimTime{} + 7_ms, .rule = &kRule});
  };
  raise(1);
  queue.push_subscribed(state, {.signals = {}, .events = true});
  EXPECT_EQ(nlohmann::json::parse(queue.take())["events"], true);
  queue.collect_events(state);
  EXPECT_TRUE(queue.empty()) << "what was before";
  raise(2);
  raise(3);
  queue.collect_events(state);
  const auto message = nlohmann::json::parse(queue.take());
  EXPECT_EQ(message["type"], "events");
  ASSERT_EQ(message["events"].size(), 2U);
  EXPECT_EQ(message["events"][0]["number"], 2);
  EXPECT_EQ(message["events"][0]["time_ns"], 7'000'000);
  EXPECT_EQ(message["events"][0]["severity"], "fault");
  queue.collect_events(state);
  EXPECT_TRUE(queue.empty());
  queue.push_subscribed(state, {});
  EXPECT_FALSE(queue.take().empty());
  raise(4);
  queue.collect_events(state);
  EXPECT_TRUE(queue.empty()) << "no longer wanted";
}

TEST_F(SubscriptionTest, AndItsEventsOutliveSamplesThatGiveWay) {
  static constexpr base::EventRule kRule{
      .id = "test", .severity = base::Severity::fault, .text = "it broke"};
  Ramp ramp;
  rack::SignalTap tap({{"ramp", "rev", base::SignalReader::bind<&Ramp::read>(ramp)}}, 1_ms, 4096);
  tap.begin({});
  ServerCounters counters;
  StreamQueue queue(counters);
  queue.push_subscribed(state, {.signals = {}, .binary = true, .events = true});
  state.take_event(1, {.time = {}, .rule = &kRule});
  queue.collect_events(state);
  while (queue.dropped() < 100'000) {
    for (int i = 0; i < 4096; ++i) {
      tap.sample(tap.next_sample());
    }
    queue.collect(tap);
  }
  EXPECT_FALSE(queue.front_is_binary());
  EXPECT_EQ(nlohmann::json::parse(queue.take())["type"], "subscribed");
  EXPECT_EQ(nlohmann::json::parse(queue.take())["type"], "events");
  EXPECT_TRUE(queue.front_is_binary());
}

}  // namespace
}  // namespace stator::web
