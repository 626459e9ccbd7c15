#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/mfc/pins/configuration.hpp"
#include "stator/mfc/pins/crossbar.hpp"

namespace stator::mfc {

/// What the outside does to a pin.
struct OutsideDrive {
  enum class Kind : std::uint8_t {
    open,     ///< nothing is connected
    low,      ///< ground
    high,     ///< the pin's supply
    voltage,  ///< `millivolts`
  };
  Kind kind = Kind::open;
  std::int32_t millivolts = 0;

  static constexpr OutsideDrive level(bool high) { return {high ? Kind::high : Kind::low, 0}; }
  static constexpr OutsideDrive voltage(std::int32_t millivolts) {
    return {Kind::voltage, millivolts};
  }
};

/// A wiring fault at a pin, stronger than every driver.
enum class Short : std::uint8_t { none, to_ground, to_supply };

/// What a pin shows to an instrument.
enum class PinState : std::uint8_t { low, high, floating };

/// What the chip wants of a pin.
struct PinCommand {
  bool driven = false;
  bool level = false;
  friend constexpr bool operator==(PinCommand, PinCommand) = default;
};

/// The 24 pins between the chip's logic and the world (TMC8461 datasheet L8415-L8445,
/// L10299-L10375, L10548-L10652). MFCIO00..15 are 3.3 V logic, MFC_HV0..7 have supplies of their
/// own, weak drivers, slow slopes with filtered inputs, differential inputs and short protection.
///
/// Who wins at a pin: a short, then the chip's driver, then the outside, then the chip's weak
/// driver; an open pin is low (T61-HV-005, G-31). Edges take no time; slope() says how long they
/// would.
///
/// A value that passes through time: bring it to the present with advance() before changing it.
class Pads {
 public:
  static constexpr std::size_t kSupplies = 3;         ///< VIO1: HV0, 1; VIO2: HV2..4; VIO3: HV5..7
  static constexpr std::int32_t kLogicSupply = 3300;  ///< mV
  static constexpr std::int32_t kDefaultSupply = 24'000;  ///< mV
  static constexpr std::int32_t kLeastSupply = 3000;      ///< mV; below, drivers are off (A-79)
  static constexpr std::int32_t kHighVoltageMode =
      6000;                                          ///< mV from which on thresholds follow VIO
  static constexpr base::SimDuration kFilter{1000};  ///< of slow inputs (L10604)
  /// From an over-current of some 200 mA to switching off (L10586-L10594; G-32).
  static constexpr base::SimDuration kSwitchOff{10'000};

  Pads();

  void advance(base::SimTime to) {
    if (next_event_ <= to) {
      make_events(to);
    }
    now_ = to > now_ ? to : now_;
  }
  /// When a filtered input changes or a driver switches off next.
  [[nodiscard]] base::SimTime next_event() const { return next_event_; }

  /// HVIO_CFG.
  void configure(std::uint32_t configuration);
  void set_supply(std::size_t supply, std::int32_t millivolts);
  [[nodiscard]] std::int32_t supply(std::size_t supply) const { return supplies_[supply]; }
  void drive(std::size_t line, OutsideDrive outside);
  void set_short(std::size_t line, Short fault);
  void command(std::size_t line, PinCommand command);
  /// Every pin as after a reset of the chip; the outside stays.
  void reset();

  [[nodiscard]] PinCommand command(std::size_t line) const { return pins_[line].command; }
  [[nodiscard]] OutsideDrive outside(std::size_t line) const { return pins_[line].outside; }
  [[nodiscard]] Short short_at(std::size_t line) const { return pins_[line].fault; }
  /// mV at the pin.
  [[nodiscard]] std::int32_t voltage(std::size_t line) const { return pins_[line].millivolts; }
  [[nodiscard]] PinState state(std::size_t line) const;
  /// The chip's driver is on, weak or not.
  [[nodiscard]] bool driving(std::size_t line) const;
  /// Levels that the chip's logic sees, filters and differential pairs included.
  [[nodiscard]] LineSet inputs() const { return inputs_; }
  /// Time from 10 to 90 % of an edge that the chip makes (L10596-L10602).
  [[nodiscard]] base::SimDuration slope(std::size_t line) const;

  /// HV_ANA_STATUS 23:0: high voltage, shorts to ground, shorts to supply (L7853-L7875).
  [[nodiscard]] std::uint32_t status() const;

 private:
  struct Pin {
    PinCommand command;
    OutsideDrive outside;
    Short fault = Short::none;
    bool switched_off = false;  ///< by over-current, until the commanded level changes
    bool compared = false;      ///< what the comparator says
    std::int32_t millivolts = 0;
    base::SimTime switch_off_at = base::SimTime::never();
    base::SimTime filtered_at = base::SimTime::never();
  };
  static constexpr bool high_voltage(std::size_t line) { return line >= kFirstHighVoltage; }
  [[nodiscard]] bool setting(unsigned byte, std::size_t line) const {
    return high_voltage(line) &&
           (configuration_ >> (std::size_t{8} * byte + line - kFirstHighVoltage) & 1U) != 0;
  }
  [[nodiscard]] std::int32_t supply_of(std::size_t line) const;
  [[nodiscard]] bool weak(std::size_t line) const;
  [[nodiscard]] std::int32_t resolve(std::size_t line) const;
  [[nodiscard]] bool over_current(std::size_t line) const;
  [[nodiscard]] bool compare(std::size_t line) const;
  [[nodiscard]] std::size_t partner(std::size_t line) const;
  void make_events(base::SimTime to);
  void settle(std::size_t line);
  void settle_all();
  void observe(std::size_t line);
  void update_next_event();

  std::array<Pin, kLines> pins_{};
  std::array<std::int32_t, kSupplies> supplies_{};
  std::uint32_t configuration_ = 0;  ///< HVIO_CFG
  LineSet inputs_ = 0;
  base::SimTime now_;
  base::SimTime next_event_ = base::SimTime::never();
};

}  // namespace stator::mfc
