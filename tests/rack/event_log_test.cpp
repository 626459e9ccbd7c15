// How a log writes events: names, repetitions within a second, floods.
#include "stator/rack/observe/event_log.hpp"

#include <cstdint>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rack/text_log.hpp"

namespace stator::rack {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr base::EventRule kRule{"test-rule", base::Severity::refusal,
                                "state {0} refused: {1} bytes, needs {2}"};

base::Event event(std::uint16_t device) {
  return {.time = {}, .rule = &kRule, .device = device, .arguments = {"SafeOp", 6, 30}};
}

TEST(EventLog, ALineNamesTheDeviceAndSaysTheSentence) {
  EventLog log;
  log.set_device_names({"gantry", "feeder"});
  EXPECT_EQ(log.line(event(1)), "feeder: state SafeOp refused: 6 bytes, needs 30");
}

TEST(EventLog, ADeviceWithoutANameIsNamedByItsPosition) {
  const EventLog log;
  EXPECT_EQ(log.line(event(7)), "device 7: state SafeOp refused: 6 bytes, needs 30");
}

TEST(EventLog, KeepsTheNewestAndCountsAll) {
  EventLog log;
  for (std::size_t i = 0; i < EventLog::kKept + 5; ++i) {
    base::Event raised = event(0);
    raised.time = base::SimTime(base::SimDuration(static_cast<std::int64_t>(i)));
    log.on_event(raised);
  }
  EXPECT_EQ(log.events().size(), EventLog::kKept);
  EXPECT_EQ(log.events().front().time.nanoseconds(), 5);
  EXPECT_EQ(log.count("test-rule"), EventLog::kKept + 5);
  EXPECT_EQ(log.count("another-rule"), 0U);
}

/// What a log prints.
class Printed {
 public:
  Printed() { log.set_device_names({"gantry", "feeder"}); }
  void raise(std::int64_t milliseconds, std::uint16_t device = 0, int bytes = 6) {
    log.on_event({.time = base::SimTime(base::SimDuration(milliseconds * 1'000'000)),
                  .rule = &kRule,
                  .device = device,
                  .arguments = {"SafeOp", bytes, 30}});
  }
  std::vector<std::string> take() {
    std::vector<std::string> lines;
    std::istringstream text(text_.str());
    for (std::string line; std::getline(text, line);) {
      lines.push_back(line);
    }
    text_.str({});
    return lines;
  }

 private:
  std::ostringstream text_;

 public:
  EventLog log{tests::log_to(text_)};
};

base::SimTime at(std::int64_t milliseconds) {
  return base::SimTime(base::SimDuration(milliseconds * 1'000'000));
}

TEST(EventLog, EqualEventsOfASecondAreOneLineAndTheirNumber) {
  Printed printed;
  for (int i = 0; i < 500; ++i) {
    printed.raise(i);
  }
  EXPECT_THAT(printed.take(),
              ElementsAre("    0.000000 s  gantry: state SafeOp refused: 6 bytes, needs 30"));
  printed.log.settle(at(999));
  EXPECT_THAT(printed.take(), IsEmpty());
  printed.log.settle(at(1000));
  EXPECT_THAT(printed.take(), ElementsAre("    0.499000 s  gantry: 499 more of these in the last "
                                          "second: state SafeOp refused: 6 bytes, needs 30"));
  EXPECT_EQ(printed.log.count("test-rule"), 500U) << "all are counted";
  EXPECT_EQ(printed.log.events().size(), 500U) << "and kept";
}

TEST(EventLog, AFloodHasOneLineForEachOfItsSecondsAndEndsWithIt) {
  Printed printed;
  for (int i = 0; i < 3500; ++i) {
    printed.raise(i);
  }
  printed.log.settle(at(10'000));
  EXPECT_THAT(printed.take(), SizeIs(5)) << "the first, and four numbers";
  printed.raise(20'000);
  EXPECT_THAT(printed.take(),
              ElementsAre("   20.000000 s  gantry: state SafeOp refused: 6 bytes, needs 30"));
}

TEST(EventLog, TwoRefusalsThatTakeTurnsAreBothCounted) {
  Printed printed;
  for (int i = 0; i < 100; ++i) {
    printed.raise(i, 0, 6);
    printed.raise(i, 0, 8);
  }
  printed.log.settle(at(1'200));
  EXPECT_THAT(printed.take(), ElementsAre(HasSubstr("6 bytes"), HasSubstr("8 bytes"),
                                          HasSubstr("99 more of these"), HasSubstr("99 more")));
}

TEST(EventLog, OthersAreNotKeptBackAndASingleRepetitionIsTold) {
  Printed printed;
  printed.raise(0);
  printed.raise(1, 1);
  printed.raise(2, 0, 8);
  EXPECT_THAT(printed.take(), SizeIs(3)) << "another device, other arguments";
  printed.raise(3);
  printed.raise(1'500, 1);
  EXPECT_THAT(printed.take(),
              ElementsAre("    0.003000 s  gantry: state SafeOp refused: 6 bytes, needs 30",
                          HasSubstr("1.500000 s  feeder: state SafeOp")));
}

TEST(EventLog, WhatWasCountedIsToldAtTheEnd) {
  std::ostringstream text;
  {
    EventLog log(tests::log_to(text));
    for (int i = 0; i < 10; ++i) {
      log.on_event(event(0));
    }
  }
  EXPECT_THAT(text.str(), HasSubstr("9 more of these in the last second"));
}

}  // namespace
}  // namespace stator::rack
