#include "stator/board/assembly/block_pins.hpp"

#include <algorithm>

namespace stator::board {

namespace {

using mfc::Signal;

constexpr bool within(Signal signal, Signal first, Signal last) {
  return signal >= first && signal <= last;
}

mfc::OutsideDrive outside(Drive drive) {
  return drive == Drive::released ? mfc::OutsideDrive{}
                                  : mfc::OutsideDrive::level(drive == Drive::high);
}

mfc::LineSet bit_of(Line line) {
  return line < kLines ? mfc::line_bit(line) : mfc::LineSet{0};
}

}  // namespace

/// A slave at one select of the block's SPI master, as long as the pins are driven.
class BlockPins::SpiPlace final : public mfc::SpiSlave {
 public:
  SpiPlace(const mfc::Block& block, const SpiLines& lines, board::SpiSlave& slave)
      : block_(&block), lines_(lines), slave_(&slave) {}

  void select(base::SimTime time) override {
    selected_ = block_->pads().command(lines_.cs).driven;
    if (selected_) {
      slave_->select(time);
    }
  }
  std::uint64_t exchange(const mfc::SpiTransfer& transfer) override {
    return selected_ ? slave_->exchange(transfer) : 0;
  }
  void deselect(base::SimTime time) override {
    if (selected_) {
      slave_->deselect(time);
      selected_ = false;
    }
  }

  [[nodiscard]] const SpiLines& lines() const { return lines_; }
  [[nodiscard]] const board::SpiSlave& slave() const { return *slave_; }
  bool served = false;

 private:
  const mfc::Block* block_;
  SpiLines lines_;
  board::SpiSlave* slave_;
  bool selected_ = false;
};

/// A slave on the bus of the block's I2C master; it hears nothing while the crossbar leads
/// elsewhere.
class BlockPins::I2cPlace final : public mfc::I2cSlave {
 public:
  I2cPlace(const I2cLines& lines, mfc::I2cSlave& slave) : lines_(lines), slave_(&slave) {}

  void start(base::SimTime time) override {
    if (served) {
      slave_->start(time);
    }
  }
  mfc::I2cAnswer address(base::SimTime time, std::uint8_t address, bool read) override {
    return served ? slave_->address(time, address, read) : mfc::I2cAnswer{};
  }
  mfc::I2cAnswer write(base::SimTime time, std::uint8_t value) override {
    return slave_->write(time, value);
  }
  mfc::I2cData read(base::SimTime time) override { return slave_->read(time); }
  void acknowledged(base::SimTime time, bool acknowledge) override {
    slave_->acknowledged(time, acknowledge);
  }
  void stop(base::SimTime time) override {
    if (served) {
      slave_->stop(time);
    }
  }

  [[nodiscard]] const I2cLines& lines() const { return lines_; }
  [[nodiscard]] const mfc::I2cSlave& slave() const { return *slave_; }
  bool served = false;

 private:
  I2cLines lines_;
  mfc::I2cSlave* slave_;
};

BlockPins::BlockPins(mfc::Block& block, mfc::PinListener* interrupt)
    : block_(&block), interrupt_(interrupt) {
  block.set_listener(this);
}

BlockPins::~BlockPins() {
  block_->set_listener(interrupt_);
}

void BlockPins::connect(LineListener& listener) {
  listener_ = &listener;
}

void BlockPins::watch_edges(Line line) {
  edges_ |= bit_of(line);
  refresh_places();
}

void BlockPins::watch_mean(Line line) {
  means_ |= bit_of(line);
  told_mean_[line] = present_mean(line, mean_sources());
}

void BlockPins::update_watch() {
  block_->watch(edges_ | buses_);
}

bool BlockPins::level(Line line) const {
  if (((edges_ | buses_) & bit_of(line)) != 0) {
    return block_->pads().state(line) == mfc::PinState::high;
  }
  return block_->pin(line) == mfc::PinState::high;
}

double BlockPins::mean(Line line) const {
  return (means_ & bit_of(line)) != 0 ? told_mean_[line] : present_mean(line, mean_sources());
}

BlockPins::MeanSources BlockPins::mean_sources() const {
  const mfc::LineSet overruled = block_->watchdog_action().lines;
  return {.pwm = &block_->pwm(), .dac = &block_->dac(), .overruled = overruled};
}

double BlockPins::present_mean(Line line, const MeanSources& sources) const {
  const mfc::PinCommand command = block_->pads().command(line);
  const Signal signal = block_->signal(line);
  const bool overruled = (sources.overruled & bit_of(line)) != 0;
  if (command.driven && !overruled && block_->pads().short_at(line) == mfc::Short::none) {
    if (within(signal, Signal::hs0, Signal::ls3)) {
      const auto code = static_cast<std::size_t>(signal) - static_cast<std::size_t>(Signal::hs0);
      const bool high_side = code % 2 == 0;
      const mfc::OnShare share = sources.pwm->on_share(code / 2);
      const double on = high_side ? share.high_side : share.low_side;
      // PWM_CFG: bit 40 inverts the low sides, 41 the high ones.
      const bool inverted = ((sources.pwm->configuration() >> (high_side ? 41U : 40U)) & 1U) != 0;
      return inverted ? 1.0 - on : on;
    }
    if (signal == Signal::dac0) {
      return sources.dac->mean();
    }
  }
  return level(line) ? 1.0 : 0.0;
}

void BlockPins::drive(base::SimTime now, Line line, Drive drive) {
  block_->drive(line, outside(drive), now);
}

void BlockPins::set_short(base::SimTime now, Line line, LineShort to) {
  block_->advance(now);
  block_->set_short(line, to == LineShort::none     ? mfc::Short::none
                          : to == LineShort::ground ? mfc::Short::to_ground
                                                    : mfc::Short::to_supply);
}

void BlockPins::attach(const SpiLines& lines, SpiSlave& slave) {
  spi_.push_back(std::make_unique<SpiPlace>(*block_, lines, slave));
  refresh_places();
}

void BlockPins::attach(const I2cLines& lines, mfc::I2cSlave& slave) {
  i2c_.push_back(std::make_unique<I2cPlace>(lines, slave));
  block_->attach_i2c(*i2c_.back());
  refresh_places();
}

bool BlockPins::serves(const SpiSlave& slave) const {
  for (const auto& place : spi_) {
    if (&place->slave() == &slave) {
      return place->served;
    }
  }
  return false;
}

bool BlockPins::serves(const mfc::I2cSlave& slave) const {
  for (const auto& place : i2c_) {
    if (&place->slave() == &slave) {
      return place->served;
    }
  }
  return false;
}

void BlockPins::refresh_places() {
  for (Line line = 0; line < kLines; ++line) {
    signals_[line] = block_->signal(line);
  }
  buses_ = 0;
  std::array<SpiPlace*, mfc::SpiMaster::kSelects> selects{};
  for (const auto& place : spi_) {
    const SpiLines& lines = place->lines();
    const auto select =
        static_cast<std::size_t>(block_->signal(lines.cs)) - static_cast<std::size_t>(Signal::cs0);
    place->served = select < selects.size() && selects[select] == nullptr &&
                    carries(lines.sck, Signal::sck) && carries(lines.mosi, Signal::sdo) &&
                    carries(lines.miso, Signal::sdi) && (edges_ & bit_of(lines.miso)) == 0;
    if (place->served) {
      selects[select] = place.get();
    } else {
      buses_ |= bit_of(lines.sck) | bit_of(lines.mosi) | bit_of(lines.cs);
    }
  }
  for (std::size_t select = 0; select < selects.size(); ++select) {
    block_->attach_spi(select, selects[select]);
  }
  for (const auto& place : i2c_) {
    const I2cLines& lines = place->lines();
    place->served = carries(lines.scl, Signal::scl) && carries(lines.sda, Signal::sda);
    if (!place->served) {
      buses_ |= bit_of(lines.scl) | bit_of(lines.sda);
    }
  }
  update_watch();
  refresh_steps();
}

void BlockPins::attach(const StepLines& lines, StepFollower& follower) {
  steps_.push_back({.lines = lines, .follower = &follower});
  refresh_places();
}

bool BlockPins::serves_steps(const mfc::StepDirection& steps, const StepPlace& place,
                             std::size_t channel) const {
  // SD_CFG: bits 2 and 3 of a channel invert its outputs; then edges decide.
  constexpr std::uint32_t kPolarities = 0x0C;
  return (steps.configuration() >> (8 * channel) & kPolarities) == 0 &&
         carries(place.lines.dir, mfc::offset(Signal::d0, 2 * channel)) &&
         ((bit_of(place.lines.step) | bit_of(place.lines.dir)) & edges_) == 0 &&
         !place.follower->needs_edges();
}

void BlockPins::refresh_steps() {
  // Nothing to do while the step generators of all followers run: they come to count by themselves.
  if (std::ranges::all_of(steps_,
                          [](const StepPlace& place) { return place.served && place.running; })) {
    return;
  }
  const mfc::LineSet before = buses_;
  const mfc::StepDirection& unit = block_->step_direction();
  for (StepPlace& place : steps_) {
    const mfc::LineSet lines = bit_of(place.lines.step) | bit_of(place.lines.dir);
    const bool served_before = place.served;
    place.served = false;
    for (std::size_t channel = 0; channel < mfc::StepDirection::kChannels; ++channel) {
      if (place.lines.step < kLines && place.lines.dir < kLines &&
          block_->signal(place.lines.step) == mfc::offset(Signal::s0, 2 * channel)) {
        place.channel = channel;
        place.served = serves_steps(unit, place, channel);
      }
    }
    const mfc::StepChannel& channel = unit.channel(place.channel);
    if (place.served && !served_before) {
      place.counted = channel.total_steps();
    }
    if (place.served && (channel.total_steps() != place.counted || channel.rate() != 0)) {
      place.follower->steps_come(block_->now());
    }
    buses_ = place.served ? buses_ & ~lines : buses_ | lines;
  }
  if (buses_ != before) {
    update_watch();
  }
}

std::optional<StepCount> BlockPins::count_steps(const StepFollower& follower) {
  for (StepPlace& place : steps_) {
    if (place.follower == &follower && place.served) {
      const mfc::StepDirection& unit = block_->step_direction();
      const mfc::StepChannel& channel = unit.channel(place.channel);
      const bool driven = block_->pads().command(place.lines.step).driven &&
                          (block_->watchdog_action().lines & bit_of(place.lines.step)) == 0;
      const std::int64_t steps = channel.total_steps() - place.counted;
      place.counted = channel.total_steps();
      place.running = channel.rate() != 0;
      place.served = serves_steps(unit, place, place.channel);
      return StepCount{.steps = driven ? steps : 0, .running = place.running};
    }
  }
  return std::nullopt;
}

void BlockPins::refresh_means() {
  if (means_ == 0) {
    return;
  }
  const MeanSources sources = mean_sources();
  for (Line line = 0; line < kLines; ++line) {
    if ((means_ & bit_of(line)) != 0) {
      const double present = present_mean(line, sources);
      if (present != told_mean_[line]) {
        told_mean_[line] = present;
        listener_->mean_changed(block_->now(), line, present);
      }
    }
  }
}

void BlockPins::refresh() {
  if (block_->output_changes() == known_changes_) {
    return;
  }
  known_changes_ = block_->output_changes();
  for (Line line = 0; line < kLines; ++line) {
    if (block_->signal(line) != signals_[line]) {
      refresh_places();
      break;
    }
  }
  refresh_steps();
  refresh_means();
}

void BlockPins::settle() {
  refresh();
}

void BlockPins::advance(base::SimTime now) {
  block_->advance(now);
  refresh();
}

void BlockPins::pin_changed(base::SimTime time, std::size_t line, mfc::PinState state) {
  if (listener_ != nullptr) {
    listener_->line_changed(time, static_cast<Line>(line), state == mfc::PinState::high);
  }
}

void BlockPins::interrupt_changed(base::SimTime time, bool level) {
  if (interrupt_ != nullptr) {
    interrupt_->interrupt_changed(time, level);
  }
}

}  // namespace stator::board
