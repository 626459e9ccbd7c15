// The sentence that an event makes of its rule and arguments, and how a reporter passes events on.
#include "stator/base/event.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

namespace stator::base {
namespace {

std::string sentence(StaticText text, const std::array<EventArgument, 6>& arguments = {}) {
  const EventRule rule{"test-rule", Severity::refusal, text};
  return to_sentence(Event{SimTime(), &rule, 0, arguments});
}

TEST(EventSentence, NumbersAndTextsStandWhereThePlaceholdersStood) {
  EXPECT_EQ(sentence("{1} refused: SM{0} length {2}, mapping needs {3}", {2, "SafeOp", 6, 30}),
            "SafeOp refused: SM2 length 6, mapping needs 30");
}

TEST(EventSentence, OneArgumentMayBeNamedSeveralTimes) {
  EXPECT_EQ(sentence("{0} {0} {0:x2}", {15}), "15 15 0Fh");
}

TEST(EventSentence, HexadecimalHasAtLeastTheDigitsAskedFor) {
  EXPECT_EQ(sentence("{0:x4}", {0x6040}), "6040h");
  EXPECT_EQ(sentence("{0:x4}", {0x1A}), "001Ah");
  EXPECT_EQ(sentence("{0:x2}", {0x12345}), "12345h");
  EXPECT_EQ(sentence("{0:x}", {0}), "0h");
  EXPECT_EQ(sentence("{0:x8}", {std::int64_t{0xFFFC0192}}), "FFFC0192h");
}

TEST(EventSentence, NegativeNumbersKeepTheirSign) {
  EXPECT_EQ(sentence("{0}", {-5}), "-5");
  EXPECT_EQ(sentence("{0}", {std::numeric_limits<std::int64_t>::min()}), "-9223372036854775808");
  EXPECT_EQ(sentence("{0:x2}", {std::int64_t{-1}}), "FFFFFFFFFFFFFFFFh");
}

TEST(EventSentence, FixedPointNumbersHaveTheirPlaces) {
  constexpr EventRule kRule{"fixed", Severity::information, "{0:d3} {1:d3} {2:d1}"};
  EXPECT_EQ(to_sentence({{}, &kRule, 0, {1500, -25, 7}}), "1.500 -0.025 0.7");
}

TEST(EventSentence, AnArgumentNotGivenIsZero) {
  EXPECT_EQ(sentence("{5}"), "0");
}

TEST(EventSentence, AnEmptyTextIsATextAndNotAZero) {
  EXPECT_EQ(sentence("\"{0}\"", {""}), "\"\"");
}

TEST(EventSentence, MistakesInARuleStaySeen) {
  EXPECT_EQ(sentence("{6} {x} {} {0:y2} {0:x2z}", {1}), "{6} {x} {} {0:y2} {0:x2z}");
  EXPECT_EQ(sentence("{0:x4}", {"text"}), "{0:x4}");
  EXPECT_EQ(sentence("open {0", {1}), "open {0");
  EXPECT_EQ(sentence("closed } {0}", {1}), "closed } 1");
}

TEST(EventSentence, ListsAreToldNumberByNumberAndLongRowsByTheirEnds) {
  static constexpr std::array<std::int64_t, 3> kModes{-1, 0, 3};
  EXPECT_EQ(sentence("one of {1}", {0, StaticList(kModes)}), "one of -1, 0, 3");
  static constexpr std::array<std::int64_t, 7> kTypes{1, 2, 4, 5, 6, 7, 255};
  EXPECT_EQ(sentence("{0}", {StaticList(kTypes)}), "1, 2, 4 .. 7, 255");
  static constexpr std::array<std::int64_t, 1> kOne{1};
  EXPECT_EQ(sentence("{0}", {StaticList(kOne)}), "1");
  EXPECT_EQ(sentence("{0:x4}", {StaticList(kTypes)}), "{0:x4}");
}

// What an event refers to is constant or shared with it: nothing else converts.
template <typename Given>
constexpr bool kTakesNot =
    !std::is_constructible_v<EventArgument, Given> && !std::is_constructible_v<StaticText, Given>;
static_assert(kTakesNot<std::string>);
static_assert(kTakesNot<std::string&>);
static_assert(kTakesNot<std::string_view>);
static_assert(kTakesNot<const char*>);
static_assert(kTakesNot<char*>);
static_assert(kTakesNot<char (&)[8]>);
static_assert(kTakesNot<std::span<const std::int64_t>>);
static_assert(!std::is_constructible_v<StaticList, std::span<const std::int64_t>>);
static_assert(!std::is_constructible_v<StaticList, std::vector<std::int64_t>>);
static_assert(std::is_constructible_v<EventArgument, StaticText>);
static_assert(std::is_constructible_v<EventArgument, SharedText>);
static_assert(std::is_constructible_v<EventArgument, const char (&)[8]>);
// A kept event is small; numbers and constant texts cost no more than their copy.
static_assert(sizeof(EventArgument) <= 24);

TEST(EventText, SharedWithAnEventStaysWhenItsMakerHasAnother) {
  SharedText error("disk full");
  const Event first{SimTime(), nullptr, 0, {error}};
  error = SharedText("read-only");
  Event second{SimTime(), nullptr, 0, {error}};
  const Event copy = first;
  EXPECT_EQ(copy.arguments[0].text(), "disk full");
  EXPECT_EQ(second.arguments[0].text(), "read-only");
  second = first;
  EXPECT_EQ(second.arguments[0].text(), "disk full");
  EXPECT_EQ(error.str(), "read-only");
}

TEST(EventText, ArgumentsAreEqualWhenTheyTellTheSame) {
  static constexpr std::array<std::int64_t, 2> kSome{1, 2};
  static constexpr std::array<std::int64_t, 2> kOthers{1, 3};
  EXPECT_EQ(EventArgument("INIT"), EventArgument(SharedText("INIT")));
  EXPECT_NE(EventArgument("INIT"), EventArgument("OP"));
  EXPECT_EQ(EventArgument(5), EventArgument(5U));
  EXPECT_NE(EventArgument(0), EventArgument(""));
  EXPECT_NE(EventArgument(StaticList(kSome)), EventArgument(StaticList(kOthers)));
  EXPECT_NE(EventArgument(2), EventArgument(StaticList(kSome)));
}

TEST(EventSentence, AnEventWithoutARuleSaysSo) {
  EXPECT_EQ(to_sentence(Event{}), "event without a rule");
}

class KeepingSink : public EventSink {
 public:
  void on_event(const Event& event) override { last = event; }
  std::optional<Event> last;
};

constexpr EventRule kRule{"test-rule", Severity::warning, "{0}"};

TEST(EventReporter, AddsTheDeviceAndHandsTheEventOn) {
  KeepingSink sink;
  const EventReporter reporter(&sink, 3);
  reporter.report(SimTime(5_ms), kRule, {42});
  ASSERT_TRUE(sink.last.has_value());
  EXPECT_EQ(sink.last->time, SimTime(5_ms));
  EXPECT_EQ(sink.last->rule, &kRule);
  EXPECT_EQ(sink.last->device, 3);
  EXPECT_EQ(sink.last->arguments[0].number(), 42);
}

TEST(EventReporter, WithoutASinkDropsTheEvent) {
  const EventReporter reporter;
  reporter.report(SimTime(), kRule, {42});
}

}  // namespace
}  // namespace stator::base
