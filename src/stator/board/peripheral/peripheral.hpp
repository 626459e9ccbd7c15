#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stator/base/input.hpp"
#include "stator/base/signal.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/board/lines/line.hpp"
#include "stator/board/lines/pins.hpp"
#include "stator/board/peripheral/calendar.hpp"
#include "stator/board/peripheral/declaration.hpp"
#include "stator/board/peripheral/kept_content.hpp"
#include "stator/board/peripheral/settings.hpp"
#include "stator/board/peripheral/shaft.hpp"

namespace stator::board {

/// An analog voltage on the board.
class AnalogSource {
 public:
  AnalogSource() = default;
  AnalogSource(const AnalogSource&) = delete;
  AnalogSource& operator=(const AnalogSource&) = delete;
  virtual ~AnalogSource() = default;

  /// V against ground at `now`, which is not before any moment asked for.
  [[nodiscard]] virtual double voltage(base::SimTime now) const = 0;
};

/// What a board does for its peripherals; `slot` is what it gave to each of their pins.
class PeripheralHost {
 public:
  PeripheralHost() = default;
  PeripheralHost(const PeripheralHost&) = delete;
  PeripheralHost& operator=(const PeripheralHost&) = delete;
  virtual ~PeripheralHost() = default;

  virtual void drive(base::SimTime now, std::size_t slot, Drive drive) = 0;
  virtual void set_short(base::SimTime now, std::size_t slot, LineShort to) = 0;
  [[nodiscard]] virtual bool level(std::size_t slot) const = 0;
  [[nodiscard]] virtual double mean(std::size_t slot) const = 0;
  [[nodiscard]] virtual bool wired(std::size_t slot) const = 0;
  [[nodiscard]] virtual std::optional<StepCount> count_steps(const StepFollower& follower) = 0;
  [[nodiscard]] virtual base::SimTime now() const = 0;
};

/// Something wired to the chip's lines. Passive: it is told of edges and mean levels at its pins
/// in order of time, and comes to advance() at the moments it has scheduled. It allocates at
/// construction only.
class Peripheral {
 public:
  Peripheral() = default;
  Peripheral(const Peripheral&) = delete;
  Peripheral& operator=(const Peripheral&) = delete;
  virtual ~Peripheral() = default;

  /// The board has wired all pins; `first_slot` is that of pin 0, the others follow. Both outlive
  /// the peripheral's use.
  void wire(PeripheralHost& host, std::size_t first_slot, Calendar& calendar) {
    host_ = &host;
    first_slot_ = first_slot;
    calendar_ = &calendar;
    entry_ = calendar.add();
  }

  /// Another peripheral serves the declared connection with that index. False: it has not what the
  /// connection needs.
  virtual bool connect(std::size_t /*connection*/, Peripheral& /*other*/) { return false; }
  /// Power-on, with everything wired and connected.
  virtual void begin(base::SimTime /*now*/) {}

  virtual void line_changed(base::SimTime /*now*/, std::size_t /*pin*/, bool /*level*/) {}
  virtual void mean_changed(base::SimTime /*now*/, std::size_t /*pin*/, double /*mean*/) {}
  /// The moment of next_event() has come; schedules the next one, or nothing more happens.
  virtual void advance(base::SimTime /*now*/) {}
  [[nodiscard]] base::SimTime next_event() const { return calendar_->at(entry_); }
  void forget_event() { schedule(base::SimTime::never()); }

  /// Interfaces of the peripheral beside its pins; null: it has none of that kind.
  [[nodiscard]] virtual SpiSlave* spi() { return nullptr; }
  [[nodiscard]] virtual mfc::I2cSlave* i2c() { return nullptr; }
  [[nodiscard]] virtual StepFollower* step_follower() { return nullptr; }
  [[nodiscard]] virtual AnalogSource* analog_output() { return nullptr; }
  [[nodiscard]] virtual Shaft* shaft() { return nullptr; }
  [[nodiscard]] virtual KeptContent* kept_content() { return nullptr; }

  /// What can be recorded and what can be set; names are unique within the peripheral.
  [[nodiscard]] virtual std::vector<base::Signal> signals() const { return {}; }
  [[nodiscard]] virtual std::vector<base::Input> inputs() { return {}; }

 protected:
  /// advance() is called at `moment`; replaces what was scheduled.
  void schedule(base::SimTime moment) { calendar_->set(entry_, moment); }
  void drive(base::SimTime now, std::size_t pin, Drive drive) {
    host_->drive(now, first_slot_ + pin, drive);
  }
  void drive(base::SimTime now, std::size_t pin, bool level) { drive(now, pin, driven(level)); }
  void set_short(base::SimTime now, std::size_t pin, LineShort to) {
    host_->set_short(now, first_slot_ + pin, to);
  }
  [[nodiscard]] bool level(std::size_t pin) const { return host_->level(first_slot_ + pin); }
  [[nodiscard]] double mean(std::size_t pin) const { return host_->mean(first_slot_ + pin); }
  [[nodiscard]] bool wired(std::size_t pin) const { return host_->wired(first_slot_ + pin); }
  [[nodiscard]] std::optional<StepCount> count_steps(const StepFollower& follower) {
    return host_->count_steps(follower);
  }
  /// The board's present moment, for inputs that people set.
  [[nodiscard]] base::SimTime now() const { return host_->now(); }

 private:
  PeripheralHost* host_ = nullptr;
  std::size_t first_slot_ = 0;
  Calendar* calendar_ = nullptr;
  std::size_t entry_ = 0;  ///< in the calendar
};

}  // namespace stator::board
