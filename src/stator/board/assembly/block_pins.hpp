#pragma once

#include <array>
#include <memory>
#include <vector>

#include "stator/board/lines/pins.hpp"
#include "stator/mfc/block/block.hpp"

namespace stator::board {

/// The I/O block of a TMC8461 as a board sees it.
///
/// Mean levels follow from the registers of PWM unit and converter. What an access to the chip
/// changes in them is told by settle() at the moment of the access; what the block changes by
/// itself (its watchdog, registers transferred at a trigger) when the board comes to its next
/// event.
///
/// SPI peripherals are served word by word unless their MISO is watched: an input of the chip shows
/// nothing that is not driven bit by bit.
class BlockPins final : public Pins, private mfc::PinListener {
 public:
  /// The block must outlive this. Changes of its interrupt pin go to `interrupt`, if any: a block
  /// has one listener.
  explicit BlockPins(mfc::Block& block, mfc::PinListener* interrupt = nullptr);
  ~BlockPins() override;

  void connect(LineListener& listener) override;
  void watch_edges(Line line) override;
  void watch_mean(Line line) override;
  [[nodiscard]] bool level(Line line) const override;
  [[nodiscard]] double mean(Line line) const override;
  void drive(base::SimTime now, Line line, Drive drive) override;
  void set_short(base::SimTime now, Line line, LineShort to) override;
  void attach(const SpiLines& lines, SpiSlave& slave) override;
  void attach(const I2cLines& lines, mfc::I2cSlave& slave) override;
  [[nodiscard]] bool serves(const SpiSlave& slave) const override;
  [[nodiscard]] bool serves(const mfc::I2cSlave& slave) const override;
  void attach(const StepLines& lines, StepFollower& follower) override;
  [[nodiscard]] std::optional<StepCount> count_steps(const StepFollower& follower) override;
  void settle() override;
  void stop_at_every_event() override { stops_ = true; }
  /// Where nothing is watched the block may be brought to any moment in one go.
  [[nodiscard]] base::SimTime next_event() const override {
    return stops_ || (edges_ | buses_) != 0 ? block_->next_event() : base::SimTime::never();
  }
  void advance(base::SimTime now) override;

 private:
  class SpiPlace;
  class I2cPlace;
  struct StepPlace {
    StepLines lines;
    StepFollower* follower = nullptr;
    bool served = false;
    bool running = false;  ///< when last counted
    std::size_t channel = 0;
    std::int64_t counted = 0;  ///< of the channel's total
  };
  /// The units that mean levels follow from, brought to now.
  struct MeanSources {
    const mfc::Pwm* pwm;
    const mfc::Dac* dac;
    mfc::LineSet overruled;  ///< by the watchdog
  };

  void pin_changed(base::SimTime time, std::size_t line, mfc::PinState state) override;
  void interrupt_changed(base::SimTime time, bool level) override;

  [[nodiscard]] MeanSources mean_sources() const;
  [[nodiscard]] double present_mean(Line line, const MeanSources& sources) const;
  void refresh();
  void refresh_means();
  void refresh_places();
  void refresh_steps();
  [[nodiscard]] bool serves_steps(const mfc::StepDirection& steps, const StepPlace& place,
                                  std::size_t channel) const;
  void update_watch();
  [[nodiscard]] bool carries(Line line, mfc::Signal signal) const {
    return line == kNotWired || block_->signal(line) == signal;
  }

  mfc::Block* block_;
  mfc::PinListener* interrupt_;
  LineListener* listener_ = nullptr;
  mfc::LineSet edges_ = 0;  ///< lines whose edges were asked for
  mfc::LineSet buses_ = 0;  ///< lines of slaves that are not served
  mfc::LineSet means_ = 0;
  std::array<double, kLines> told_mean_{};
  std::uint64_t known_changes_ = 0;
  bool stops_ = false;
  std::array<mfc::Signal, kLines> signals_{};  ///< the crossbar as the places know it
  std::vector<std::unique_ptr<SpiPlace>> spi_;
  std::vector<std::unique_ptr<I2cPlace>> i2c_;
  std::vector<StepPlace> steps_;
};

}  // namespace stator::board
