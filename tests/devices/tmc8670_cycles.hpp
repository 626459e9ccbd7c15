// A TMC8670 as in racks/ethercat-servo.toml with a master that exchanges process data every
// millisecond.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "devices/tmc8670_chip.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"

namespace stator::devices {

inline constexpr std::int32_t kTurn = 65'536;
inline constexpr std::uint16_t kReached = 1U << 10;
inline constexpr std::uint16_t kLimited = 1U << 11;
inline constexpr std::uint16_t kFollows = 1U << 12;

/// The device of racks/ethercat-servo.toml.
inline Tmc8670Configuration servo() {
  Tmc8670Configuration configuration = tuned_chip();
  configuration.axis.inverter.dead_time = 2e-7;
  configuration.objects.insert(configuration.objects.end(), {{0x2040, 1, 28'000},
                                                             {0x2040, 2, 27'000},
                                                             {0x6065, 0, 65'536},
                                                             {0x6066, 0, 100},
                                                             {0x6067, 0, 100},
                                                             {0x6068, 0, 10},
                                                             {0x6098, 0, 34}});
  return configuration;
}

/// What a laboratory sees at the end of a bus cycle.
struct Sample {
  double revolutions = 0.0;
  double rpm = 0.0;
  bool powered = false;
  std::uint16_t statusword = 0;
};

/// A master with process data every millisecond.
class Tmc8670Cycles : public Tmc8670Chip {
 protected:
  Tmc8670Cycles() : Tmc8670Chip(servo()) { go_operational(); }

  /// Writes the process data and lets `duration` pass in cycles of a millisecond.
  void cycle(base::SimDuration duration) {
    for (const base::SimTime end = bus_->now() + duration; bus_->now() < end;) {
      base::store_le(bus_->outputs, 0, controlword_);
      base::store_le(bus_->outputs, 2, mode_);
      base::store_le(bus_->outputs, 3, position_);
      base::store_le(bus_->outputs, 7, velocity_);
      base::store_le(bus_->outputs, 11, torque_);
      bus_->exchange();
      bus_->pass(1_ms - 20_us);
      watch();
    }
  }
  /// The same without a master.
  void wait(base::SimDuration duration) {
    for (const base::SimTime end = bus_->now() + duration; bus_->now() < end;) {
      bus_->pass(1_ms);
      watch();
    }
  }
  template <typename Condition>
  bool cycle_until(Condition done, base::SimDuration longest) {
    for (const base::SimTime end = bus_->now() + longest; bus_->now() < end;) {
      cycle(1_ms);
      if (done()) {
        return true;
      }
    }
    return false;
  }
  void enable_in(std::int8_t mode) {
    mode_ = mode;
    for (const int word : {6, 7, 15}) {
      controlword_ = static_cast<std::uint16_t>(word);
      cycle(5_ms);
    }
  }
  void command(int controlword) { controlword_ = static_cast<std::uint16_t>(controlword); }
  void move_to(std::int32_t target) {
    position_ = target;
    command(0x1F);
    cycle(1_ms);
    command(0x0F);
  }
  void watch() {
    trace_.push_back({.revolutions = signal("axis0.shaft_position"),
                      .rpm = signal("axis0.shaft_speed") * 60.0,
                      .powered = signal("axis0.enable_out") != 0.0,
                      .statusword = static_cast<std::uint16_t>(signal("axis0.statusword"))});
  }
  [[nodiscard]] const Sample& seen() const { return trace_.back(); }
  [[nodiscard]] bool has(std::uint16_t bit) const { return (seen().statusword & bit) != 0; }

  /// The trace starts anew.
  void forget() {
    const Sample latest = seen();
    trace_ = {latest};
  }
  /// rpm that the shaft was never faster than.
  [[nodiscard]] double fastest() const {
    double result = 0.0;
    for (const Sample& sample : trace_) {
      result = std::max(result, std::fabs(sample.rpm));
    }
    return result;
  }
  /// rpm at which the power went off; 0 if it did not.
  [[nodiscard]] double speed_at_power_off() const {
    for (std::size_t k = 1; k < trace_.size(); ++k) {
      if (!trace_[k].powered && trace_[k - 1].powered) {
        return std::fabs(trace_[k - 1].rpm);
      }
    }
    return 0.0;
  }
  /// rpm at which target reached came; 0 if it did not.
  [[nodiscard]] double speed_at_target_reached() const {
    for (const Sample& sample : trace_) {
      if ((sample.statusword & kReached) != 0) {
        return std::fabs(sample.rpm);
      }
    }
    return 0.0;
  }
  /// s from the start of the trace until the shaft stands for good.
  [[nodiscard]] double time_to_stand() const {
    std::size_t last = 0;
    for (std::size_t k = 0; k < trace_.size(); ++k) {
      if (std::fabs(trace_[k].rpm) > kStands) {
        last = k;
      }
    }
    return 1e-3 * static_cast<double>(last);
  }
  /// Revolutions from the start of the trace, largest on the way.
  [[nodiscard]] double travelled() const {
    double result = 0.0;
    for (const Sample& sample : trace_) {
      result = std::max(result, std::fabs(sample.revolutions - trace_.front().revolutions));
    }
    return result;
  }
  /// The trace is a stop: no faster than it began, on a ramp of `deceleration` rpm/s with a fifth
  /// and `more` s over, and the power goes off when the shaft stands, if it does.
  void expect_stop(double deceleration, double more = 0.03) {
    const double begin = std::fabs(trace_.front().rpm);
    const double time = begin / deceleration;
    EXPECT_LE(fastest(), begin + 120.0);
    EXPECT_LE(time_to_stand(), 1.2 * time + more);
    EXPECT_LE(travelled(), 1.2 * begin / 60.0 * (time / 2.0) + begin / 60.0 * more + 0.05);
    EXPECT_LE(speed_at_power_off(), kStands);
  }
  [[nodiscard]] std::int32_t actual() { return read<std::int32_t>(0x6064); }
  /// Largest change of the shaft's velocity, rpm/s, over ten cycles.
  [[nodiscard]] double steepest() const {
    double result = 0.0;
    for (std::size_t k = 10; k < trace_.size(); ++k) {
      result = std::max(result, std::fabs(trace_[k].rpm - trace_[k - 10].rpm) * 100.0);
    }
    return result;
  }

  static constexpr double kStands = 20.0;  ///< rpm: magnets let it swing without power

  std::uint16_t controlword_ = 0;
  std::int8_t mode_ = 0;
  std::int32_t position_ = 0;
  std::int32_t velocity_ = 0;
  std::int16_t torque_ = 0;
  std::vector<Sample> trace_;
};

}  // namespace stator::devices
