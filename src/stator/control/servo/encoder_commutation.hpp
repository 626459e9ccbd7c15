#pragma once

#include <cstdint>

#include "stator/control/servo/electrical_angle.hpp"
#include "stator/control/servo/servo_settings.hpp"

namespace stator::control {

/// The electrical angle of the rotor from an incremental encoder, and how it is found after
/// power-on (TMCC160 2080h, A-45):
///   angle = (count - reference + offset) * pole pairs / steps per revolution
///
/// Initialisation runs in milliseconds and may need the motor to be driven open loop meanwhile:
/// - align: the field turns from -90 to 0 degrees in a quarter of the delay, so that a rotor in the
///   dead point at 180 degrees is drawn along, and stands for the rest of it; the rotor is then at
///   0. Fails when no current flows at its end.
/// - hall: the angle of the hall sensors (within 30 degrees), made exact at the next hall edge.
///   Fails without a valid code.
/// - index: the field turns until the N pulse comes, whose count is the reference. Fails when three
///   revolutions bring none, or with velocity 0.
/// The first two find the offset, with the count at power-on as reference 0.
class EncoderCommutation {
 public:
  /// What the initialisation sees each millisecond.
  struct Observation {
    bool hall_valid = false;
    ElectricalAngle hall_angle;
    std::uint32_t index_passages = 0;
    std::int64_t index_count = 0;  ///< as the sensor counts
    bool current_flows = false;    ///< of the field: at least half of what was wanted
  };
  /// How the field has to move while initialising(): from `angle` on, `step` per period.
  struct Field {
    ElectricalAngle angle;
    ElectricalAngle step;
  };

  void configure(const ServoControllerSettings& settings);

  void note(std::int64_t sensor_count) { count_ = reversed_ ? -sensor_count : sensor_count; }
  /// Counts forward since power-on.
  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] ElectricalAngle angle() const {
    return {
        static_cast<std::uint32_t>((static_cast<std::uint64_t>(count_ - zero_) * scale_) >> 32)};
  }

  /// Begins the initialisation; returns where the field begins.
  Field start(const Observation& seen);
  /// Lets a millisecond of it pass; returns true when the field is to be put to field().
  bool pass_millisecond(const Observation& seen);
  [[nodiscard]] Field field() const { return field_; }
  /// The hall sensors have just passed the edge at `edge`.
  void correct_at_hall_edge(ElectricalAngle edge) {
    if (awaits_edge_) {
      awaits_edge_ = false;
      place(edge);
    }
  }
  void forget() {
    phase_ = Phase::unknown;
    awaits_edge_ = false;
  }

  [[nodiscard]] bool initialised() const { return phase_ == Phase::known; }
  [[nodiscard]] bool initialising() const {
    return phase_ == Phase::aligning || phase_ == Phase::seeking_index;
  }
  [[nodiscard]] bool failed() const { return phase_ == Phase::failed; }
  [[nodiscard]] bool awaits_hall_edge() const { return awaits_edge_; }
  [[nodiscard]] std::uint16_t offset() const { return static_cast<std::uint16_t>(offset_); }

 private:
  enum class Phase : std::uint8_t { unknown, aligning, seeking_index, known, failed };

  void place(ElectricalAngle angle);
  void set_offset(std::int64_t offset);

  std::int64_t count_ = 0;
  std::int64_t zero_ = 0;    ///< count at angle 0
  std::uint64_t scale_ = 0;  ///< 2^64 electrical turns per count
  bool reversed_ = false;
  bool awaits_edge_ = false;
  Phase phase_ = Phase::unknown;
  EncoderInitMode mode_ = EncoderInitMode::hall;
  std::int64_t reference_ = 0;
  std::int64_t offset_ = 0;
  std::int64_t steps_ = 0;
  int pole_pairs_ = 0;
  std::uint16_t configured_offset_ = 0;
  std::uint32_t delay_ = 0;
  std::int32_t velocity_ = 0;
  std::uint32_t elapsed_ = 0;
  std::uint32_t passages_ = 0;
  Field field_;
};

}  // namespace stator::control
