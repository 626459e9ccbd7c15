// S-shaped ramps whose targets change in flight, against a reference of their own.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "control/random_ramps.hpp"
#include "sanitized.hpp"
#include "stator/base/random.hpp"
#include "stator/control/motion_controller/motion_controller_ramp.hpp"
#include "stator/control/motion_controller/motion_controller_units.hpp"

namespace stator::control::motion_controller {
namespace {

using tests::decades;

constexpr StopConditions kFree{};
/// The chip's units in microsteps and clocks (A23, A24).
constexpr long double kVelocityPerClock = 0x1p-30L;
constexpr long double kAccelerationPerClock = 0x1p-42L;
constexpr long double kBowPerClock = 0x1p-50L;
/// Clocks from one ramp step of the chip to the next; commands come no closer.
constexpr long double kRampStep = 256.0L;

struct State {
  long double position = 0.0L;
  long double velocity = 0.0L;
  long double acceleration = 0.0L;
};

/// A time of constant jerk, and what it ends with.
struct Piece {
  long double duration;
  long double jerk;
  long double final_velocity;
  long double final_acceleration;
};

State after(const State& state, const Piece& piece, long double time) {
  const auto [x, v, a] = state;
  return {x + time * (v + time * (a / 2.0L + time * piece.jerk / 6.0L)),
          v + time * (a + time * piece.jerk / 2.0L), a + time * piece.jerk};
}

State after(const State& state, const Piece& piece) {
  return {after(state, piece, piece.duration).position, piece.final_velocity,
          piece.final_acceleration};
}

/// What the chip's S-shaped ramp does from any moving start, from its rules: the acceleration comes
/// back to 0 between gaining and losing speed, speed is lost towards 0 and gained from it, a target
/// that is missed is returned to from rest.
class BowReference {
 public:
  explicit BowReference(const RampSettings& settings)
      : jerk_(static_cast<long double>(bow_value(settings.bow)) * kBowPerClock),
        top_(settings.maximum_velocity * kVelocityPerClock),
        up_(settings.acceleration * kAccelerationPerClock),
        down_(settings.deceleration * kAccelerationPerClock) {}

  [[nodiscard]] const State& state() const { return state_; }

  void rotate(long double velocity) {
    plan_.clear();
    const long double direction = direction_of(velocity);
    if (direction * velocity >= 0.0L) {
      change_speed(plan_, speed_state(direction), direction * velocity, direction);
    } else {
      change_speed(plan_, speed_state(direction), 0.0L, direction);
      change_speed(plan_, {}, -direction * velocity, -direction);
    }
    targets_position_ = false;
  }

  /// False: speed is being lost and the target lies where losing it more slowly would do; whether
  /// the ramp does that or holds a speed is its own choice.
  [[nodiscard]] bool move_to(long double target) {
    plan_.clear();
    targets_position_ = true;
    target_ = target;
    const long double direction = direction_of(target - state_.position);
    const State start = speed_state(direction);
    const long double way = direction * (target - state_.position);
    const std::vector<Piece> stop = arrival(start, 0.0L, direction);
    const long double braking = direction * (end_of(stop).position - state_.position);
    if (way < braking) {
      plan_ = stop;
      const long double back = braking - way;
      const std::vector<Piece> rest = journey({}, back, -direction);
      plan_.insert(plan_.end(), rest.begin(), rest.end());
      return true;
    }
    plan_ = journey(start, way, direction);
    return !plan_.empty() || way == 0.0L;
  }

  void advance(long double time) {
    for (std::size_t i = 0; i < plan_.size(); ++i) {
      if (time < plan_[i].duration) {
        state_ = after(state_, plan_[i], time);
        plan_[i].duration -= time;
        plan_.erase(plan_.begin(), plan_.begin() + static_cast<std::ptrdiff_t>(i));
        return;
      }
      time -= plan_[i].duration;
      state_ = after(state_, plan_[i]);
    }
    plan_.clear();
    state_.position += time * state_.velocity;
    if (targets_position_) {
      state_ = {target_, 0.0L, 0.0L};
    }
  }

  [[nodiscard]] long double duration() const {
    long double sum = 0.0L;
    for (const Piece& each : plan_) {
      sum += each.duration;
    }
    return sum;
  }

 private:
  /// Of the motion, or of where to when there is none.
  [[nodiscard]] long double direction_of(long double wanted) const {
    const long double motion = state_.velocity != 0.0L       ? state_.velocity
                               : state_.acceleration != 0.0L ? state_.acceleration
                                                             : wanted;
    return motion < 0.0L ? -1.0L : 1.0L;
  }
  /// Speed and its change, positive in `direction`.
  [[nodiscard]] State speed_state(long double direction) const {
    return {0.0L, direction * state_.velocity, direction * state_.acceleration};
  }
  /// The speed to which a change under way leads when it ends at once.
  [[nodiscard]] long double eased(const State& start) const {
    return start.velocity + start.acceleration * std::fabs(start.acceleration) / (2.0L * jerk_);
  }

  void push(std::vector<Piece>& plan, const Piece& piece, long double direction) const {
    plan.push_back({piece.duration, direction * piece.jerk, direction * piece.final_velocity,
                    direction * piece.final_acceleration});
  }

  /// `start` and `speed` are positive in `direction`.
  void change_speed(std::vector<Piece>& plan, State start, long double speed,
                    long double direction) const {
    const long double left = speed - eased(start);
    if (start.acceleration != 0.0L && left * start.acceleration < 0.0L) {
      const long double sign = start.acceleration < 0.0L ? -1.0L : 1.0L;
      const long double speed_eased = eased(start);
      push(plan, {std::fabs(start.acceleration) / jerk_, -sign * jerk_, speed_eased, 0.0L},
           direction);
      start = {0.0L, speed_eased, 0.0L};
    }
    const long double change = speed - start.velocity;
    if (change == 0.0L && start.acceleration == 0.0L) {
      return;
    }
    const long double sign = change < 0.0L ? -1.0L : 1.0L;
    const long double rate = sign < 0.0L ? down_ : up_;
    const long double first = std::fabs(start.acceleration);
    const long double size = std::fabs(change);
    const long double peak = std::min(rate, std::sqrt(jerk_ * size + 0.5L * first * first));
    const long double bows = (peak * peak - 0.5L * first * first) / jerk_;
    const long double last = 0.5L * peak * peak / jerk_;
    push(plan,
         {(peak - first) / jerk_, sign * jerk_,
          start.velocity + sign * 0.5L * (peak * peak - first * first) / jerk_, sign * peak},
         direction);
    push(plan, {std::max(0.0L, size - bows) / peak, 0.0L, speed - sign * last, sign * peak},
         direction);
    push(plan, {peak / jerk_, -sign * jerk_, speed, 0.0L}, direction);
  }

  /// Through `speed` to rest.
  [[nodiscard]] std::vector<Piece> arrival(const State& start, long double speed,
                                           long double direction) const {
    std::vector<Piece> plan;
    change_speed(plan, start, speed, direction);
    change_speed(plan, {0.0L, speed, 0.0L}, 0.0L, direction);
    return plan;
  }
  [[nodiscard]] State end_of(const std::vector<Piece>& plan) const {
    State state = state_;
    for (const Piece& each : plan) {
      state = after(state, each);
    }
    return state;
  }
  [[nodiscard]] static long double way_of(const State& start, const std::vector<Piece>& plan,
                                          long double direction) {
    State state{0.0L, direction * start.velocity, direction * start.acceleration};
    for (const Piece& each : plan) {
      state = after(state, each);
    }
    return direction * state.position;
  }

  /// A way that is not too short for a stop; the peak speed is found by bisection. Empty: see
  /// move_to().
  [[nodiscard]] std::vector<Piece> journey(const State& start, long double way,
                                           long double direction) const {
    long double low = std::max(0.0L, eased(start));
    if (start.acceleration < 0.0L &&
        way < way_of(start, arrival(start, low, direction), direction)) {
      return {};
    }
    long double high = top_;
    if (way_of(start, arrival(start, high, direction), direction) > way) {
      for (int step = 0; step < 80; ++step) {
        const long double middle = 0.5L * (low + high);
        (way_of(start, arrival(start, middle, direction), direction) > way ? high : low) = middle;
      }
      return arrival(start, high, direction);
    }
    std::vector<Piece> plan;
    change_speed(plan, start, high, direction);
    const long double cruise =
        (way - way_of(start, arrival(start, high, direction), direction)) / high;
    push(plan, {cruise, 0.0L, high, 0.0L}, direction);
    change_speed(plan, {0.0L, high, 0.0L}, 0.0L, direction);
    return plan;
  }

  long double jerk_;
  long double top_;
  long double up_;
  long double down_;
  State state_;
  std::vector<Piece> plan_;
  bool targets_position_ = true;
  long double target_ = 0.0L;
};

RampSettings random_settings(base::Random& random) {
  const auto between = [&](double low, double high) {
    return static_cast<std::uint32_t>(decades(random, low, high));
  };
  return {.maximum_velocity = between(1e4, 134'217'728.0),
          .acceleration = between(1e3, 1'000'000.0),
          .deceleration = between(1e3, 1'000'000.0),
          .bow = static_cast<std::uint8_t>(1 + random.below(18))};
}

std::int32_t random_sign(base::Random& random) {
  return random.below(2) == 0 ? 1 : -1;
}

TEST(MotionControllerBowReference, TargetsThatChangeInFlightAreMetAsTheRulesSay) {
  base::Random random(1018);
  int compared = 0;
  int in_flight = 0;
  for (int run = 0; compared < (stator::tests::kSanitized ? 10'000 : 100'000); ++run) {
    const RampSettings settings = random_settings(random);
    MotionControllerRamp ramp;
    ramp.configure(settings, {}, false);
    BowReference reference(settings);
    for (int change = 0; change < 5; ++change) {
      in_flight += reference.state().velocity != 0.0L ? 1 : 0;
      if (random.below(3) == 0) {
        const auto velocity = static_cast<std::int32_t>(
            decades(random, 1.0, settings.maximum_velocity) * random_sign(random));
        ramp.rotate(velocity);
        reference.rotate(velocity * kVelocityPerClock);
      } else {
        const std::int64_t way =
            static_cast<std::int64_t>(decades(random, 1.0, 1e7)) * random_sign(random);
        const std::int64_t target = ramp.unwrapped_position() + way;
        ramp.move_to(static_cast<std::int32_t>(target));
        if (!reference.move_to(static_cast<long double>(target))) {
          break;
        }
      }
      const long double clocks =
          kRampStep +
          std::min(static_cast<long double>(random.uniform() * 1.1) * reference.duration(), 1e9L);
      const base::SimDuration duration(static_cast<std::int64_t>(clocks * 62.5L) + 1);
      ramp.advance(kFree, duration);
      reference.advance(static_cast<long double>(duration.nanoseconds()) / 62.5L);
      const State& expected = reference.state();
      const MicrostepPosition& here = ramp.generator().position();
      ASSERT_NEAR(static_cast<double>(here.microsteps + static_cast<long double>(here.fraction) -
                                      expected.position),
                  0.0, 1.0)
          << "run " << run << " change " << change;
      ASSERT_NEAR(ramp.velocity() - static_cast<double>(expected.velocity / kVelocityPerClock), 0.0,
                  1.0)
          << "run " << run << " change " << change;
      ++compared;
    }
  }
  EXPECT_GT(in_flight, compared / 2);
}

}  // namespace
}  // namespace stator::control::motion_controller
