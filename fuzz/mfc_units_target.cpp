// Any settings, inputs, commands and steps of time for the units of the multi-function I/O block:
// no unit goes back in time or announces its next event in the past, and a unit advanced from event
// to event is in the end what its copy is that was advanced at once.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "input.hpp"
#include "stator/mfc/units/encoder.hpp"
#include "stator/mfc/units/i2c_master.hpp"
#include "stator/mfc/units/pwm.hpp"
#include "stator/mfc/units/spi_master.hpp"
#include "stator/mfc/units/step_direction.hpp"
#include "stator/mfc/units/watchdog.hpp"

namespace {

using stator::base::SimDuration;
using stator::base::SimTime;
using stator::fuzz::Input;
using stator::fuzz::require;
using namespace stator::mfc;

/// Edges and events, in order of time; a checksum of them.
class OrderedSink : public SignalSink {
 public:
  void change(SimTime time, Signal signal, bool level) override {
    note(time, static_cast<unsigned>(signal) * 2 + (level ? 1 : 0));
  }
  void enable(SimTime time, Signal signal, bool driven) override {
    note(time, 512 + static_cast<unsigned>(signal) * 2 + (driven ? 1 : 0));
  }
  void interrupt(SimTime time, IrqSource source) override {
    note(time, 1024 + static_cast<unsigned>(source));
  }
  [[nodiscard]] std::uint64_t sum() const { return sum_; }

 private:
  void note(SimTime time, unsigned what) {
    require(time >= last_);
    last_ = time;
    sum_ = (sum_ ^ what ^ static_cast<std::uint64_t>(time.nanoseconds())) * 0x100000001B3;
  }
  SimTime last_;
  std::uint64_t sum_ = 0;
};

/// A chip on the I2C bus that answers as the input has it.
class Chip : public I2cSlave {
 public:
  explicit Chip(std::uint8_t character) : character_(character) {}
  void start(SimTime /*time*/) override {}
  I2cAnswer address(SimTime /*time*/, std::uint8_t address, bool /*read*/) override {
    return {.acknowledge = (address & character_) == 0,
            .stretch = SimDuration(std::int64_t{character_} * 300)};
  }
  I2cAnswer write(SimTime /*time*/, std::uint8_t value) override {
    return {.acknowledge = value != character_, .stretch = SimDuration(std::int64_t{value} * 100)};
  }
  I2cData read(SimTime /*time*/) override {
    return {.value = character_, .stretch = SimDuration(std::int64_t{character_} * 500)};
  }
  void acknowledged(SimTime /*time*/, bool /*acknowledge*/) override {}
  void stop(SimTime /*time*/) override {}

 private:
  std::uint8_t character_;
};

/// Advances `unit` from event to event and a copy at once; both must have told the same.
template <typename Unit>
void pass(Unit& unit, SimTime to, OrderedSink& sink) {
  Unit copy = unit;
  OrderedSink other = sink;
  copy.advance(to, other);
  SimTime last;
  for (int stops = 0; unit.next_event() <= to && stops < 20'000; ++stops) {
    require(unit.next_event() >= last);
    last = unit.next_event();
    unit.advance(last, sink);
  }
  unit.advance(to, sink);
  require(unit.next_event() > to);
  require(copy.next_event() == unit.next_event());
  require(sink.sum() == other.sum());
}

struct Units {
  explicit Units(std::uint8_t character) : chip(character) {
    i2c.attach(chip);
    SignalSet all;
    for (std::size_t i = 0; i < kSignals; ++i) {
      all.insert(static_cast<Signal>(i));
    }
    steps.watch(all);
    pwm.watch(all);
    spi.watch(all);
    i2c.watch(all);
    // Unlistened marks are told once per advance, which differs between the two ways.
    pwm.listen(0xF000);
  }

  void write_steps(Input& input) {
    const std::size_t channel = input.below(3);
    switch (input.below(8)) {
      case 0:
        steps.write_rate(channel, static_cast<std::int32_t>(input.double_word()), sinks[0]);
        break;
      case 1:
        steps.write_target(channel, input.word());
        break;
      case 2:
        steps.write_compare(channel, static_cast<std::int32_t>(input.double_word()));
        break;
      case 3:
        steps.write_next_rate(channel, static_cast<std::int32_t>(input.double_word()));
        break;
      case 4:
        steps.write_lengths(input.double_word());
        break;
      case 5:
        steps.write_delays(input.double_word());
        break;
      case 6:
        steps.set_emergency(input.below(2) != 0, sinks[0]);
        break;
      default:
        steps.write_configuration(input.double_word(), sinks[0]);
        break;
    }
  }

  void write_pwm(Input& input) {
    const std::size_t channel = input.below(4);
    switch (input.below(6)) {
      case 0:
        pwm.write_configuration(input.double_word() | std::uint64_t{input.double_word()} << 32,
                                sinks[1]);
        break;
      case 1:
        pwm.write_duty(channel, input.word(), sinks[1]);
        break;
      case 2:
        pwm.write_shift(channel, input.word(), sinks[1]);
        break;
      case 3:
        pwm.write_marks(input.double_word(), sinks[1]);
        break;
      case 4:
        pwm.write_pulse_length(input.byte(), sinks[1]);
        break;
      default:
        pwm.set_emergency(input.below(2) != 0, sinks[1]);
        break;
    }
  }

  void write_masters(Input& input) {
    switch (input.below(8)) {
      case 0:
        spi.write_configuration(input.word(), sinks[2]);
        break;
      case 1:
        spi.write_length(input.byte());
        spi.write_time(input.byte());
        break;
      case 2:
        spi.write_data(input.double_word(), input.below(2) != 0, sinks[2]);
        break;
      case 3:
        i2c.write_timebase(input.byte());
        break;
      case 4:
        i2c.input(input.below(2) != 0 ? Signal::scl : Signal::sda, input.below(2) != 0);
        break;
      case 5:
        i2c.write_address(input.byte());
        i2c.write_data(input.byte());
        break;
      default:
        i2c.write_control(input.byte());
        break;
    }
  }

  void write_supervision(Input& input) {
    switch (input.below(4)) {
      case 0:
        watchdog.write_time(input.word());
        break;
      case 1:
        watchdog.write_configuration(input.byte());
        break;
      case 2:
        watchdog.write_inputs(input.double_word() | std::uint64_t{input.double_word()} << 32);
        break;
      default:
        watchdog.set_lines(input.double_word());
        watchdog.trigger(static_cast<WatchdogTrigger>(input.below(3)));
        break;
    }
    encoder.write_constant(input.double_word());
    encoder.write_mode(now, input.word(), sinks[5]);
    encoder.input(now, offset(Signal::a, input.below(6)), input.below(2) != 0, sinks[5]);
    encoder.read_status();
  }

  Chip chip;
  SimTime now;
  std::array<OrderedSink, 6> sinks;
  StepDirection steps;
  Pwm pwm;
  SpiMaster spi;
  I2cMaster i2c;
  Watchdog watchdog;
  Encoder encoder;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(std::span(data, std::min<std::size_t>(size, 512)));
  Units units(input.byte());
  while (!input.empty()) {
    switch (input.below(4)) {
      case 0:
        units.write_steps(input);
        break;
      case 1:
        units.write_pwm(input);
        break;
      case 2:
        units.write_masters(input);
        break;
      default:
        units.write_supervision(input);
        break;
    }
    units.now += SimDuration(input.word());
    pass(units.steps, units.now, units.sinks[0]);
    pass(units.pwm, units.now, units.sinks[1]);
    pass(units.spi, units.now, units.sinks[2]);
    // Its chips are not copied, but have no state either.
    pass(units.i2c, units.now, units.sinks[3]);
    pass(units.watchdog, units.now, units.sinks[4]);
    for (std::size_t i = 0; i < 3; ++i) {
      require(units.steps.channel(i).next_step() > 0);
    }
    for (std::size_t i = 0; i < Pwm::kChannels; ++i) {
      const OnShare share = units.pwm.on_share(i);
      require(share.high_side >= 0 && share.low_side >= 0 &&
              share.high_side + share.low_side <= 1.0);
    }
  }
  return 0;
}
