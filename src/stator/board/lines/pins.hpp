#pragma once

#include "stator/base/sim_time.hpp"
#include "stator/board/lines/line.hpp"
#include "stator/board/lines/spi_slave.hpp"
#include "stator/board/lines/step_follower.hpp"
#include "stator/mfc/units/i2c_master.hpp"

namespace stator::board {

/// Gets what happens on the chip's lines, in order of time.
class LineListener {
 public:
  LineListener() = default;
  LineListener(const LineListener&) = delete;
  LineListener& operator=(const LineListener&) = delete;
  virtual ~LineListener() = default;

  /// An edge on a line whose edges are watched.
  virtual void line_changed(base::SimTime now, Line line, bool level) = 0;
  /// The mean level 0..1 of a line whose mean is watched is another from `now` on.
  virtual void mean_changed(base::SimTime now, Line line, double mean) = 0;
};

/// The lines an SPI peripheral is wired to; kNotWired: not at all.
struct SpiLines {
  Line sck = kNotWired;
  Line mosi = kNotWired;
  Line miso = kNotWired;
  Line cs = kNotWired;
};

struct I2cLines {
  Line scl = kNotWired;
  Line sda = kNotWired;
};

struct StepLines {
  Line step = kNotWired;
  Line dir = kNotWired;
};

/// What a short on a line connects it to.
enum class LineShort : std::uint8_t { none, ground, supply };

/// The chip as a board sees it: its lines, and time. A seam, so that a test can stand in for the
/// chip. The listener gets changes of watched lines only, since edges are computed for these alone.
class Pins {
 public:
  Pins() = default;
  Pins(const Pins&) = delete;
  Pins& operator=(const Pins&) = delete;
  virtual ~Pins() = default;

  /// Must be called once, before all else; the listener outlives the pins' use.
  virtual void connect(LineListener& listener) = 0;

  virtual void watch_edges(Line line) = 0;
  virtual void watch_mean(Line line) = 0;
  /// Level on the wire, and its mean over the periods of the chip's PWM and converter as they are
  /// set now.
  [[nodiscard]] virtual bool level(Line line) const = 0;
  [[nodiscard]] virtual double mean(Line line) const = 0;

  /// What all peripherals together do to a line, from `now` on. Never called from within a call of
  /// the listener.
  virtual void drive(base::SimTime now, Line line, Drive drive) = 0;
  virtual void set_short(base::SimTime now, Line line, LineShort to) = 0;

  /// Puts a slave at the chip's bus as a peripheral at these lines. While the chip serves a slave,
  /// it exchanges whole words with it and no edge is computed for it: where its crossbar connects
  /// master and lines as they are wired. Else it tells the listener of the edges as if they were
  /// watched, and the board clocks the slave from them (SpiWire, I2cWire).
  virtual void attach(const SpiLines& lines, SpiSlave& slave) = 0;
  virtual void attach(const I2cLines& lines, mfc::I2cSlave& slave) = 0;
  [[nodiscard]] virtual bool serves(const SpiSlave& slave) const = 0;
  [[nodiscard]] virtual bool serves(const mfc::I2cSlave& slave) const = 0;

  /// The same for step and direction inputs: where a step generator leads to them as they are
  /// wired, and no other part watches the lines, its steps are counted instead of reported one by
  /// one.
  virtual void attach(const StepLines& lines, StepFollower& follower) = 0;
  /// Steps until `now` since the last call; nothing if they are reported as edges.
  [[nodiscard]] virtual std::optional<StepCount> count_steps(const StepFollower& follower) = 0;

  /// Tells the listener what accesses to the chip have changed since the last call, but for edges,
  /// which it was told at once.
  virtual void settle() = 0;
  /// A peripheral acts at once on what served slaves receive, so next_event() has to be every event
  /// of the chip.
  virtual void stop_at_every_event() = 0;
  /// The next moment at which a watched line may change on the chip's own account.
  [[nodiscard]] virtual base::SimTime next_event() const = 0;
  /// Brings the chip to `now`; the listener is told what happened until then.
  virtual void advance(base::SimTime now) = 0;
};

}  // namespace stator::board
