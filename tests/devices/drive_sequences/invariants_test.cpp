// The tester is tested: for each invariant a recording that keeps it, and the same one spoilt,
// which has to be noticed. And that what is left of a shortened sequence still fails.

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/drive_sequences/drive_invariants.hpp"
#include "devices/drive_sequences/trial.hpp"
#include "devices/drive_sequences/vocabulary.hpp"

namespace stator::tests {
namespace {

constexpr double kRamp = 100.0;  // rev/s²
constexpr double kStep = 1e-3;   // s

DriveTraits servo() {
  return {.standstill = 0.3, .settle = 0.02, .reaction = 0.01, .lag = 0.005, .overvoltage = 30.0};
}

/// A shaft that does what its demand says: `milliseconds` of it, from `velocity` on.
class Recording {
 public:
  explicit Recording(double velocity) {
    sample_.power = true;
    sample_.enabled = true;
    sample_.mode = 3;
    sample_.torque_limit = 0.2;
    sample_.current_limit = 10.0;
    sample_.acceleration = sample_.switch_deceleration = sample_.limit_deceleration = kRamp;
    turn(velocity);
  }

  Sample& now() { return sample_; }
  void turn(double velocity) {
    sample_.velocity = sample_.demand_velocity = sample_.shown_velocity = velocity;
  }
  /// Goes on for so long with a velocity that changes by `acceleration`, in a stop down to 0.
  void go(int milliseconds, double acceleration = 0.0) {
    for (int i = 0; i < milliseconds; ++i) {
      const double before = sample_.velocity;
      const double after = before + acceleration * kStep;
      const bool rests = before == 0.0 && sample_.stop.cause != StopCause::none;
      turn(before * after < 0.0 || rests ? 0.0 : after);
      sample_.position += sample_.velocity * kStep;
      sample_.shown_position = sample_.demand = sample_.position;
      sample_.time += base::SimDuration(1'000'000);
      samples_.push_back(sample_);
    }
  }
  void stop(StopCause cause, double deceleration = kRamp) {
    sample_.stop = {.cause = cause, .deceleration = deceleration};
  }
  std::vector<Sample>& samples() { return samples_; }

 private:
  Sample sample_;
  std::vector<Sample> samples_;
};

std::optional<DriveViolation> judged(const std::vector<Sample>& samples,
                                     const DriveTraits& traits = servo()) {
  DriveInvariants invariants(traits);
  for (const Sample& sample : samples) {
    invariants.see(sample);
  }
  return invariants.violation();
}

/// What is violated, or "nothing".
std::string verdict(const std::vector<Sample>& samples, const DriveTraits& traits = servo()) {
  const auto violation = judged(samples, traits);
  return violation ? std::string(to_text(violation->invariant)) : "nothing";
}

TEST(DriveInvariants, AStopThatKeepsToItsRampIsGood) {
  for (const StopCause cause : {StopCause::halt, StopCause::quick_stop, StopCause::network}) {
    Recording recording(20.0);
    recording.go(30);
    recording.stop(cause);
    recording.go(400, -kRamp);
    EXPECT_EQ(verdict(recording.samples()), "nothing") << to_text(cause);
  }
}

TEST(DriveInvariants, AStopThatTakesHalfAsLongAgainIsNoticed) {
  Recording recording(20.0);
  recording.go(30);
  recording.stop(StopCause::halt);
  recording.go(400, -kRamp / 1.5);
  EXPECT_EQ(verdict(recording.samples()), "stops");
}

TEST(DriveInvariants, AStopThatSpeedsUpIsNoticed) {
  Recording recording(20.0);
  recording.go(30);
  recording.stop(StopCause::quick_stop);
  recording.go(60, 50.0);
  EXPECT_EQ(verdict(recording.samples()), "stops");
}

TEST(DriveInvariants, ATorqueThatDoesNotSufficeMakesAStopLonger) {
  const auto braked = [](double torque_limit, double load) {
    Recording recording(20.0);
    recording.now().torque_limit = torque_limit;
    recording.now().inertia = 1e-5;
    recording.now().load = load;
    recording.go(30);
    recording.stop(StopCause::halt);
    recording.go(800, -30.0);
    return verdict(recording.samples());
  };
  constexpr double kTurn = 2.0 * std::numbers::pi;
  EXPECT_EQ(braked(1e-5 * 40.0 * kTurn, 0.0), "nothing") << "four fifths of it make 32 rev/s²";
  EXPECT_EQ(braked(0.2, 0.0), "stops");
  EXPECT_EQ(braked(0.2, 0.3), "nothing") << "a load drives it that the motor cannot hold";
}

TEST(DriveInvariants, AShaftThatStartsAgainInAStopIsNoticed) {
  Recording recording(20.0);
  recording.go(30);
  recording.stop(StopCause::halt);
  recording.go(400, -kRamp);
  recording.turn(2.0);
  recording.go(30);
  EXPECT_EQ(verdict(recording.samples()), "stops");
}

TEST(DriveInvariants, ADemandThatLeapsIsNoticed) {
  const auto leaping = [](double shaft) {
    Recording recording(5.0);
    recording.go(30);
    Sample& now = recording.now();
    recording.turn(shaft);
    now.demand_velocity = 9.0;
    recording.samples().push_back(now);
    return verdict(recording.samples());
  };
  EXPECT_EQ(leaping(5.0), "demand on its ramp");
  EXPECT_EQ(leaping(9.0), "nothing") << "it takes over what the shaft does";
}

TEST(DriveInvariants, ADemandOnItsRampIsGood) {
  Recording recording(5.0);
  recording.go(100, kRamp);
  recording.go(300, -kRamp);
  EXPECT_EQ(verdict(recording.samples()), "nothing");
}

TEST(DriveInvariants, ASwitchThatIsPassedIsNoticed) {
  const auto passing = [](double deceleration) {
    Recording recording(20.0);
    recording.go(30);
    recording.now().positive_switch = true;
    recording.now().statusword = 0x0800;
    recording.go(400, -deceleration);
    return verdict(recording.samples());
  };
  EXPECT_EQ(passing(kRamp), "nothing");
  EXPECT_EQ(passing(kRamp / 2), "behind a switch");
  EXPECT_EQ(passing(0.0), "behind a switch");
}

TEST(DriveInvariants, CreepingBehindASwitchIsNoticedAndGoingBackIsNot) {
  for (const double velocity : {0.2, -20.0}) {
    Recording recording(0.0);
    recording.now().positive_switch = true;
    recording.go(30);
    recording.go(100, velocity < 0.0 ? -kRamp : kRamp);
    recording.turn(velocity);
    recording.now().reference_changed = true;  // the leap of the demand is not the matter
    recording.go(1);
    recording.now().reference_changed = false;
    recording.go(500);
    EXPECT_EQ(verdict(recording.samples()), velocity > 0.0 ? "behind a switch" : "nothing");
  }
}

TEST(DriveInvariants, ASoftwareLimitThatIsPassedIsNoticed) {
  const auto passing = [](double deceleration) {
    Recording recording(20.0);
    recording.now().upper_limit = 1.0;
    recording.now().target_velocity = 20.0;
    recording.go(51);
    recording.now().statusword = 0x0800;
    recording.go(400, -deceleration);
    return verdict(recording.samples());
  };
  EXPECT_EQ(passing(kRamp), "nothing");
  EXPECT_EQ(passing(kRamp / 2), "behind a software limit");
}

TEST(DriveInvariants, PowerGoesOffWithATurningShaftOnlyForAReason) {
  const auto switched_off = [](PowerOff reason, double velocity) {
    Recording recording(velocity);
    recording.go(30);
    recording.now().power = false;
    recording.now().power_off = reason;
    recording.go(30);
    return verdict(recording.samples());
  };
  EXPECT_EQ(switched_off(PowerOff::not_allowed, 5.0), "power off");
  EXPECT_EQ(switched_off(PowerOff::not_allowed, 0.1), "nothing");
  for (const PowerOff reason : {PowerOff::disable_voltage, PowerOff::option_0,
                                PowerOff::stage_fault, PowerOff::switched_off}) {
    EXPECT_EQ(switched_off(reason, 5.0), "nothing");
  }
}

TEST(DriveInvariants, ABridgeThatStaysOnAgainstDisableVoltageIsNoticed) {
  Recording recording(5.0);
  recording.go(30);
  recording.now().has_to_be_off = true;
  recording.go(10);
  EXPECT_EQ(verdict(recording.samples()), "power off");
}

TEST(DriveInvariants, ABit10ThatComesBeforeStandstillIsNoticed) {
  Recording recording(20.0);
  recording.go(30);
  recording.stop(StopCause::halt);
  recording.now().statusword = 0x0400;
  recording.go(60, -kRamp);
  EXPECT_EQ(verdict(recording.samples()), "halt reached");
}

TEST(DriveInvariants, ABit10OffTheTargetIsNoticed) {
  const auto reached = [](int mode, double off) {
    Recording recording(0.0);
    Sample& now = recording.now();
    now.mode = mode;
    now.statusword = 0x0400;
    now.target_reached_bit = true;
    now.window = 0.01;
    now.velocity_window = 0.1;
    now.target = mode == 1 ? off : 0.0;
    now.target_velocity = mode == 3 ? off : 0.0;
    recording.go(50);
    return verdict(recording.samples());
  };
  EXPECT_EQ(reached(1, 0.02), "target reached");
  EXPECT_EQ(reached(1, 0.005), "nothing");
  EXPECT_EQ(reached(3, 1.0), "target reached");
  EXPECT_EQ(reached(3, 0.05), "nothing");
}

TEST(DriveInvariants, ALimitThatHoldsTheAxisShowsInBits11And12) {
  const auto held = [](std::uint16_t statusword) {
    Recording recording(0.0);
    Sample& now = recording.now();
    now.mode = 9;
    now.guidance = Guidance::cyclic;
    now.follows_bit = true;
    now.target_velocity = 3.0;
    now.positive_switch = true;
    now.statusword = statusword;
    recording.go(50);
    return verdict(recording.samples());
  };
  EXPECT_EQ(held(0x0800), "nothing");
  EXPECT_EQ(held(0x1800), "follows");
  EXPECT_EQ(held(0x0000), "internal limit");
}

TEST(DriveInvariants, ABit12DuringAHaltIsNoticed) {
  Recording recording(0.0);
  recording.now().follows_bit = true;
  recording.now().statusword = 0x1000;
  recording.stop(StopCause::halt);
  recording.go(50);
  EXPECT_EQ(verdict(recording.samples()), "follows");
}

TEST(DriveInvariants, ActualValuesThatAreWrongAreNoticed) {
  Recording recording(2.0);
  recording.go(50);
  std::vector<Sample> samples = recording.samples();
  for (std::size_t i = 10; i < samples.size(); ++i) {
    samples[i].shown_position += 0.05;
  }
  EXPECT_EQ(verdict(samples), "position shown");
  samples = recording.samples();
  for (std::size_t i = 10; i < samples.size(); ++i) {
    samples[i].shown_velocity = 3.0;
  }
  EXPECT_EQ(verdict(samples), "velocity shown");
}

TEST(DriveInvariants, TooMuchCurrentAndASupplyThatIsPumpedUpAreNoticed) {
  const auto with = [](double current, double supply, double energy) {
    Recording recording(2.0);
    recording.go(110);
    recording.now().current = current;
    recording.now().supply = supply;
    recording.now().supplied_energy = energy;
    recording.go(20);
    return verdict(recording.samples());
  };
  EXPECT_EQ(with(10.5, 24.0, 0.0), "nothing");
  EXPECT_EQ(with(12.0, 24.0, 0.0), "current");
  EXPECT_EQ(with(5.0, 31.0, 0.0), "supply");
  EXPECT_EQ(with(5.0, 24.0, -1.0), "supply") << "more than the shaft had";
}

TEST(DriveInvariants, WhatIsNoNumberIsNoticed) {
  Recording recording(2.0);
  recording.now().current = std::numeric_limits<double>::quiet_NaN();
  recording.go(1);
  EXPECT_EQ(verdict(recording.samples()), "numbers");
}

TEST(DriveInvariants, ACounterThatRunsWithoutPowerIsNoticed) {
  DriveTraits traits = servo();
  traits.shaft_is_counter = true;
  Recording recording(2.0);
  recording.now().power = false;
  recording.now().power_off = PowerOff::switched_off;
  recording.go(10);
  EXPECT_EQ(verdict(recording.samples(), traits), "stops");
}

TEST(DriveInvariants, AnExceptedOneIsPassedOver) {
  Recording recording(5.0);
  recording.go(30);
  recording.now().power = false;
  recording.go(30);
  DriveInvariants invariants(servo(), {Invariant::power_off});
  for (const Sample& sample : recording.samples()) {
    invariants.see(sample);
  }
  EXPECT_FALSE(invariants.violation());
}

/// A drive that obeys nothing: its shaft turns with the same velocity whatever comes.
class DeafDrive final : public DriveUnderTest {
 public:
  explicit DeafDrive(double velocity) : velocity_(velocity) {}

  Sample sample() override {
    return {.time = base::SimTime() + base::SimDuration(1'000'000) * passed_,
            .position = shaft_position(),
            .velocity = velocity_,
            .shown_position = shaft_position(),
            .shown_velocity = velocity_};
  }
  double shaft_velocity() override { return velocity_; }
  double shaft_position() override { return velocity_ * kStep * static_cast<double>(passed_); }
  std::int64_t actual_position() override { return 0; }

 private:
  void write(const DriveStep& /*step*/) override {}
  void go_to_network_state(int /*state*/) override {}
  void pass_cycle(int /*times*/) override { ++passed_; }
  void set_input(std::string_view /*name*/, double /*level*/) override {}

  double velocity_;
  std::int64_t passed_ = 0;
};

TEST(DriveSequences, EndWithAShaftThatStandsAndADriveThatWorks) {
  const DriveSequence sequence{.product = Product::tmcm_142, .steps = {}};
  const TrialOutcome runs = run_sequence(std::make_unique<DeafDrive>(2.0), sequence);
  ASSERT_TRUE(runs.violation);
  EXPECT_EQ(runs.violation->invariant, Invariant::runs_for_ever);
  const TrialOutcome stands = run_sequence(std::make_unique<DeafDrive>(0.0), sequence);
  ASSERT_TRUE(stands.violation);
  EXPECT_EQ(stands.violation->invariant, Invariant::works_afterwards);
}

TEST(DriveSequenceShortening, LeavesWhatFailsAndNothingElse) {
  const DriveStep culprit{.action = DriveAction::write, .index = 0x6040, .value = 2};
  const auto fails = [](const std::vector<DriveStep>& steps) {
    std::int64_t waited = 0;
    bool stopped = false;
    for (const DriveStep& step : steps) {
      waited += step.action == DriveAction::wait && !stopped ? step.value : 0;
      stopped = stopped || (step.action == DriveAction::write && step.value == 2);
    }
    return stopped && waited >= 10;
  };
  std::vector<DriveStep> steps;
  for (int i = 0; i < 20; ++i) {
    steps.push_back({.action = DriveAction::write, .index = 0x6081, .value = 1000 + i});
    steps.push_back({.action = DriveAction::wait, .value = 40});
  }
  steps.push_back(culprit);
  ASSERT_TRUE(fails(steps));
  const std::vector<DriveStep> few = shortened(steps, fails);
  EXPECT_TRUE(fails(few));
  ASSERT_EQ(few.size(), 2U);
  EXPECT_EQ(few[0].value, 10) << "halved twice";
  EXPECT_EQ(few[1].value, 2);
}

TEST(DriveSequences, FollowFromTheirSeed) {
  for (const Product product : {Product::tmc8670, Product::tmcm_142}) {
    const auto text = [&](std::uint64_t seed) {
      std::string lines;
      for (const DriveStep& step : random_drive_sequence(product, seed)) {
        lines += to_text(step) + "\n";
      }
      return lines;
    };
    EXPECT_EQ(text(7), text(7));
    EXPECT_NE(text(7), text(8));
  }
}

TEST(DriveSequences, RunToTheSameEndTwice) {
  const DriveSequence sequence{.product = Product::tmc8670,
                               .steps = random_drive_sequence(Product::tmc8670, 3)};
  const auto trace = [&] {
    std::vector<double> values;
    static_cast<void>(run_sequence(sequence, {}, [&](const Sample& sample) {
      values.push_back(sample.velocity);
      values.push_back(sample.current);
    }));
    return values;
  };
  EXPECT_EQ(trace(), trace());
}

TEST(DriveSequences, AreWrittenAsScenarios) {
  const std::vector<DriveStep> steps{
      {.action = DriveAction::write, .index = 0x607D, .subindex = 2, .value = -7},
      {.action = DriveAction::set, .input = "axis0.load_torque", .level = 0.125},
      {.action = DriveAction::lose_cycles, .value = 3},
      {.action = DriveAction::network, .value = 4},
      {.action = DriveAction::wait, .value = 12}};
  EXPECT_EQ(scenario_of(Product::tmcm_3315, steps, "Example"),
            R"(name = "Example"
plot = ["drive.axis0.shaft_speed", "drive.axis0.shaft_position"]
[[rack.segment]]
[[rack.segment.device]]
type = "tmcm-3315"
name = "drive"
[[rack.segment.device.axis]]
load.viscous_friction = 0.004

[[step]]
do = "state"
state = "operational"

[[step]]
do = "write"
object = "607D:02"
value = -7

[[step]]
do = "set"
device = "drive"
input = "axis0.load_torque"
value = 0.125

# 3 exchanges of process data are lost

[[step]]
do = "state"
state = "safe-operational"

[[step]]
do = "wait"
time = "12ms"

)");
}

}  // namespace
}  // namespace stator::tests
