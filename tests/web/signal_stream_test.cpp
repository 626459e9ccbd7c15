#include "web/signal_stream.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace stator::web {
namespace {

using namespace base::literals;

struct Ramp {
  double value = 0.0;
  double read() { return value++; }
};

TEST(SignalPattern, MatchesAnyRunOfCharactersAtAStar) {
  EXPECT_TRUE(matches("*", ""));
  EXPECT_TRUE(matches("a*c", "abbc"));
  EXPECT_TRUE(matches("*.axis0.*", "gantry.axis0.position"));
  EXPECT_TRUE(matches("a*b*c", "a_b_b_c"));
  EXPECT_TRUE(matches("*ab", "aab"));
  EXPECT_FALSE(matches("a*c", "abcd"));
  EXPECT_FALSE(matches("", "a"));
  EXPECT_FALSE(matches("a", ""));
  EXPECT_FALSE(matches("abc", "ab"));
  EXPECT_FALSE(matches("a?c", "abc"));
}

class StreamQueueTest : public testing::Test {
 protected:
  StreamQueueTest() { tap.begin({}); }
  void sample(std::size_t rows) {
    for (std::size_t i = 0; i < rows; ++i) {
      tap.sample(tap.next_sample());
    }
  }

  Ramp ramp;
  rack::SignalTap tap{
      {{"ramp", "rev", base::Delegate<double()>::bind<&Ramp::read>(ramp)}}, 1_ms, 4096};
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

}  // namespace
}  // namespace stator::web
