#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace stator::mfc {

/// Shares of the time, 0 to 1, that the switches of a half bridge are on.
struct OnShare {
  double high_side = 0.0;
  double low_side = 0.0;
};

/// The registers 36 to 46, and whether there is an emergency.
struct PwmSettings {
  std::uint64_t configuration = 0;
  std::array<std::uint16_t, 4> duty{};
  std::array<std::uint16_t, 4> shift{};
  std::uint32_t marks = 0;
  std::uint8_t pulse_length = 0;
  bool emergency = false;
};

/// What the outputs of the PWM unit are at any tick of 10 ns while its settings stay, and when they
/// next change: functions of the tick, without going through those before (TMC8461 datasheet
/// L9756-L9935).
///
/// A half bridge is on where PWM requests it, less the pause before a switch is turned on: it waits
/// until the other one has been off for BBM ticks. That holds across changes of settings too.
class PwmGeometry {
 public:
  static constexpr std::size_t kChannels = 4;
  /// HS0, LS0 to HS3, LS3, then the pulses A, center, B, AB, zero.
  static constexpr std::size_t kOutputs = 13;
  static constexpr std::int64_t kNever = INT64_MAX;

  /// The new settings are in force from `tick` on, up to which the old ones were.
  void reconfigure(const PwmSettings& settings, std::int64_t tick);
  [[nodiscard]] const PwmSettings& settings() const { return settings_; }

  /// Counts of a period, 1 to 4096. With 1 (PWM_MAXCNT 0) the counter stands.
  [[nodiscard]] std::int64_t counts() const {
    return static_cast<std::int64_t>(settings_.configuration & 0x0FFF) + 1;
  }
  /// The counter at `tick`.
  [[nodiscard]] std::int64_t phase(std::int64_t tick) const;
  /// Level of an output, polarity included. `tick` is not before the last reconfigure().
  [[nodiscard]] bool output(std::size_t output, std::int64_t tick) const;
  /// First tick behind `tick` at which output() differs; kNever if there is none.
  [[nodiscard]] std::int64_t next_change(std::size_t output, std::int64_t tick) const;
  /// First tick behind `tick` at which the counter is at mark 0 zero, 1 center, 2 A, 3 B.
  [[nodiscard]] std::int64_t next_mark(std::size_t mark, std::int64_t tick) const;
  [[nodiscard]] OnShare on_share(std::size_t channel) const;

 private:
  enum Side : std::uint8_t { high_side = 0, low_side = 1 };
  /// Counts of a period in which PWM is on, beginning modulo the period.
  struct Window {
    std::int64_t begin = 0;
    std::int64_t length = 0;  ///< 0 to counts()
  };
  /// How a switch is controlled (Table 205).
  enum class Request : std::uint8_t { off, on, pwm, not_pwm };

  [[nodiscard]] bool stands() const { return counts() == 1; }
  [[nodiscard]] std::int64_t next_at(std::int64_t position, std::int64_t tick) const;
  [[nodiscard]] Window window(std::size_t channel) const;
  [[nodiscard]] Request request(std::size_t channel, Side side) const;
  [[nodiscard]] std::int64_t pause(Side side) const;
  [[nodiscard]] bool wanted(std::size_t channel, Side side, std::int64_t tick) const;
  /// Tick at which the request of a switch that is not wanted at `tick` has gone off.
  [[nodiscard]] std::int64_t off_since(std::size_t channel, Side side, std::int64_t tick) const;
  [[nodiscard]] bool gate(std::size_t channel, Side side, std::int64_t tick) const;
  [[nodiscard]] std::int64_t mark_position(std::size_t mark) const;
  [[nodiscard]] bool pulse(std::size_t mark, std::int64_t tick) const;

  PwmSettings settings_;
  std::int64_t zero_ = 0;        ///< a tick at which the counter is at 0
  std::int64_t changed_at_ = 0;  ///< tick of the last reconfigure()
  /// Per channel and side: tick at which its request had last gone off, seen from changed_at_.
  std::array<std::array<std::int64_t, 2>, kChannels> off_before_{
      {{kLongAgo, kLongAgo}, {kLongAgo, kLongAgo}, {kLongAgo, kLongAgo}, {kLongAgo, kLongAgo}}};
  static constexpr std::int64_t kLongAgo = -4096;  ///< before power-on by more than any pause
};

}  // namespace stator::mfc
