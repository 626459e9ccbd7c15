#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "stator/drive/motion/reference_switches.hpp"

namespace stator::drive {

/// Where an axis was at an event. Both values are counted since power-on, so that naming the
/// position anew does not touch them.
struct CapturedPosition {
  std::int64_t motor_microsteps = 0;
  std::int64_t encoder_count = 0;
};

/// What a latch looks at, of any stage.
struct ReferenceSignals {
  SwitchLevels switches;
  std::int64_t encoder_count = 0;  ///< increments since power-on
  bool encoder_index = false;      ///< N channel level
  std::uint32_t encoder_index_passages = 0;
  std::int64_t encoder_index_count = 0;
};

template <typename Sensing>
[[nodiscard]] constexpr ReferenceSignals reference_signals(const Sensing& sensing) {
  return {.switches = switch_levels(sensing),
          .encoder_count = sensing.encoder_count,
          .encoder_index = sensing.encoder_index,
          .encoder_index_passages = sensing.encoder_index_passages,
          .encoder_index_count = sensing.encoder_index_count};
}

/// The latch of a motion controller chip: holds the position at which a switch was released or the
/// encoder's N channel became active. It looks at the signals in every step of the hardware, not
/// once per control period: a switch is caught within one step of travel, the N channel to the
/// count.
class PositionCapture {
 public:
  /// Waits until `which` has been seen pressed and then released. `then_index`: and from there on
  /// for the next index pulse, whose position is the one held.
  void arm_release(ReferenceSwitch which, bool then_index);
  /// Waits for the next index pulse; the one the encoder stands on does not count.
  void arm_index();
  /// Waits no longer and forgets what it holds.
  void disarm() {
    waits_for_ = Event::nothing;
    captured_.reset();
  }

  [[nodiscard]] bool armed() const { return waits_for_ != Event::nothing; }
  /// Empty from arming until the event.
  [[nodiscard]] const std::optional<CapturedPosition>& captured() const { return captured_; }

  /// The same, once.
  [[nodiscard]] std::optional<CapturedPosition> take() {
    return std::exchange(captured_, std::nullopt);
  }

  /// To be called in every step while armed. `index_used`: false if the axis has no encoder, whose
  /// N input is not looked at then.
  void observe(const ReferenceSignals& signals, const ReferenceSettings& settings, bool index_used,
               std::int64_t motor_microsteps);

 private:
  enum class Event : std::uint8_t { nothing, press, release, first_look_at_index, index };

  void look_at_index(const ReferenceSignals& signals, bool active_low);
  [[nodiscard]] std::optional<std::int64_t> index_pulse(const ReferenceSignals& signals,
                                                        bool active_low);

  Event waits_for_ = Event::nothing;
  ReferenceSwitch switch_ = ReferenceSwitch::home;
  bool then_index_ = false;
  std::uint32_t index_passages_ = 0;  ///< of the sensing seen last
  bool index_active_ = false;         ///< the same
  std::optional<CapturedPosition> captured_;
};

}  // namespace stator::drive
