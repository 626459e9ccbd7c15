#pragma once

#include <cstdint>

#include "stator/control/foc/fixed_point.hpp"

namespace stator::control::foc {

/// How far an initialisation is, as INTERIM_DATA shows it.
enum class InitialisationStatus : std::uint8_t { idle = 0, running = 1, done = 2 };

/// Gives the encoder an electrical zero by the Hall sensors (L681, L893): at the first border
/// between two sectors after ENCODER_INIT_HALL_ENABLE was set, the offsets become those with which
/// ABN and analog encoder show the angle of that border.
class HallInitialisation {
 public:
  void enable(bool enabled, std::uint32_t edges) {
    if (enabled && status_ == InitialisationStatus::idle) {
      status_ = InitialisationStatus::running;
      edges_ = edges;
    } else if (!enabled) {
      status_ = InitialisationStatus::idle;
    }
  }
  [[nodiscard]] bool running() const { return status_ == InitialisationStatus::running; }
  /// A border was crossed since it was enabled: now is the moment.
  [[nodiscard]] bool due(std::uint32_t edges) const { return running() && edges != edges_; }
  void finish(std::int32_t abn_offset, std::int32_t aenc_offset, std::int32_t aenc_angle_offset) {
    status_ = InitialisationStatus::done;
    abn_offset_ = abn_offset;
    aenc_offset_ = aenc_offset;
    aenc_angle_offset_ = aenc_angle_offset;
  }

  [[nodiscard]] InitialisationStatus status() const { return status_; }
  [[nodiscard]] std::int32_t abn_offset() const { return abn_offset_; }
  [[nodiscard]] std::int32_t aenc_offset() const { return aenc_offset_; }
  [[nodiscard]] std::int32_t aenc_angle_offset() const { return aenc_angle_offset_; }

 private:
  InitialisationStatus status_ = InitialisationStatus::idle;
  std::uint32_t edges_ = 0;
  std::int32_t abn_offset_ = 0;
  std::int32_t aenc_offset_ = 0;
  std::int32_t aenc_angle_offset_ = 0;
};

/// Initialisation with minimal movement (L897, reading A-60). U_D rises by 1 in 8 periods up
/// to UD_EXT; whatever the encoder moves meanwhile turns the field the other way, several times as
/// far, so that the field comes to the rotor instead of the rotor to the field. A quick movement
/// counts more than a slow one, which keeps the rotor from swinging. One that stands exactly
/// opposite to the first field angle 0 does not move at all and is taken for aligned, as with any
/// method that looks for movement.
class MinimalMovement {
 public:
  void start() {
    status_ = InitialisationStatus::running;
    voltage_ = 0;
    waited_ = 0;
    field_ = 0;
    moved_ = 0;
    slow_ = 0;
  }
  void stop() {
    if (status_ == InitialisationStatus::running) {
      status_ = InitialisationStatus::idle;
    }
  }
  /// One period: the encoder's electrical angle has moved by `moved` (s16). True when done.
  bool step(std::int32_t moved, std::int32_t final_voltage) {
    constexpr std::int64_t kStiffness = 3;
    constexpr std::int64_t kLead = 3;       // of what is quicker than 32 periods
    constexpr std::int64_t kSlowness = 32;  // periods
    if (status_ != InitialisationStatus::running) {
      return false;
    }
    moved_ += moved;
    slow_ += moved_ - slow_ / kSlowness;
    field_ = wrap_s16(-kStiffness * (moved_ + kLead * (moved_ - slow_ / kSlowness)));
    if (voltage_ < final_voltage) {
      constexpr std::int32_t kPeriodsPerStep = 8;
      waited_ = (waited_ + 1) % kPeriodsPerStep;
      voltage_ += waited_ == 0 ? 1 : 0;
      return false;
    }
    status_ = InitialisationStatus::done;
    return true;
  }

  [[nodiscard]] InitialisationStatus status() const { return status_; }
  [[nodiscard]] std::int32_t voltage() const { return voltage_; }  ///< U_D
  [[nodiscard]] std::int32_t field() const { return field_; }      ///< electrical angle, s16

 private:
  InitialisationStatus status_ = InitialisationStatus::idle;
  std::int32_t voltage_ = 0;
  std::int32_t waited_ = 0;
  std::int32_t field_ = 0;
  std::int64_t moved_ = 0;  ///< electrical angle since the start
  std::int64_t slow_ = 0;   ///< the same, smoothed, times kSlowness
};

}  // namespace stator::control::foc
