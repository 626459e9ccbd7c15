#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/event.hpp"
#include "base/sim_time.hpp"
#include "dictionary/dictionary.hpp"
#include "drive/stepper_axis.hpp"

namespace stator::drive {

/// A CiA 402 axis with the objects it needs and an ideal motor: the encoder follows the set-point
/// unless the shaft is blocked, and switches and index marks may be fitted along its way.
class AxisBench : public base::EventSink {
 public:
  static constexpr std::int64_t kCountsPerRevolution = 51'200;  // one count per microstep

  AxisBench();

  void on_event(const base::Event& event) override {
    sentences.push_back(base::to_sentence(event));
  }

  /// Writes an object as an SDO does and lets the axis obey.
  void write(std::uint16_t index, std::int64_t value) { write(index, 0, value); }
  void write(std::uint16_t index, std::uint8_t subindex, std::int64_t value);
  /// Writes without letting the axis obey, as the objects of one process data frame arrive.
  void place(std::uint16_t index, std::int64_t value);
  [[nodiscard]] std::int64_t read(std::uint16_t index, std::uint8_t subindex = 0) const {
    return dictionary.find(index, subindex)->signed_value();
  }
  /// 6062h, 6063h and 6064h show `position`.
  [[nodiscard]] bool all_positions_are(std::int64_t position) const {
    return read(0x6062) == position && read(0x6063) == position && read(0x6064) == position;
  }
  [[nodiscard]] bool status(std::uint16_t bit) const {
    return (static_cast<std::uint16_t>(read(0x6041)) & bit) != 0;
  }

  void pass(base::SimDuration duration);
  /// From the next step on, V.
  void supply_voltage(double voltage) { sensing_.supply_voltage = voltage; }
  /// Profile 6081h, 6083h, 6084h.
  void set_profile(std::int64_t velocity, std::int64_t acceleration, std::int64_t deceleration);
  /// 6060h, then 6, 7, 15.
  void enable(ModeCode mode);
  [[nodiscard]] double position() const {
    const auto& exact = axis->motion().ramp().position();
    return static_cast<double>(exact.microsteps) + exact.fraction;
  }
  [[nodiscard]] double velocity() const { return axis->motion().velocity(); }

  dictionary::Dictionary dictionary;
  std::unique_ptr<StepperAxis> axis;
  std::vector<std::string> sentences;
  base::SimTime now;
  bool blocked = false;  ///< the shaft does not turn
  base::AxisActuation actuation;

  /// Pressed from..to, microsteps since power-on, both inclusive.
  struct Cam {
    std::int64_t from;
    std::int64_t to;
  };
  std::optional<Cam> left_switch;
  std::optional<Cam> right_switch;
  std::optional<Cam> home_switch;
  std::optional<std::int64_t> index_mark;  ///< one of the marks, microsteps since power-on
  /// Where the shaft stands, microsteps since power-on.
  [[nodiscard]] std::int64_t shaft() const { return sensing_.encoder_count; }

 private:
  void turn_shaft(std::int64_t microsteps);
  void read_switches();

  base::AxisSensing sensing_;
  std::int64_t microsteps_seen_ = 0;
  int steps_to_tick_ = 0;
};

}  // namespace stator::drive
