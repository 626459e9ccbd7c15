#pragma once

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/control/ramp/ramp_generator.hpp"

// Random commands, and properties that ramps of every shape have.
namespace stator::control::tests {

/// A number between `low` and `high`, every decade equally likely.
inline double decades(base::Random& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

inline std::int64_t random_target(base::Random& random) {
  const auto magnitude = static_cast<std::int64_t>(decades(random, 1.0, 1e6));
  return random.below(2) == 0 ? magnitude : -magnitude;
}

inline double position_of(const RampGenerator& ramp) {
  return distance({0, 0.0}, ramp.position());
}

using RandomLimits = RampLimits (*)(base::Random& random);

/// What two traces may differ by.
struct Rounding {
  double position;  ///< part of the position
  double velocity;  ///< pps in mirrored traces, part of the limit otherwise
};

/// Commands mirrored at 0, some of them in flight, give the mirrored trace.
inline void check_mirrored_traces(base::Random& random, int cases, RandomLimits random_limits,
                                  const Rounding& rounding) {
  using namespace base::literals;
  for (int i = 0; i < cases; ++i) {
    RampGenerator ramp;
    RampGenerator mirrored;
    for (int change = 0; change < 5; ++change) {
      const RampLimits limits = random_limits(random);
      const std::int64_t target = random_target(random);
      ramp.move_to(target, limits);
      mirrored.move_to(-target, limits);
      for (int tick = 0; tick < 20; ++tick) {
        ramp.advance(1_ms);
        mirrored.advance(1_ms);
        const double here = position_of(ramp);
        ASSERT_NEAR(here, -position_of(mirrored), rounding.position * (1.0 + std::fabs(here)))
            << "case " << i;
        ASSERT_NEAR(ramp.velocity(), -mirrored.velocity(), rounding.velocity) << "case " << i;
      }
    }
  }
}

/// A hundred ticks of 50 us lead where one of 5 ms leads.
inline void check_traces_of_any_tick(base::Random& random, RandomLimits random_limits,
                                     const Rounding& rounding) {
  using namespace base::literals;
  for (int i = 0; i < 500; ++i) {
    const RampLimits limits = random_limits(random);
    const std::int64_t first = random_target(random);
    const std::int64_t second = random_target(random);
    RampGenerator fine;
    RampGenerator coarse;
    for (const std::int64_t target : {first, second}) {
      fine.move_to(target, limits);
      coarse.move_to(target, limits);
      for (int k = 0; k < 100; ++k) {
        fine.advance(50_us);
      }
      coarse.advance(5_ms);
      ASSERT_NEAR(distance(coarse.position(), fine.position()), 0.0,
                  rounding.position * (1.0 + std::fabs(position_of(coarse))))
          << "case " << i;
      ASSERT_NEAR(coarse.velocity(), fine.velocity(), rounding.velocity * limits.velocity)
          << "case " << i;
    }
  }
}

}  // namespace stator::control::tests
