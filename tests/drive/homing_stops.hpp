#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>

#include <gtest/gtest.h>

#include "drive/object_bench.hpp"
#include "sanitized.hpp"
#include "stator/drive/power/control_words.hpp"
#include "stator/drive/power/power_state_machine.hpp"

namespace stator::drive {

/// What stops a homing run.
enum class HomingStop : std::uint8_t {
  bit_four,
  halt_slow_down,
  halt_quick_stop,
  quick_stop,
  quick_stop_and_stay,
  shutdown,
  disable,
  mode,
  network,
  fault,
};

constexpr const char* name_of(HomingStop stop) {
  switch (stop) {
    case HomingStop::bit_four:
      return "bit 4";
    case HomingStop::halt_slow_down:
      return "halt 1";
    case HomingStop::halt_quick_stop:
      return "halt 2";
    case HomingStop::quick_stop:
      return "quick stop 2";
    case HomingStop::quick_stop_and_stay:
      return "quick stop 6";
    case HomingStop::shutdown:
      return "shutdown";
    case HomingStop::disable:
      return "disable operation";
    case HomingStop::mode:
      return "change of mode";
    case HomingStop::network:
      return "loss of the network";
    case HomingStop::fault:
      return "fault";
  }
  return "?";
}

/// Homing on a bench of a servo axis, with 605Bh = 1. `Bench` has rpm(), turned() in revolutions,
/// home() in revolutions where positions are 0, strongest() in rpm/s that its torque can brake
/// with, and set_fault() with a cause that brakes.
template <typename Bench>
class StoppedHoming : public Bench {
 public:
  static constexpr unsigned kReached = statusword::kTargetReached;
  static constexpr unsigned kAttained = statusword::kTargetReached | statusword::kHomeAttained;
  static constexpr double kHomingRamp = 4000.0;     ///< rpm/s, 609Ah
  static constexpr double kQuickStopRamp = 8000.0;  ///< rpm/s, 6085h

  explicit StoppedHoming(int method) : Bench(method) {
    this->write(0x605B, 1);
    this->write(0x609A, static_cast<std::int64_t>(kHomingRamp));
    this->write(0x6085, static_cast<std::int64_t>(kQuickStopRamp));
    this->write(0x6098, method);
    this->enable(ModeCode::homing);
    this->write(0x6040, 0x1F);
  }

  /// Bits 10, 12 and 13; none in another mode.
  [[nodiscard]] unsigned bits() const {
    if (this->read(0x6061) != 6) {
      return 0;
    }
    return static_cast<unsigned>(this->read(0x6041)) & (kAttained | statusword::kHomingError);
  }
  [[nodiscard]] bool attained() {
    return this->pass_until([&] { return bits() == kAttained; }, base::SimDuration(10'000'000'000));
  }

  /// Stops the run now, and looks at how it comes to rest.
  void expect_rest(HomingStop stop) {
    const double begin = std::fabs(this->rpm());
    const double ramp = std::min(ramp_of(stop), this->strongest());
    const double longest = 1.2 * begin / ramp + 0.06;  // s
    double fastest = 0.0;
    double time_to_stand = 0.0;
    command(stop);
    for (double time = 0.0; time < 0.3; time += 1e-3) {
      const bool powered = this->axis->bridge_enabled();
      const double before = std::fabs(this->rpm());
      this->pass(milliseconds(1));
      if (powered && !this->axis->bridge_enabled()) {
        EXPECT_LE(before, Bench::kStands) << "the power goes off";
      }
      fastest = std::max(fastest, std::fabs(this->rpm()));
      EXPECT_EQ(bits() & ~kReached, 0U) << "neither home nor an error";
      if (std::fabs(this->rpm()) > Bench::kStands) {
        time_to_stand = time;
        EXPECT_EQ(bits(), 0U) << "at " << this->rpm() << " rpm";
      }
    }
    EXPECT_LE(fastest, begin + 40.0);
    EXPECT_LE(time_to_stand, longest);
    if (stop != HomingStop::mode) {
      EXPECT_TRUE(this->pass_until([&] { return bits() == kReached; }, milliseconds(50)));
    }
    const double stood = this->turned();
    this->pass(milliseconds(100));
    EXPECT_NEAR(this->turned(), stood, 0.01);
  }
  /// Up to the start of the next run, or to the end of halt.
  void go_on(HomingStop stop) {
    switch (stop) {
      case HomingStop::halt_slow_down:
      case HomingStop::halt_quick_stop:
        this->write(0x6040, 0x1F);
        return;
      case HomingStop::mode:
        this->write(0x6060, 6);
        this->pass(milliseconds(20));
        EXPECT_FALSE(this->axis->homing()) << "bit 4 has not risen";
        break;
      case HomingStop::network:
        this->axis->conditions().network_operational = true;
        break;
      case HomingStop::fault:
        this->set_fault(false);
        this->pass(milliseconds(2));
        this->write(0x6040, 0x80);
        break;
      default:
        break;
    }
    for (const int word : {0x06, 0x07, 0x0F}) {
      if (this->axis->power_state() != PowerState::operation_enabled) {
        this->write(0x6040, word);
        this->pass(milliseconds(2));
      }
    }
    this->write(0x6040, 0x0F);
    this->write(0x6040, 0x1F);
  }

 private:
  static constexpr base::SimDuration milliseconds(std::int64_t n) {
    return base::SimDuration(n * 1'000'000);
  }

  static double ramp_of(HomingStop stop) {
    switch (stop) {
      case HomingStop::halt_quick_stop:
      case HomingStop::quick_stop:
      case HomingStop::quick_stop_and_stay:
      case HomingStop::network:
      case HomingStop::fault:
        return kQuickStopRamp;
      default:
        return kHomingRamp;
    }
  }
  void command(HomingStop stop) {
    switch (stop) {
      case HomingStop::bit_four:
        this->write(0x6040, 0x0F);
        break;
      case HomingStop::halt_slow_down:
      case HomingStop::halt_quick_stop:
        this->write(0x605D, stop == HomingStop::halt_slow_down ? 1 : 2);
        this->write(0x6040, 0x11F);
        break;
      case HomingStop::quick_stop:
      case HomingStop::quick_stop_and_stay:
        this->write(0x605A, stop == HomingStop::quick_stop ? 2 : 6);
        this->write(0x6040, 0x02);
        break;
      case HomingStop::shutdown:
        this->write(0x6040, 0x16);
        break;
      case HomingStop::disable:
        this->write(0x6040, 0x17);
        break;
      case HomingStop::mode:
        this->write(0x60FF, 0);
        this->write(0x6060, 3);
        break;
      case HomingStop::network:
        this->axis->network_left_operational(this->now);
        break;
      case HomingStop::fault:
        this->set_fault(true);
        break;
    }
  }
};

/// In moments spread over an undisturbed run, each of `stops` in turn; below sanitizers
/// each in one of the moments.
template <typename Bench>
void expect_rest_in_every_stage(int method, std::initializer_list<HomingStop> stops) {
  StoppedHoming<Bench> undisturbed(method);
  const base::SimTime began = undisturbed.now;
  ASSERT_TRUE(undisturbed.attained());
  const base::SimDuration takes = undisturbed.now - began;
  constexpr int kMoments = 5;
  int first = 1;
  int last = kMoments - 1;
  for (const HomingStop stop : stops) {
    if (stator::tests::kSanitized) {
      last = first = 1 + first % (kMoments - 1);
    }
    for (int moment = first; moment <= last; ++moment) {
      SCOPED_TRACE(testing::Message() << name_of(stop) << " at " << moment << "/" << kMoments);
      StoppedHoming<Bench> run(method);
      run.pass(base::SimDuration(takes.nanoseconds() * moment / kMoments));
      run.expect_rest(stop);
      run.go_on(stop);
      ASSERT_TRUE(run.attained());
      run.pass(base::SimDuration(100'000'000));
      double away = run.home() - undisturbed.home();
      if (method == 33 || method == 34) {
        away = std::remainder(away, 1.0);  // the next index may be another one
      }
      EXPECT_NEAR(away, 0.0, method < 0 ? 0.02 : 0.003);
    }
  }
}

}  // namespace stator::drive
