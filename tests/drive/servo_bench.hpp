#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/event.hpp"
#include "base/servo_signals.hpp"
#include "base/sim_time.hpp"
#include "dictionary/dictionary.hpp"
#include "drive/servo_axis.hpp"

namespace stator::drive {

/// A motor with four pole pairs, resistance, inductance, flux and inertia, and what is on its
/// shaft: an encoder of 4000 counts, halls, hard stops, a load. 0.03 Nm/A, 24 V.
class ServoMotor {
 public:
  static constexpr double kCounts = 4000.0;  ///< per revolution

  void step(const base::ServoActuation& actuation);
  /// Everything but switches and supply.
  void read(base::ServoSensing& sensing) const;

  [[nodiscard]] double counts() const { return revolutions_ * kCounts; }
  [[nodiscard]] double rpm() const;
  /// Turned by hand.
  void turn_to(double counts) { revolutions_ = counts / kCounts; }
  void brake_hard() { speed_ = 0.0; }

  double load = 0.0;                 ///< Nm, positive drives forward
  bool blocked = false;              ///< the shaft does not turn
  std::optional<double> lower_stop;  ///< counts since power-on
  std::optional<double> upper_stop;

 private:
  void keep_between_stops();

  double revolutions_ = 1e-4;
  double speed_ = 0.0;  ///< rad/s
  double alpha_ = 0.0;  ///< A
  double beta_ = 0.0;
};

/// A servo axis with the objects of a TMCC160, its controller and a motor.
class ServoBench : public base::EventSink {
 public:
  ServoBench();

  void on_event(const base::Event& event) override {
    sentences.push_back(base::to_sentence(event));
  }

  /// Writes an object as an SDO does and lets the axis obey.
  void write(std::uint16_t index, std::int64_t value) { write(index, 0, value); }
  void write(std::uint16_t index, std::uint8_t subindex, std::int64_t value);
  [[nodiscard]] std::int64_t read(std::uint16_t index, std::uint8_t subindex = 0) const {
    return dictionary.find(index, subindex)->signed_value();
  }
  [[nodiscard]] bool status(std::uint16_t bit) const {
    return (static_cast<std::uint16_t>(read(0x6041)) & bit) != 0;
  }
  [[nodiscard]] bool flag(ServoFlag which) const { return axis->flags().has(which); }
  [[nodiscard]] bool told(const std::string& text) const;

  void pass(base::SimDuration duration);
  /// Passes time until `done` or for `longest`; returns whether it was done.
  template <typename Condition>
  bool pass_until(Condition done, base::SimDuration longest) {
    for (const base::SimTime end = now + longest; now < end;) {
      pass(base::SimDuration(1'000'000));
      if (done()) {
        return true;
      }
    }
    return false;
  }
  /// 6060h, then 6, 7, 15.
  void enable(ModeCode mode);
  /// Profile 6081h (rpm), 6083h, 6084h (rpm/s).
  void set_profile(std::int64_t velocity, std::int64_t acceleration, std::int64_t deceleration);
  /// With 15 and bit 4.
  void start() {
    write(0x6040, 0x0F);
    write(0x6040, 0x1F);
  }
  [[nodiscard]] double rpm() const { return motor.rpm(); }
  [[nodiscard]] std::int64_t position() const { return read(0x6064); }

  dictionary::Dictionary dictionary;
  std::unique_ptr<ServoAxis> axis;
  ServoMotor motor;
  base::ServoSensing sensing;
  base::ServoActuation actuation;
  std::vector<std::string> sentences;
  base::SimTime now;

  /// Pressed at and beyond these counts since power-on.
  std::optional<double> left_switch;
  std::optional<double> right_switch;

 private:
  void read_switches();
  int steps_to_tick_ = 0;
};

}  // namespace stator::drive
