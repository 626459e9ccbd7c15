// Wiring that a board refuses, conflicts of levels on a line, and results that do not depend on the
// steps of time.
#include <set>

#include <gtest/gtest.h>

#include "board/bench.hpp"

namespace stator::board {
namespace {

TEST(Board, RefusesWhatCannotBeWired) {
  const auto refusal = [](std::vector<PeripheralConfiguration> parts) {
    try {
      Bench bench(std::move(parts));
    } catch (const BoardError& error) {
      return error.peripheral() + ": " + error.what();
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refusal({part("s", kSwitch, {})}), "s: its pin \"line\" is wired to no line");
  EXPECT_EQ(refusal({part("s", kLed, {{"line", 1}}), part("s", kLed, {{"line", 2}})}),
            "s: another peripheral has that name");
  EXPECT_EQ(refusal({part("e", kEncoder, {{"a", 1}, {"b", 2}})}),
            "e: \"shaft\" must name a peripheral");
  EXPECT_THROW(part("s", kLed, {{"line", 24}}), std::invalid_argument);
  EXPECT_THROW(part("s", kLed, {{"lamp", 1}}), std::invalid_argument);
  EXPECT_THROW(part("s", kLed, {{"line", 1}}, {{"active_low", 2}}), std::invalid_argument);
}

TEST(Board, LetsLowWinAndCountsConflicts) {
  Bench bench({part("one", kSwitch, {{"line", 7}}), part("two", kSwitch, {{"line", 7}})});
  EXPECT_EQ(bench.board.conflicts(), 0U);
  bench.input("one.closed", 1.0);
  EXPECT_FALSE(bench.pins.level(7));
  EXPECT_GT(bench.board.conflicts(), 0U);
  bench.input("two.closed", 1.0);
  EXPECT_TRUE(bench.pins.level(7));
}

TEST(Board, IsTheSameWhateverTheStepsOfTime) {
  const auto run = [](base::SimDuration step) {
    Bench bench({part("motor", kStepDirMotor, {{"step", 8}, {"dir", 9}}, {{"microsteps", 8}}),
                 part("encoder", kEncoder, {{"a", 10}, {"b", 11}}, {}, {{"shaft", "motor"}}),
                 part("s", kSwitch, {{"line", 7}}, {{"bounce_time", 3000}})});
    for (int k = 0; k < 400; ++k) {
      bench.pins.at(base::SimTime(base::SimDuration(300'000 * k)), 8, true);
      bench.pins.at(base::SimTime(base::SimDuration(300'000 * k + 7'000)), 8, false);
    }
    bench.input("s.closed", 1.0);
    while (bench.board.time() < base::SimTime(150_ms)) {
      bench.wait(step);
    }
    std::vector<std::int64_t> times;
    for (const Line line : {Line{7}, Line{10}, Line{11}}) {
      for (const auto& edge : bench.pins.edges(line)) {
        times.push_back(edge.time.nanoseconds());
      }
    }
    return times;
  };
  const auto at_once = run(150_ms);
  EXPECT_GT(at_once.size(), 500U);
  EXPECT_EQ(at_once, run(50'000_ns));
  EXPECT_EQ(at_once, run(1'500'000_ns));
  EXPECT_EQ(at_once, run(12'500_ns));
}

TEST(PeripheralTypes, AreDeclaredSoundly) {
  std::set<std::string_view> names;
  for (const PeripheralType* type : peripheral_types()) {
    EXPECT_TRUE(names.insert(type->name).second) << type->name;
    EXPECT_EQ(find_peripheral_type(type->name), type);
    EXPECT_FALSE(type->summary.empty());
    for (const ParameterDeclaration& parameter : type->parameters) {
      if (!parameter.is_text) {
        EXPECT_LE(parameter.minimum, parameter.value) << type->name << " " << parameter.name;
        EXPECT_GE(parameter.maximum, parameter.value) << type->name << " " << parameter.name;
      }
    }
  }
  EXPECT_EQ(names.size(), 18U);
  EXPECT_EQ(find_peripheral_type("toaster"), nullptr);
}

}  // namespace
}  // namespace stator::board
