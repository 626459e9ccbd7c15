#include "rack/event_log.hpp"

#include <gtest/gtest.h>

namespace stator::rack {
namespace {

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

}  // namespace
}  // namespace stator::rack
