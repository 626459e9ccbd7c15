#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "stator/base/input.hpp"
#include "stator/base/signal.hpp"
#include "stator/board/assembly/board_configuration.hpp"
#include "stator/board/lines/i2c_wire.hpp"
#include "stator/board/lines/logic_trace.hpp"
#include "stator/board/lines/pins.hpp"
#include "stator/board/lines/spi_wire.hpp"
#include "stator/board/peripheral/calendar.hpp"
#include "stator/board/peripheral/kept_content.hpp"
#include "stator/board/peripheral/peripheral.hpp"

namespace stator::board {

/// What is wired to the chip's lines, and the way through time of chip and peripherals together.
/// What is wired to the chip's lines, and the way through time of chip and peripherals together.
/// Without periodic steps: the board goes from event to event, those of the chip being edges of
/// watched lines.
class Board final : private LineListener, private PeripheralHost {
 public:
  /// Throws BoardError for what cannot be wired. `pins` must outlive the board and be connected to
  /// no other; `now` is the moment at which all begins.
  Board(const BoardConfiguration& configuration, Pins& pins, base::SimTime now);
  ~Board() override;

  /// Records the edges of the traced lines from now on; they are watched for good. The trace must
  /// outlive the board.
  void trace(LogicTrace& trace);

  /// Brings chip and peripherals to `now`. An access to the chip's registers at a moment comes
  /// after advance() to it.
  void advance(base::SimTime now);
  /// The next moment at which something happens at the lines.
  [[nodiscard]] base::SimTime next_event() const;
  [[nodiscard]] base::SimTime time() const { return now_; }

  /// Of all peripherals, as "peripheral.value".
  [[nodiscard]] std::vector<base::Signal> signals() const;
  [[nodiscard]] std::vector<base::Input> inputs();
  /// Those that keep content without supply; they live as long as the board.
  [[nodiscard]] std::vector<KeptPart> kept_parts();
  /// The peripheral of that name, or null.
  [[nodiscard]] Peripheral* find(std::string_view name);
  /// Times at which two peripherals drove a line against each other.
  [[nodiscard]] std::uint64_t conflicts() const { return conflicts_; }

 private:
  /// From the falling edge of SCL to the slave's change of SDA: no slave is infinitely fast, and
  /// UM10204 wants SDA to hold for a moment.
  static constexpr base::SimDuration kI2cOutputDelay{300};

  enum class Role : std::uint8_t { own, sck, mosi, miso, cs, scl, sda, step, dir };
  /// One pin of one peripheral.
  struct Slot {
    std::size_t peripheral = 0;
    std::size_t pin = 0;
    Line line = kNotWired;
    Role role = Role::own;
    bool edges = false;
    bool mean = false;
    Drive drive = Drive::released;  ///< in effect
    Drive wanted = Drive::released;
    base::SimTime due = base::SimTime::never();  ///< when `wanted` takes effect
  };
  struct Place {
    std::string name;
    std::unique_ptr<Peripheral> peripheral;
    std::size_t first_slot = 0;
    std::size_t end_slot = 0;
    std::optional<SpiWire> spi;
    std::optional<I2cWire> i2c;
    std::size_t output_slot = 0;  ///< MISO or SDA
    bool served = false;          ///< the chip exchanges words with it itself
  };

  void place(const PeripheralConfiguration& configuration);
  void connect(const PeripheralConfiguration& configuration, Place& place);
  void attach(Place& place);
  [[nodiscard]] bool acts_at_once(const Place& place) const;
  void list_slots();

  void line_changed(base::SimTime now, Line line, bool level) override;
  void mean_changed(base::SimTime now, Line line, double mean) override;
  void tell(const Slot& slot, base::SimTime now, bool level);

  void drive(base::SimTime now, std::size_t slot, Drive drive) override;
  void set_short(base::SimTime now, std::size_t slot, LineShort to) override;
  [[nodiscard]] bool level(std::size_t slot) const override;
  [[nodiscard]] double mean(std::size_t slot) const override;
  [[nodiscard]] bool wired(std::size_t slot) const override {
    return slots_[slot].line != kNotWired;
  }
  [[nodiscard]] std::optional<StepCount> count_steps(const StepFollower& follower) override {
    return pins_->count_steps(follower);
  }
  [[nodiscard]] base::SimTime now() const override { return now_; }

  void call_peripherals(base::SimTime now);
  void take_effect(base::SimTime now);
  void drive_line(base::SimTime now, Line line);
  [[nodiscard]] base::SimTime next_of_board() const {
    return std::min(next_due_, calendar_.earliest());
  }

  Pins* pins_;
  LogicTrace* trace_ = nullptr;
  base::SimTime now_;
  Calendar calendar_;  ///< entry k is that of places_[k]
  std::vector<Place> places_;
  std::vector<Slot> slots_;
  std::array<std::vector<std::size_t>, kLines> edge_slots_;
  std::array<std::vector<std::size_t>, kLines> mean_slots_;
  std::array<std::vector<std::size_t>, kLines> drive_slots_;
  std::array<bool, kLines> pulled_up_{};             ///< lines of an I2C bus
  base::SimTime next_due_ = base::SimTime::never();  ///< the earliest `due`
  static constexpr std::size_t kWordBits = 64;
  std::vector<std::uint64_t> due_;  ///< bit: a slot whose `due` is not never()
  std::uint64_t conflicts_ = 0;
};

}  // namespace stator::board
