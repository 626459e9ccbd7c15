#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "drive/object_bench.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/drive/stepper/stepper_axis.hpp"

namespace stator::drive {

/// A CiA 402 axis with the objects it needs and an ideal motor: the encoder follows the set-point
/// unless the shaft is blocked, and switches and index marks may be fitted along its way.
class AxisBench : public ObjectBench {
 public:
  static constexpr std::int64_t kCountsPerRevolution = 51'200;  // one count per microstep

  AxisBench();

  /// Writes without letting the axis obey, as the objects of one process data frame arrive.
  void place(std::uint16_t index, std::int64_t value);
  /// 6062h, 6063h and 6064h show `position`.
  [[nodiscard]] bool all_positions_are(std::int64_t position) const {
    return read(0x6062) == position && read(0x6063) == position && read(0x6064) == position;
  }

  void pass(base::SimDuration duration) override;
  /// From the next step on, V.
  void supply_voltage(double voltage) { sensing_.supply_voltage = voltage; }
  /// 6060h, then 6, 7, 15.
  void enable(ModeCode mode);
  [[nodiscard]] double position() const {
    const auto& exact = axis->motion().ramp().position();
    return static_cast<double>(exact.microsteps) + exact.fraction;
  }
  [[nodiscard]] double velocity() const { return axis->motion().velocity(); }

  std::unique_ptr<StepperAxis> axis;
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
  void obey() override;
  void turn_shaft(std::int64_t microsteps);
  void read_switches();

  base::AxisSensing sensing_;
  std::int64_t microsteps_seen_ = 0;
  int steps_to_tick_ = 0;
};

}  // namespace stator::drive
