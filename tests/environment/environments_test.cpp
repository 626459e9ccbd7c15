// That axes follow actions, episodes begin and end as they should, and an axis among many has the
// bits of one alone.
#include "stator/environment/environments.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"

namespace stator::environment {
namespace {

using namespace base::literals;

/// Environments with room for what comes of a step.
class Stage {
 public:
  Stage(const EnvironmentSettings& settings, std::size_t axes,
        Autoreset autoreset = Autoreset::disabled)
      : environments(settings, axes, autoreset),
        observations(axes * environments.observation_size()),
        final_observations(observations.size()),
        rewards(axes),
        terminated(std::make_unique<bool[]>(axes)),
        truncated(std::make_unique<bool[]>(axes)) {}

  Environments::Step step(std::span<const float> actions) {
    const std::size_t axes = environments.size();
    return environments.step(actions, {.observations = observations,
                                       .rewards = rewards,
                                       .terminated = {terminated.get(), axes},
                                       .truncated = {truncated.get(), axes},
                                       .final_observations = final_observations});
  }
  [[nodiscard]] std::vector<float> observation(std::size_t axis) const {
    const std::size_t size = environments.observation_size();
    const auto begin = observations.begin() + static_cast<std::ptrdiff_t>(axis * size);
    return {begin, begin + static_cast<std::ptrdiff_t>(size)};
  }
  [[nodiscard]] std::vector<float> seen(std::size_t axis) const {
    std::vector<float> result(environments.observation_size());
    environments.observe(axis, result);
    return result;
  }

  Environments environments;
  std::vector<float> observations;
  std::vector<float> final_observations;
  std::vector<double> rewards;
  std::unique_ptr<bool[]> terminated;  // NOLINT(*-avoid-c-arrays)
  std::unique_ptr<bool[]> truncated;   // NOLINT(*-avoid-c-arrays)
};

GivenConditions given(std::string_view name, double value, GivenConditions others = {}) {
  for (std::size_t n = 0; n < kConditions; ++n) {
    if (kConditionNames[n].name == name) {
      others[n] = value;
      return others;
    }
  }
  ADD_FAILURE() << "no condition " << name;
  return others;
}

EnvironmentSettings calm(PlantKind plant, Task task) {
  EnvironmentSettings settings = usual_settings(plant, task);
  settings.randomisation = Randomisation::none();
  return settings;
}

using Kind = std::tuple<PlantKind, Task, ActionKind, Precision>;

class EachKind : public testing::TestWithParam<Kind> {
 protected:
  [[nodiscard]] static EnvironmentSettings settings() {
    const auto& [plant, task, action, precision] = GetParam();
    EnvironmentSettings result = usual_settings(plant, task);
    result.action = action;
    result.precision = precision;
    result.steps_per_action = std::min(result.steps_per_action, 5);
    // Some twenty episodes of a hundred actions, in which targets change.
    const base::SimDuration each = result.step * result.steps_per_action;
    result.episode = each * 100;
    result.shortest_hold = each * 10;
    result.longest_hold = each * 40;
    return result;
  }
};

TEST_P(EachKind, AnAxisAmongManyHasTheBitsOfOneAlone) {
  constexpr std::size_t kAxes = 11;
  constexpr int kActions = 700;
  Stage many(settings(), kAxes, Autoreset::next_step);
  std::vector<std::unique_ptr<Stage>> alone;
  for (std::size_t n = 0; n < kAxes; ++n) {
    alone.push_back(std::make_unique<Stage>(settings(), 1));
    many.environments.reset(n, 100 + n);
    alone[n]->environments.reset(0, 100 + n);
    ASSERT_EQ(many.seen(n), alone[n]->seen(0));
  }
  base::Random random(3);
  const std::size_t size = many.environments.action_size();
  std::vector<float> actions(kAxes * size);
  int episodes = 0;
  for (int step = 0; step < kActions; ++step) {
    for (float& action : actions) {
      // Some are beyond what is allowed and are cut.
      action = static_cast<float>(2.2 * random.uniform() - 1.1);
    }
    const std::vector<double> rewards_before = many.rewards;
    ASSERT_EQ(many.step(actions), Environments::Step::done);
    for (std::size_t n = 0; n < kAxes; ++n) {
      Stage& one = *alone[n];
      if (one.terminated[0] || one.truncated[0]) {
        // The step that begins the next episode.
        ++episodes;
        one.environments.reset(0, std::nullopt);
        one.terminated[0] = one.truncated[0] = false;
        ASSERT_EQ(many.observation(n), one.seen(0)) << step;
        ASSERT_EQ(many.rewards[n], 0.0);
        ASSERT_FALSE(many.terminated[n] || many.truncated[n]);
        continue;
      }
      ASSERT_EQ(one.step(std::span(actions).subspan(n * size, size)), Environments::Step::done);
      ASSERT_EQ(many.observation(n), one.observation(0)) << "axis " << n << ", step " << step;
      ASSERT_EQ(std::bit_cast<std::uint64_t>(many.rewards[n]),
                std::bit_cast<std::uint64_t>(one.rewards[0]));
      ASSERT_EQ(many.terminated[n], one.terminated[0]);
      ASSERT_EQ(many.truncated[n], one.truncated[0]);
    }
  }
  EXPECT_GE(episodes, static_cast<int>(6 * kAxes));
}

TEST_P(EachKind, ObservationsStayWithinMinusOneAndOneAndActionsDoSomething) {
  Stage stage(settings(), 2, Autoreset::same_step);
  for (std::size_t n = 0; n < 2; ++n) {
    stage.environments.reset(n, 5);  // the same one twice
  }
  const std::size_t size = stage.environments.action_size();
  base::Random random(9);
  std::vector<float> actions(2 * size);
  bool differ = false;
  for (int step = 0; step < 300; ++step) {
    for (std::size_t n = 0; n < size; ++n) {
      actions[n] = static_cast<float>(2.0 * random.uniform() - 1.0);
      actions[size + n] = -0.5F * actions[n];
    }
    ASSERT_EQ(stage.step(actions), Environments::Step::done);
    for (const float number : stage.observations) {
      ASSERT_LE(std::fabs(number), 1.0F);
    }
    for (const double reward : stage.rewards) {
      ASSERT_GE(reward, -stage.environments.settings().effort_weight);
      ASSERT_LE(reward, 1.0);
    }
    differ = differ || stage.observation(0) != stage.observation(1);
  }
  EXPECT_TRUE(differ);
}

std::string name_of(const testing::TestParamInfo<Kind>& info) {
  const auto& [plant, task, action, precision] = info.param;
  return std::string(plant == PlantKind::servo ? "Servo" : "Stepper") +
         (task == Task::torque     ? "Torque"
          : task == Task::velocity ? "Velocity"
                                   : "Position") +
         (action == ActionKind::current   ? "ByCurrent"
          : action == ActionKind::voltage ? "ByVoltage"
                                          : "ByDuty") +
         (precision == Precision::double_precision ? "" : "InSinglePrecision");
}

constexpr auto kDouble = Precision::double_precision;
INSTANTIATE_TEST_SUITE_P(
    Environments, EachKind,
    testing::Values(Kind{PlantKind::servo, Task::torque, ActionKind::voltage, kDouble},
                    Kind{PlantKind::servo, Task::torque, ActionKind::duty, kDouble},
                    Kind{PlantKind::servo, Task::velocity, ActionKind::current, kDouble},
                    Kind{PlantKind::servo, Task::position, ActionKind::current, kDouble},
                    Kind{PlantKind::servo, Task::velocity, ActionKind::current,
                         Precision::single_precision},
                    Kind{PlantKind::stepper, Task::torque, ActionKind::voltage, kDouble},
                    Kind{PlantKind::stepper, Task::torque, ActionKind::duty, kDouble},
                    Kind{PlantKind::stepper, Task::velocity, ActionKind::current, kDouble},
                    Kind{PlantKind::stepper, Task::position, ActionKind::current, kDouble}),
    name_of);

TEST(Environments, ConditionsAreDrawnWithinTheirSpansAndDifferBetweenEpisodes) {
  const EnvironmentSettings settings = usual_settings(PlantKind::servo, Task::velocity);
  Environments environments(settings, 1, Autoreset::disabled);
  const Conditions nominal = nominal_conditions(settings);
  const double rated_torque = environments.scales().rated_torque;
  std::array<double, kConditions> lowest{};
  std::array<double, kConditions> highest{};
  lowest.fill(std::numeric_limits<double>::infinity());
  highest.fill(-std::numeric_limits<double>::infinity());
  environments.reset(0, 1);
  for (int n = 0; n < 400; ++n) {
    environments.reset(0, std::nullopt);
    for (std::size_t k = 0; k < kConditions; ++k) {
      const double value = environments.conditions(0).*kConditionNames[k].member;
      lowest[k] = std::min(lowest[k], value);
      highest[k] = std::max(highest[k], value);
    }
  }
  // All but the initial speed, which is 0 where a velocity is to be followed.
  const std::array<Span, kConditions> expected{{
      {0.5 * nominal.inertia, 2.0 * nominal.inertia},
      {0.5 * nominal.viscous_friction, 2.0 * nominal.viscous_friction},
      {0.5 * nominal.coulomb_friction, 2.0 * nominal.coulomb_friction},
      {0.9 * nominal.resistance, 1.2 * nominal.resistance},
      {0.9 * nominal.inductance, 1.1 * nominal.inductance},
      {0.95 * nominal.flux_linkage, 1.05 * nominal.flux_linkage},
      {0.9 * nominal.supply_voltage, 1.1 * nominal.supply_voltage},
      {-0.2 * rated_torque, 0.2 * rated_torque},
      {0.0, 0.25},
      {0.0, 1.0},
      {0.0, 0.0},
      {-environments.scales().largest_target, environments.scales().largest_target},
  }};
  for (std::size_t k = 0; k < kConditions; ++k) {
    const double width = expected[k].high - expected[k].low;
    EXPECT_GE(lowest[k], expected[k].low - 1e-12) << kConditionNames[k].name;
    EXPECT_LE(highest[k], expected[k].high + 1e-12) << kConditionNames[k].name;
    EXPECT_LE(lowest[k], expected[k].low + 0.02 * width) << kConditionNames[k].name;
    EXPECT_GE(highest[k], expected[k].high - 0.02 * width) << kConditionNames[k].name;
  }
}

TEST(Environments, WhatIsGivenIsNotDrawnAndLeavesTheRestAsItWouldBe) {
  Environments environments(usual_settings(PlantKind::servo, Task::velocity), 2,
                            Autoreset::disabled);
  environments.reset(0, 8);
  environments.reset(1, 8, given("inertia", 3e-5));
  const Conditions& free = environments.conditions(0);
  const Conditions& fixed = environments.conditions(1);
  EXPECT_EQ(fixed.inertia, 3e-5);
  EXPECT_NE(free.inertia, 3e-5);
  EXPECT_EQ(fixed.resistance, free.resistance);
  EXPECT_EQ(fixed.target, free.target);
  // And the next episode is drawn as a whole.
  environments.reset(0, std::nullopt);
  environments.reset(1, std::nullopt);
  EXPECT_EQ(fixed.inertia, free.inertia);
}

TEST(Environments, AGivenTargetIsHeldForTheWholeEpisodeAndOthersChange) {
  EnvironmentSettings settings = calm(PlantKind::servo, Task::velocity);
  Stage stage(settings, 2);
  stage.environments.reset(0, 1, given("target", 10.0));
  stage.environments.reset(1, 1);
  const double first = stage.environments.target(1);
  int changes = 0;
  double before = first;
  const std::vector<float> nothing{0.0F, 0.0F};
  for (int n = 0; n < stage.environments.actions_per_episode() - 1; ++n) {
    ASSERT_EQ(stage.step(nothing), Environments::Step::done);
    ASSERT_EQ(stage.environments.target(0), 10.0);
    changes += stage.environments.target(1) != before ? 1 : 0;
    before = stage.environments.target(1);
  }
  // 250 ms with targets held for 50 to 150 ms.
  EXPECT_GE(changes, 1);
  EXPECT_LE(changes, 4);
}

TEST(Environments, AnEpisodeIsTruncatedWhenItsTimeIsOverAndThenNeedsAReset) {
  EnvironmentSettings settings = calm(PlantKind::stepper, Task::position);
  settings.episode = 10_ms;  // of 1 ms each
  Stage stage(settings, 1);
  const std::vector<float> nothing{0.0F};
  EXPECT_EQ(stage.step(nothing), Environments::Step::needs_reset) << "it has not begun";
  stage.environments.reset(0, 1);
  for (int n = 1; n <= 10; ++n) {
    ASSERT_EQ(stage.step(nothing), Environments::Step::done);
    ASSERT_EQ(stage.truncated[0], n == 10) << n;
    ASSERT_FALSE(stage.terminated[0]);
  }
  EXPECT_EQ(stage.step(nothing), Environments::Step::needs_reset);
  stage.environments.reset(0, std::nullopt);
  EXPECT_EQ(stage.step(nothing), Environments::Step::done);
}

TEST(Environments, AShaftThatIsTooFastAndACurrentThatIsTooLargeEndAnEpisode) {
  EnvironmentSettings settings = calm(PlantKind::servo, Task::velocity);
  settings.speed_limit = 100.0;
  Stage fast(settings, 1);
  fast.environments.reset(0, 1);
  const std::vector<float> forward{1.0F};
  int steps = 0;
  while (!fast.terminated[0]) {
    ASSERT_LT(fast.environments.reading(0).speed, 100.0);
    ASSERT_EQ(fast.step(forward), Environments::Step::done);
    ASSERT_LT(++steps, 100);
  }
  EXPECT_GT(fast.environments.reading(0).speed, 100.0);
  EXPECT_FALSE(fast.truncated[0]);

  Stage tripped(calm(PlantKind::servo, Task::torque), 1);
  tripped.environments.reset(0, 1);
  const std::vector<float> along{1.0F, 0.0F};
  steps = 0;
  while (!tripped.terminated[0]) {
    ASSERT_EQ(tripped.step(along), Environments::Step::done);
    ASSERT_LT(++steps, 100);
  }
  EXPECT_GT(tripped.environments.reading(0).direct_current,
            tripped.environments.scales().trip_current);
}

TEST(Environments, TravelEndsAnEpisodeWhereAPositionIsControlledAndNowhereElse) {
  for (const Task task : {Task::position, Task::velocity}) {
    Stage stage(calm(PlantKind::servo, task), 1);
    stage.environments.reset(0, 1, given("initial_position", 3.5));
    ASSERT_EQ(stage.step(std::vector<float>{0.0F}), Environments::Step::done);
    EXPECT_EQ(stage.terminated[0], task == Task::position);
  }
}

TEST(Environments, AnActionThatIsNoNumberIsRefusedBeforeAnythingHappens) {
  Stage stage(calm(PlantKind::servo, Task::velocity), 2);
  stage.environments.reset(0, 1);
  stage.environments.reset(1, 2);
  const std::vector<float> before = stage.seen(0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(stage.step(std::vector<float>{1.0F, nan}), Environments::Step::not_a_number);
  EXPECT_EQ(stage.seen(0), before);
  EXPECT_EQ(stage.step(std::vector<float>{1.0F, 0.0F}), Environments::Step::done);
  EXPECT_NE(stage.seen(0), before);
}

TEST(Environments, WithSameStepTheLastObservationIsKeptBesideTheFirstOfTheNextEpisode) {
  EnvironmentSettings settings = usual_settings(PlantKind::servo, Task::velocity);
  settings.episode = 5_ms;  // ten actions
  Stage same(settings, 1, Autoreset::same_step);
  Stage alone(settings, 1);
  same.environments.reset(0, 4);
  alone.environments.reset(0, 4);
  const std::vector<float> forward{0.7F};
  for (int n = 0; n < 10; ++n) {
    ASSERT_EQ(same.step(forward), Environments::Step::done);
    ASSERT_EQ(alone.step(forward), Environments::Step::done);
  }
  ASSERT_TRUE(same.truncated[0]);
  EXPECT_EQ(same.final_observations, alone.observations);
  EXPECT_EQ(same.rewards, alone.rewards);
  alone.environments.reset(0, std::nullopt);
  EXPECT_EQ(same.observation(0), alone.seen(0));
  EXPECT_EQ(same.step(forward), Environments::Step::done);
}

TEST(Environments, TheLoadTorqueSetsInWhenItIsTold) {
  Stage stage(calm(PlantKind::servo, Task::velocity), 2);
  GivenConditions load = given("load_torque", 0.05);
  load = given("load_torque_at", 10e-3, load);  // 20 actions
  load = given("target", 0.0, load);
  for (std::size_t n = 0; n < 2; ++n) {
    stage.environments.reset(n, 1, load);
  }
  const std::vector<float> nothing{0.0F, 0.0F};
  for (int n = 0; n < 20; ++n) {
    ASSERT_EQ(stage.step(nothing), Environments::Step::done);
    ASSERT_EQ(stage.environments.reading(0).speed, 0.0) << n;
  }
  ASSERT_EQ(stage.step(nothing), Environments::Step::done);
  EXPECT_GT(stage.environments.reading(0).speed, 1.0);
}

TEST(Environments, ACurrentThatIsAskedForFlows) {
  for (const PlantKind plant : {PlantKind::servo, PlantKind::stepper}) {
    Stage stage(calm(plant, Task::velocity), 1);
    stage.environments.reset(0, 1);
    for (int n = 0; n < 4; ++n) {
      ASSERT_EQ(stage.step(std::vector<float>{0.25F}), Environments::Step::done);
    }
    const Reading reading = stage.environments.reading(0);
    const double expected = 0.25 * stage.environments.scales().current;
    EXPECT_NEAR(reading.quadrature_current, expected, 0.05 * expected);
    EXPECT_NEAR(reading.direct_current, 0.0, 0.05 * expected);
    EXPECT_GT(reading.speed, 1.0);
    EXPECT_GT(reading.revolutions, 0.0);
  }
}

TEST(Environments, AVoltageAlongTheMagnetsMakesACurrentByOhmAndNoTorque) {
  for (const PlantKind plant : {PlantKind::servo, PlantKind::stepper}) {
    EnvironmentSettings settings = calm(plant, Task::torque);
    Stage stage(settings, 1);
    stage.environments.reset(0, 1, given("target", 0.0));
    const Scales& scales = stage.environments.scales();
    const double resistance = plant == PlantKind::servo ? settings.servo.motor.resistance +
                                                              settings.servo.inverter.on_resistance
                                                        : settings.stepper.motor.resistance;
    const double current = 0.5 * scales.current;
    const auto action = static_cast<float>(current * resistance / scales.voltage);
    for (int n = 0; n < 900; ++n) {
      ASSERT_EQ(stage.step(std::vector<float>{action, 0.0F}), Environments::Step::done);
    }
    EXPECT_NEAR(stage.environments.reading(0).direct_current, current, 0.03 * current);
    EXPECT_NEAR(stage.environments.reading(0).quadrature_current, 0.0, 0.02 * current);
    EXPECT_EQ(stage.environments.reading(0).speed, 0.0);
  }
}

TEST(Environments, DutiesOfAServoActFromPhaseToPhaseAndThoseOfAStepperFromCoilToCoil) {
  Stage servo(
      [] {
        EnvironmentSettings settings = calm(PlantKind::servo, Task::torque);
        settings.action = ActionKind::duty;
        return settings;
      }(),
      1);
  servo.environments.reset(0, 1);
  for (int n = 0; n < 10; ++n) {
    ASSERT_EQ(servo.step(std::vector<float>{0.1F, -0.1F, -0.1F}), Environments::Step::done);
  }
  // At angle 0 phase U is where the magnets are.
  EXPECT_GT(servo.environments.reading(0).direct_current, 0.3);

  EnvironmentSettings settings = calm(PlantKind::stepper, Task::torque);
  settings.action = ActionKind::duty;
  Stage stepper(settings, 1);
  stepper.environments.reset(0, 1);
  for (int n = 0; n < 10; ++n) {
    ASSERT_EQ(stepper.step(std::vector<float>{0.1F, 0.0F}), Environments::Step::done);
  }
  EXPECT_GT(stepper.environments.reading(0).direct_current, 0.3);
}

/// The mean reward of an episode in which a PI controller follows the target.
double mean_reward_of_a_velocity_loop(PlantKind plant, double proportional, double integral) {
  Stage stage(usual_settings(plant, Task::velocity), 8);
  for (std::size_t n = 0; n < 8; ++n) {
    stage.environments.reset(n, 50 + n);
  }
  std::array<double, 8> sum{};
  std::vector<float> actions(8);
  double total = 0.0;
  const int steps = stage.environments.actions_per_episode();
  for (int step = 0; step < steps; ++step) {
    for (std::size_t n = 0; n < 8; ++n) {
      const std::vector<float> seen = stage.seen(n);
      const double error = static_cast<double>(seen[0]) - static_cast<double>(seen[1]);
      sum[n] = std::clamp(sum[n] + integral * error, -1.0, 1.0);
      actions[n] = static_cast<float>(proportional * error + sum[n]);
    }
    if (stage.step(actions) != Environments::Step::done) {
      ADD_FAILURE() << "step " << step;
      return 0.0;
    }
    for (std::size_t n = 0; n < 8; ++n) {
      total += stage.rewards[n];
      EXPECT_FALSE(stage.terminated[n]) << n;
    }
  }
  return total / (8.0 * steps);
}

TEST(Environments, AVelocityLoopEarnsMoreThanNoneAndLessThanEverything) {
  for (const PlantKind plant : {PlantKind::servo, PlantKind::stepper}) {
    const double with = mean_reward_of_a_velocity_loop(plant, 8.0, 0.1);
    const double without = mean_reward_of_a_velocity_loop(plant, 0.0, 0.0);
    EXPECT_GT(with, 0.9);
    EXPECT_LT(with, 1.0);
    EXPECT_LT(without, 0.85);
  }
}

TEST(Environments, ConditionsThatAMotorCannotHaveAreRefusedWithWhatIsAllowed) {
  EXPECT_EQ(problem_of({}), "");
  EXPECT_EQ(problem_of(given("target", -5.0)), "");
  EXPECT_EQ(problem_of(given("resistance", 0.0)),
            R"("resistance" must be from 0.001 to 1000, not 0)");
  EXPECT_NE(problem_of(given("inertia", -1e-6)), "");
  EXPECT_NE(problem_of(given("load_torque", std::numeric_limits<double>::quiet_NaN())), "");
}

TEST(Judge, RewardsATargetThatIsMetAndTakesOffErrorAndEffort) {
  const EnvironmentSettings settings = calm(PlantKind::servo, Task::position);
  const Scales scales = scales_of(settings);  // targets within one revolution
  const Judge judge(settings, scales);
  const std::vector<float> nothing{0.0F};
  const std::vector<float> half{0.5F};
  EXPECT_DOUBLE_EQ(judge.reward({.revolutions = 0.5}, 0.5, nothing), 1.0);
  EXPECT_DOUBLE_EQ(judge.reward({.revolutions = 0.5}, 0.0, nothing), 0.75);
  EXPECT_DOUBLE_EQ(judge.reward({.revolutions = -0.5}, 0.0, nothing), 0.75);
  EXPECT_DOUBLE_EQ(judge.reward({.revolutions = 2.9}, 0.0, nothing), 0.0);
  EXPECT_DOUBLE_EQ(judge.reward({.revolutions = 0.5}, 0.5, half), 1.0 - 0.01 * 0.25);
}

TEST(Judge, CountsCurrentAlongTheMagnetsAsAnErrorOfTorque) {
  const EnvironmentSettings settings = calm(PlantKind::servo, Task::torque);
  const Scales scales = scales_of(settings);
  const Judge judge(settings, scales);
  const double torque = 0.1;
  const double current = torque / scales.torque_constant;
  const std::vector<float> nothing{0.0F, 0.0F};
  EXPECT_NEAR(judge.reward({.quadrature_current = current}, torque, nothing), 1.0, 1e-12);
  EXPECT_NEAR(judge.reward({.direct_current = 1.0, .quadrature_current = current}, torque, nothing),
              judge.reward({.quadrature_current = current + 1.0}, torque, nothing), 1e-12);
}

TEST(Judge, DividesByTheLimitsAtWhichEpisodesEnd) {
  const EnvironmentSettings settings = calm(PlantKind::servo, Task::torque);
  const Scales scales = scales_of(settings);
  const Judge judge(settings, scales);
  std::array<float, 7> seen{};
  judge.observe({.direct_current = scales.trip_current,
                 .quadrature_current = -0.5 * scales.trip_current,
                 .sine = 0.6,
                 .cosine = 0.8,
                 .speed = 0.25 * scales.speed_limit,
                 .supply_voltage = 1.1 * scales.supply_voltage},
                scales.torque_constant * scales.trip_current * 0.3, seen);
  const std::array<float, 7> expected{0.3F, 1.0F, -0.5F, 0.25F, 0.6F, 0.8F, 0.1F};
  for (std::size_t n = 0; n < seen.size(); ++n) {
    EXPECT_NEAR(seen[n], expected[n], 1e-6F) << observation_names(Task::torque)[n];
  }
}

}  // namespace
}  // namespace stator::environment
