#pragma once

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "stator/control/ramp/ramp_generator.hpp"

namespace stator::control::tests {

/// What a generator does when it is told to plan anew.
struct Start {
  explicit Start(const RampGenerator& ramp) : state(ramp.state().now), end_jerk(ramp.end_jerk()) {
    if (end_jerk == 0.0) {
      state.acceleration = 0.0;
    }
    for (std::size_t i = ramp.state().segment; i < ramp.state().plan.size(); ++i) {
      const MotionSegment& segment = ramp.state().plan[i];
      top_speed = std::max({top_speed, std::fabs(segment.at(0.0).velocity),
                            std::fabs(segment.at(segment.duration).velocity)});
    }
  }
  MotionState state;
  double end_jerk;
  double top_speed = 0.0;  ///< of the plan given up
};

/// Checks the plan of an s-shaped ramp segment by segment: in closed form, so that no instant is
/// missed. What the start had above the limits in force may be kept, not raised.
class BowAudit {
 public:
  BowAudit(const Start& start, const MotionPlan& plan, const RampLimits& limits)
      : plan_(plan),
        limits_(limits),
        start_(start.state),
        before_(start.state),
        end_jerk_(start.end_jerk),
        under_way_(start.state.acceleration != 0.0),
        allowed_rate_(std::fabs(start.state.acceleration)),
        allowed_speed_(std::max(limits.velocity, start.top_speed)) {}

  void check() {
    for (std::size_t i = 0; i < plan_.size(); ++i) {
      continuous(plan_[i]);
      within_limits(plan_[i]);
      if (testing::Test::HasFatalFailure()) {
        print(i);
        return;
      }
      before_ = plan_[i].at(plan_[i].duration);
      under_way_ = under_way_ && std::fabs(before_.acceleration) > 1e-9 * allowed_rate_;
    }
  }

 private:
  void continuous(const MotionSegment& segment) const {
    const MotionState begin = segment.at(0.0);
    ASSERT_NEAR(distance(before_.position, begin.position), 0.0,
                2e-8 + 2e-12 * std::fabs(distance({0, 0.0}, begin.position)));
    ASSERT_NEAR(begin.velocity, before_.velocity, 1e-6 + 1e-9 * std::fabs(begin.velocity));
    // A start of braking found anew has its peak from a root of rounded numbers.
    const double slack = 1e-5 * (1.0 + std::max(limits_.acceleration, limits_.deceleration));
    if (stepless(before_.acceleration) && stepless(begin.acceleration)) {
      ASSERT_NEAR(begin.acceleration, before_.acceleration, slack);
    }
  }
  [[nodiscard]] bool stepless(double /*acceleration*/) const {
    return std::all_of(limits_.jerk.begin(), limits_.jerk.end(),
                       [](double jerk) { return jerk > 0.0; });
  }
  void within_limits(const MotionSegment& segment) const {
    const MotionState begin = segment.at(0.0);
    const MotionState end = segment.at(segment.duration);
    const double speed = std::max(std::fabs(begin.velocity), std::fabs(end.velocity));
    ASSERT_LE(speed, allowed_speed_ * (1.0 + 1e-9) + 1e-9);
    const MotionState middle = segment.at(0.5 * segment.duration);
    const double rise = (middle.velocity < 0.0 ? -1.0 : 1.0) * middle.acceleration;
    const bool gaining = rise > 0.0;
    const double rate = std::max(std::fabs(begin.acceleration), std::fabs(end.acceleration));
    const double limit = gaining ? limits_.acceleration : limits_.deceleration;
    ASSERT_LE(rate, std::max(limit, allowed_rate_) * (1.0 + 1e-9) + 1e-9);
    // By the jerk: in the shortest of bows the acceleration does not change its last digit.
    const bool growing = segment.jerk * middle.acceleration > 0.0;
    if (segment.jerk != 0.0) {
      const std::size_t corner = (gaining ? 0U : 2U) + (growing ? 0U : 1U);
      const bool brakes_on = corner == 3 && start_.acceleration * start_.velocity < 0.0;
      if (!growing && (under_way_ || brakes_on) && end_jerk_ > limits_.jerk[corner]) {
        ASSERT_LE(std::fabs(segment.jerk), end_jerk_) << "the former jerk " << corner + 1;
      } else {
        ASSERT_EQ(std::fabs(segment.jerk), limits_.jerk[corner]) << "jerk " << corner + 1;
      }
      ASSERT_GE(begin.acceleration * end.acceleration, -1e-9 * rate * rate)
          << "an acceleration does not change its sign" << begin.acceleration << end.acceleration;
    } else if (segment.phase == RampPhase::accelerating ||
               segment.phase == RampPhase::decelerating) {
      ASSERT_NEAR(rate, limit, 1e-9 * limit) << "held at the limit only";
    }
  }

  void print(std::size_t segment) const {
    testing::Message text;
    text << "segment " << segment << " after a start at v " << start_.velocity << " a "
         << start_.acceleration << ", limits v " << limits_.velocity << " a "
         << limits_.acceleration << " d " << limits_.deceleration;
    for (const double jerk : limits_.jerk) {
      text << " j " << jerk;
    }
    for (std::size_t k = 0; k < plan_.size(); ++k) {
      const MotionState begin = plan_[k].at(0.0);
      const MotionState end = plan_[k].at(plan_[k].duration);
      text << "\n"
           << plan_[k].duration << " s: x " << distance(start_.position, begin.position) << " .. "
           << distance(start_.position, end.position) << " v " << begin.velocity << " .. "
           << end.velocity << " a " << begin.acceleration << " .. " << end.acceleration << " j "
           << plan_[k].jerk;
    }
    ADD_FAILURE() << text;
  }

  const MotionPlan& plan_;
  const RampLimits& limits_;
  MotionState start_;
  MotionState before_;
  double end_jerk_;
  bool under_way_;  ///< the change of speed the start was in
  double allowed_rate_;
  double allowed_speed_;
};

}  // namespace stator::control::tests
