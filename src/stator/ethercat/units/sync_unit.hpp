#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "stator/ethercat/registers/register_table.hpp"

namespace stator::ethercat {

/// What a SYNC output pin does electrically (0x0151 bits 1:0 and 5:4).
enum class PinLevel : std::uint8_t {
  low,
  high,
  released,  ///< open drain or open source: the board's resistor decides
};

/// The SYNC unit of the distributed clocks: SYNC0 and SYNC1 (registers 0x0980..0x09A7; TMC8461 and
/// TMC8670 datasheets "DC SYNC out unit"). Works on the controller's register memory.
///
/// All times are system time. Pulses are not simulated one by one: the unit knows the next pulse of
/// each output and its period, and advance() accounts for all that have come since, however many.
///
/// SYNC0 pulses come at start time + n * cycle time (0x09A0); a cycle time of 0 gives one pulse.
/// SYNC1 follows the first SYNC0 by 0x09A4 and repeats with the shortest whole multiple of the
/// SYNC0 cycle that is not below 0x09A4: each SYNC1 begins to wait for the next one at the next
/// SYNC0.
class SyncUnit {
 public:
  static constexpr std::size_t kOutputs = 2;

  /// What an activation has led to; the controller reports what a person should know.
  enum class Activation : std::uint8_t {
    none,       ///< nothing was activated
    waiting,    ///< the start time lies ahead
    immediate,  ///< plausibility check: not in the near future, pulses begin at once
    never,      ///< the start time is past, nothing checks it: no pulse until the time wraps
    disabled,   ///< the EEPROM keeps the unit switched off (0x0141 bit 2)
  };

  explicit SyncUnit(std::span<std::byte, kRegisterSpace> registers) : registers_(registers) {}

  /// As after power-on: inactive, no start time.
  void reset();

  /// Accounts for all pulses up to `now`; false if there were none.
  bool advance(std::uint64_t now);
  /// The system time was set to `now` by other means than its passing. Pulses that would have come
  /// in between come once, at once, and go on in their grid.
  void jump(std::uint64_t now);

  /// 0x0981 has been written at `now` with `written`; bit 7 is a debug pulse.
  Activation write_activation(std::uint8_t written, std::uint64_t now);
  /// The start time has been written, its lower half alone or whole, as far as one frame or one
  /// access of the host goes.
  Activation write_start_time(bool lower_half_only, std::uint64_t now);
  /// 0x09A0 or 0x09A4 has been written: valid behind the next pulse.
  void write_cycle_times();
  /// The host has taken notice of SYNC`output`: ends its signal in acknowledge mode.
  void acknowledge(std::size_t output) { signals_[output].held = false; }

  /// Brings 0x0984, 0x098E, 0x098F, 0x0990 and 0x0998 up to date.
  void show(std::uint64_t now);

  [[nodiscard]] bool active() const { return active_; }
  /// True if the host has to be told of pulses by an AL event that is not pending yet.
  [[nodiscard]] bool wants_pulse_in_time() const;
  /// When the next pulse of an enabled output comes; empty if none will.
  [[nodiscard]] std::optional<std::uint64_t> next_pulse(std::size_t output) const;
  /// Pulses since power-on.
  [[nodiscard]] std::uint64_t pulse_count(std::size_t output) const {
    return signals_[output].count;
  }
  /// The signal as the host's logic means it: true while a pulse lasts.
  [[nodiscard]] bool asserted(std::size_t output, std::uint64_t now) const;
  /// The pin, which 0x0151 may have given to the latch unit.
  [[nodiscard]] PinLevel pin(std::size_t output, std::uint64_t now) const;
  /// DC SYNC0 and SYNC1 of the AL event request: acknowledge mode only, if mapped by 0x0151.
  [[nodiscard]] std::uint32_t al_events() const;

 private:
  struct Signal {
    bool enabled = false;        ///< 0x0981 bit 1 or 2
    bool armed = false;          ///< `next` is ahead
    bool first_pending = false;  ///< enabled, no pulse yet
    bool held = false;           ///< acknowledge mode: pulse not acknowledged yet
    std::uint64_t next = 0;
    std::uint64_t period = 0;  ///< 0: single shot
    std::uint64_t last = 0;
    std::uint64_t count = 0;
  };

  [[nodiscard]] unsigned byte(std::size_t address) const {
    return std::to_integer<unsigned>(registers_[address]);
  }
  [[nodiscard]] std::uint64_t pulse_length() const;
  [[nodiscard]] bool mapped(std::size_t output) const;
  Activation activate(std::uint64_t now);
  void deactivate();
  void enable_outputs();
  void take_periods();
  void fire(Signal& signal, std::uint64_t pulses, std::uint64_t last) const;
  /// True while the start time is past and only a jump backwards could bring it ahead again.
  [[nodiscard]] bool waits_for_wrap(std::uint64_t now);

  std::span<std::byte, kRegisterSpace> registers_;
  std::array<Signal, kOutputs> signals_{};
  std::uint64_t start_time_ = 0;  ///< as written
  std::uint32_t sync0_cycle_ = 0;
  std::uint32_t sync1_cycle_ = 0;
  bool active_ = false;
  bool start_is_past_ = false;
  bool out_of_near_future_ = false;
};

}  // namespace stator::ethercat
