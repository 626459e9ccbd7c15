// A TMCC160 whose stops and moves are judged by its shaft instead of by its own objects.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/tmcc160_module.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"

namespace stator::devices {

enum DriveMode : std::int8_t { kPosition = 1, kVelocity = 3, kTorque = 10 };
inline constexpr unsigned kTargetReached = 1U << 10;
inline constexpr unsigned kLimited = 1U << 11;
inline constexpr std::uint16_t kRun = 0x0F;
inline constexpr std::uint16_t kNewSetPoint = 0x1F;
inline constexpr std::uint16_t kHalt = 0x10F;
inline constexpr std::uint16_t kQuickStop = 0x02;
inline constexpr std::uint16_t kDisableOperation = 0x07;
inline constexpr double kHallSteps = 24.0;  ///< per revolution
inline constexpr double kEncoderSteps = 4000.0;
inline constexpr double kStanding = 25.0;  ///< rpm; a shaft that halls hold swings by less
inline constexpr int kUnseen = 50;         ///< ms; at 60 rpm a hall edge comes every 42

/// What is looked at in every stop, from the command on.
struct Stop {
  double rpm = 0.0;           ///< at the command
  double milliseconds = 0.0;  ///< until it stays within a seventh of a revolution of its last place
  double revolutions = 0.0;   ///< the farthest it got from where it was, in its direction
  double largest_rpm = 0.0;
  double final_rpm = 0.0;
  double rpm_at_power_off = 0.0;  ///< 0 while the power stays on
  int untrue_bit_10 = 0;          ///< ms, the longest while with bit 10 and more than 60 rpm
  double steepest_demand = 0.0;   ///< rpm/ms, by which 2040h:03 changed
  double highest_supply = 0.0;    ///< V
  unsigned status = 0;            ///< at the end
  bool limited_at_end = false;    ///< bit 11
  bool fault = false;             ///< seen in between
};

/// A TMCC160 with the motor and the gains it comes with; limit switches unused unless fitted.
class ShaftDrive : public tests::Tmcc160Module {
 public:
  explicit ShaftDrive(double steps = kHallSteps, const Tmcc160Configuration& configuration = {})
      : Tmcc160Module(configuration), steps_per_revolution(steps) {
    boot(true);
    if (steps == kEncoderSteps) {
      put(0x2055, 0, 7);
    }
    if (!configuration.axis.right_switch.fitted && !configuration.axis.left_switch.fitted) {
      put(0x2005, 0, 3);
    }
  }
  void put(std::uint16_t index, std::uint8_t subindex, double value) {
    EXPECT_EQ(write(index, subindex, static_cast<std::int64_t>(value)), kNoError)
        << std::hex << index;
  }
  void start(DriveMode mode) {
    put(0x6060, 0, mode);
    for (const unsigned word : {0x06U, 0x07U, 0x0FU}) {
      control(static_cast<std::uint16_t>(word));
      wait(3);
    }
    wait(steps_per_revolution == kEncoderSteps ? 100 : 5);  // the commutation is found
    ASSERT_EQ(state(), 0x27U);
  }
  void move_by(double revolutions) {
    put(0x607A, 0, std::round(revolutions * steps_per_revolution) + value(0x6064));
    control(kRun);
    control(kNewSetPoint);
  }
  void ramps(double rpm_per_second) {
    put(0x2020, 3, rpm_per_second);
    put(0x6083, 0, rpm_per_second);
    put(0x6084, 0, rpm_per_second);
    put(0x6085, 0, rpm_per_second);
  }
  double value(std::uint16_t index, std::uint8_t subindex = 0) {
    return static_cast<double>(device->dictionary().find(index, subindex)->signed_value());
  }
  unsigned status() { return static_cast<unsigned>(device->dictionary().find(0x6041, 0)->value()); }
  double rpm() { return 60.0 * signal("axis0.shaft_speed"); }
  double revolutions() { return signal("axis0.shaft_position"); }
  double demand() {
    static_cast<void>(read(0x2040, 3));
    return value(0x2040, 3);
  }
  bool powered() {
    const unsigned word = status();
    return (word & 0x6FU) == 0x27U || (word & 0x6FU) == 0x07U || (word & 0x4FU) == 0x0FU;
  }
  bool faulty() { return (status() & 8U) != 0; }

  /// Records what follows a command that has just been given.
  Stop watch(int milliseconds) {
    Stop stop;
    stop.rpm = rpm();
    const double direction = stop.rpm < 0.0 ? -1.0 : 1.0;
    const double begin = revolutions();
    double previous = demand();
    bool was_powered = powered();
    int untrue = 0;
    std::vector<double> places;
    for (int passed = 1; passed <= milliseconds; ++passed) {
      wait(1);
      const double now_rpm = rpm();
      places.push_back(revolutions());
      stop.largest_rpm = std::max(stop.largest_rpm, std::abs(now_rpm));
      stop.revolutions = std::max(stop.revolutions, direction * (revolutions() - begin));
      untrue = (status() & kTargetReached) != 0 && std::abs(now_rpm) > 60.0 ? untrue + 1 : 0;
      stop.untrue_bit_10 = std::max(stop.untrue_bit_10, untrue);
      if (was_powered && !powered()) {
        stop.rpm_at_power_off = std::abs(now_rpm);
      }
      was_powered = powered();
      const double next = demand();
      if (was_powered) {
        stop.steepest_demand = std::max(stop.steepest_demand, std::abs(next - previous));
      }
      previous = next;
      stop.highest_supply = std::max(stop.highest_supply, signal("axis0.supply_voltage"));
      stop.fault = stop.fault || faulty();
    }
    const auto moving = std::find_if(places.rbegin(), places.rend(), [&](double place) {
      return std::abs(place - places.back()) > 1.0 / 7.0;
    });
    stop.milliseconds = static_cast<double>(places.rend() - moving);
    stop.final_rpm = rpm();
    stop.status = status();
    stop.limited_at_end = (stop.status & kLimited) != 0;
    return stop;
  }

  double steps_per_revolution;
};

/// The shaft stands within the time of the ramp and 20 %, over the ramp's way and 20 %; nobody is
/// told before that it stands, and the power is on until then. `settling`: ms in which the
/// controllers, with the gains as delivered, bring it to rest; `yielding`: revolutions by which
/// they give way to a load meanwhile.
inline void expect_ramp(const Stop& stop, double rpm_per_second, double settling = 100.0,
                        double yielding = 0.3) {
  const double speed = std::abs(stop.rpm);
  EXPECT_LE(stop.milliseconds, 1.2e3 * speed / rpm_per_second + settling);
  EXPECT_LE(stop.revolutions, 1.2 * speed * speed / rpm_per_second / 120.0 + yielding);
  EXPECT_LE(stop.largest_rpm, 1.1 * speed + 60.0) << "no faster than it was";
  EXPECT_LE(stop.untrue_bit_10, kUnseen) << "bit 10 tells of a shaft that stands";
  EXPECT_LE(stop.rpm_at_power_off, 60.0) << "the power goes when the shaft stands";
  EXPECT_LE(std::abs(stop.final_rpm), kStanding);
}

/// Under way to 50 revolutions with 500 rpm the shaft is jammed for 8 s.
inline void jam_under_way(ShaftDrive& drive) {
  drive.start(kPosition);
  drive.put(0x6081, 0, 500);
  drive.move_by(50.0);
  drive.wait(350);
  drive.set("axis0.jammed", 1);
  drive.wait(8'000);
  ASSERT_LT(drive.revolutions(), 5.0);
}

}  // namespace stator::devices
