// That tables which describe environments are read with what is usual for plant and task, and
// refused with sentences.
#include "stator/environment/keys.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stator/settings/value.hpp"

namespace stator::environment {
namespace {

using namespace base::literals;

struct Read {
  EnvironmentSettings settings;
  std::vector<std::string> problems;
};

Read read(const settings::Table& table) {
  settings::Problems problems;
  const settings::Reading reading{.problems = problems};
  const settings::Value value(table);
  settings::Reader reader(reading, "environment", value);
  Read result{.settings = read_settings(reader), .problems = {}};
  for (const settings::Problem& problem : problems.list) {
    result.problems.push_back(problem.reason());
  }
  return result;
}

TEST(EnvironmentKeys, WithoutAnyTheVelocityOfAServoIsControlledByCurrent) {
  const Read empty = read({});
  EXPECT_TRUE(empty.problems.empty());
  EXPECT_EQ(empty.settings.plant, PlantKind::servo);
  EXPECT_EQ(empty.settings.task, Task::velocity);
  EXPECT_EQ(empty.settings.action, ActionKind::current);
  EXPECT_EQ(empty.settings.servo.load.inertia, empty.settings.servo.motor.rotor_inertia);
}

TEST(EnvironmentKeys, PlantAndTaskDecideWhatIsUsualAndOtherKeysChangeThat) {
  const Read usual = read({{"plant", "stepper"}, {"task", "torque"}});
  EXPECT_TRUE(usual.problems.empty());
  EXPECT_EQ(usual.settings.action, ActionKind::voltage);
  EXPECT_EQ(usual.settings.step, 50_us);
  const Read other = read({{"plant", "stepper"},
                           {"task", "torque"},
                           {"action", "duty"},
                           {"step", "20us"},
                           {"steps_per_action", 4},
                           {"current_limit", 1.5},
                           {"episode", "1s"}});
  EXPECT_TRUE(other.problems.empty());
  EXPECT_EQ(other.settings.action, ActionKind::duty);
  EXPECT_EQ(other.settings.step, 20_us);
  EXPECT_EQ(other.settings.steps_per_action, 4);
  EXPECT_EQ(scales_of(other.settings).current, 1.5);
  EXPECT_EQ(scales_of(other.settings).trip_current, 2.25);
}

TEST(EnvironmentKeys, TheAxisHasTheKeysOfARackFile) {
  const Read servo =
      read({{"axis", settings::Table{{"motor", "EC45-flat-70W"},
                                     {"supply_voltage", 36.0},
                                     {"motor_data", settings::Table{{"flux_linkage", 0.004}}}}}});
  EXPECT_TRUE(servo.problems.empty());
  EXPECT_EQ(servo.settings.servo.motor.pole_pairs, 8);
  EXPECT_EQ(servo.settings.servo.motor.flux_linkage, 0.004);
  EXPECT_EQ(servo.settings.servo.load.inertia, servo.settings.servo.motor.rotor_inertia)
      << "a load that is not told is as heavy as the rotor of that motor";
  const Read loaded =
      read({{"axis", settings::Table{{"load", settings::Table{{"inertia", 0.0}}}}}});
  EXPECT_EQ(loaded.settings.servo.load.inertia, 0.0);
  EXPECT_FALSE(read({{"axis", settings::Table{{"motor", "QSH6018"}}}}).problems.empty());
  EXPECT_FALSE(
      read({{"plant", "stepper"}, {"axis", settings::Table{{"motor_data", settings::Table{}}}}})
          .problems.empty());
}

TEST(EnvironmentKeys, RandomisationIsSwitchedOffOrChangedOneByOne) {
  const Read off = read({{"randomise", false}});
  EXPECT_TRUE(off.problems.empty());
  EXPECT_EQ(off.settings.randomisation.inertia.high, 1.0);
  EXPECT_EQ(off.settings.randomisation.load_torque.high, 0.0);
  const Read changed = read(
      {{"randomise", settings::Table{{"inertia", settings::Table{{"low", 1.0}, {"high", 5.0}}}}}});
  EXPECT_TRUE(changed.problems.empty());
  EXPECT_EQ(changed.settings.randomisation.inertia.high, 5.0);
  EXPECT_EQ(changed.settings.randomisation.resistance.high, 1.2);
}

TEST(EnvironmentKeys, WhatIsWrongIsRefusedWithASentence) {
  EXPECT_EQ(read({{"shortest_hold", "2s"}}).problems,
            std::vector<std::string>{R"("longest_hold" must not be below "shortest_hold")"});
  EXPECT_EQ(read({{"current_limit", 5.0}, {"trip_current", 4.0}}).problems,
            std::vector<std::string>{R"("trip_current" must not be below "current_limit")"});
  EXPECT_EQ(read({{"randomise",
                   settings::Table{{"inertia", settings::Table{{"low", 3.0}, {"high", 2.0}}}}}})
                .problems,
            std::vector<std::string>{R"("high" must not be below "low")"});
  EXPECT_EQ(read({{"frame_skip", 3}}).problems.size(), 1U);
  EXPECT_EQ(read({{"task", "flying"}}).problems.size(), 1U);
}

}  // namespace
}  // namespace stator::environment
