// Time and state of the I/O block: what happens when, and what follows from it.

#include "stator/mfc/block/block.hpp"

#include <algorithm>

namespace stator::mfc {

namespace {

/// How often outputs may change inputs and these outputs again at one moment: enough for every
/// wiring without a loop.
constexpr int kSettlingRounds = 64;

constexpr bool is_pwm_mark(IrqSource source) {
  return source >= IrqSource::pwm_zero_pulse && source <= IrqSource::pwm_b_pulse;
}

}  // namespace

Block::Block() {
  reset();
}

void Block::reset() {
  ++output_changes_;
  encoder_ = Encoder();
  spi_ = SpiMaster();
  i2c_ = I2cMaster();
  steps_ = StepDirection();
  pwm_ = Pwm();
  gpio_ = Gpio();
  dac_ = Dac();
  irq_ = IrqUnit();
  watchdog_ = Watchdog();
  advance_units();
  for (std::size_t select = 0; select < kSpiSelects; ++select) {
    spi_.attach(select, spi_slaves_[select]);
  }
  for (std::size_t i = 0; i < i2c_slave_count_; ++i) {
    static_cast<void>(i2c_.attach(*i2c_slaves_[i]));
  }
  for (const Register& entry : kRegisters) {
    written_[entry.number] = reset_value(entry.number);
  }
  levels_ = SignalSet();
  drivens_ = SignalSet();
  watched_signals_ = SignalSet();
  listened_ = 0;
  action_ = WatchdogAction();
  pending_triggers_ = 0;
  sync_counts_ = 0;
  al_state_ = 1;
  al_override_ = false;
  emergency_ = false;
  bridge_.reset();
  irq_.set_emergency_pin(nes_high_);
  pads_.reset();
  configuration_ = Configuration();
  regulators_.configure(now_, 0);
  bridge_.configure(configuration_);
  crossbar_.configure(configuration_, 0);
  apply_crossbar();
  settle();
}

void Block::refresh_next_events() const {
  const auto refresh = [this](Unit unit, const auto& its) {
    if ((stale_ >> unit & 1U) != 0) {
      unit_next_[unit] = its.next_event();
    }
  };
  refresh(dac_unit, dac_);
  refresh(i2c_unit, i2c_);
  refresh(pwm_unit, pwm_);
  refresh(spi_unit, spi_);
  refresh(steps_unit, steps_);
  refresh(watchdog_unit, watchdog_);
  next_of_units_ = unit_next_[0];
  for (const base::SimTime next : unit_next_) {
    next_of_units_ = std::min(next_of_units_, next);
  }
  stale_ = 0;
}

base::SimTime Block::next_event() const {
  if (stale_ != 0) {
    refresh_next_events();
  }
  return std::min(next_of_units_, pads_.next_event());
}

void Block::advance(base::SimTime to) {
  if (settling_) {
    return;  // the listener acts at the present moment
  }
  for (base::SimTime next = next_event(); next <= to; next = next_event()) {
    step(next);
  }
  now_ = std::max(now_, to);
  pads_.advance(now_);
}

void Block::step(base::SimTime to) {
  now_ = std::max(now_, to);
  if (pads_.next_event() <= now_) {
    untold_ = kAllLines;  // a driver has switched off
  }
  pads_.advance(now_);
  const auto bring = [&](Unit unit, auto& its) {
    // A unit handled before in this loop may have called this one, whose next event then has to be
    // worked out again.
    const bool called = (stale_ >> unit & 1U) != 0;
    if ((called ? its.next_event() : unit_next_[unit]) <= now_) {
      its.advance(now_, *this);
      touch(unit);
    }
  };
  bring(watchdog_unit, watchdog_);
  bring(pwm_unit, pwm_);
  bring(steps_unit, steps_);
  bring(spi_unit, spi_);
  bring(i2c_unit, i2c_);
  bring(dac_unit, dac_);
  settle();
}

void Block::advance_units(std::uint32_t units) {
  stale_ |= units;
  const auto bring = [&](Unit unit, auto& its) {
    if ((units >> unit & 1U) != 0) {
      its.advance(now_, *this);
    }
  };
  bring(watchdog_unit, watchdog_);
  bring(pwm_unit, pwm_);
  bring(steps_unit, steps_);
  bring(spi_unit, spi_);
  bring(i2c_unit, i2c_);
  bring(dac_unit, dac_);
}

/// Whether the states of units and pins cause no further change at this moment.
bool Block::settled() const {
  return pending_triggers_ == 0 && irq_.emergency() == emergency_ && pads_.inputs() == seen_ &&
         !watchdog_.expired() && !action_.active && (untold_ & watched_) == 0 &&
         irq_.output() == interrupt_shown_;
}

void Block::settle() {
  if (settling_) {
    return;  // the round under way sees to it
  }
  settling_ = true;
  for (int round = 0; round < kSettlingRounds && !settled(); ++round) {
    run_pending_triggers();
    update_emergency();
    bool again = deliver_inputs();
    if (const WatchdogAction action = watchdog_.action(); action != action_) {
      const LineSet lines = action_.lines | action.lines;
      action_ = action;
      ++output_changes_;
      update_lines(lines);
      again = true;
    }
    tell_listener();
    update_interrupt_pin();
    if (!again && pads_.inputs() == seen_ && pending_triggers_ == 0) {
      break;
    }
  }
  update_listening();
  settling_ = false;
}

void Block::run_pending_triggers() {
  if (pending_triggers_ == 0 || memory_ == nullptr) {
    pending_triggers_ = 0;
    return;
  }
  advance_units();
  const std::uint32_t triggers = pending_triggers_;
  pending_triggers_ = 0;
  for (unsigned code = 0; code < kTriggerCount; ++code) {
    if ((triggers >> code & 1U) != 0) {
      bridge_.trigger(static_cast<Trigger>(code), *memory_, *this);
    }
  }
}

void Block::update_emergency() {
  if (irq_.emergency() == emergency_) {
    return;
  }
  emergency_ = irq_.emergency();
  ++output_changes_;
  advance_units();
  gpio_.set_emergency(now_, emergency_, *this);
  steps_.set_emergency(emergency_, *this);
  pwm_.set_emergency(emergency_, *this);
}

void Block::update_interrupt_pin() {
  if (irq_.output() != interrupt_shown_) {
    interrupt_shown_ = irq_.output();
    if (listener_ != nullptr) {
      listener_->interrupt_changed(now_, interrupt_shown_);
    }
  }
}

void Block::update_listening() {
  // A mark that starts transfers is wanted again as soon as this one is over.
  constexpr IrqSet kMarks = irq_bit(IrqSource::pwm_zero_pulse) |
                            irq_bit(IrqSource::pwm_center_pulse) | irq_bit(IrqSource::pwm_a_pulse) |
                            irq_bit(IrqSource::pwm_b_pulse);
  const bool transferring = spi_.status() == 0;
  const IrqSet wanted = (transferring ? listened_ & kMarks : 0U) |
                        (irq_.mask() & irq_.clear_sources()) | spi_.awaited_marks() |
                        (bridge_.uses(Trigger::pwm_zero) ? irq_bit(IrqSource::pwm_zero_pulse) : 0U);
  if (wanted == listened_) {
    return;
  }
  pwm_.advance(now_, *this);
  steps_.advance(now_, *this);
  touch(pwm_unit);
  touch(steps_unit);
  listened_ = wanted;
  pwm_.listen(wanted);
  steps_.listen(wanted);
}

void Block::interrupt(base::SimTime time, IrqSource source) {
  irq_.raise(source);
  const bool in_time = (listened_ & irq_bit(source)) != 0;
  if (!is_pwm_mark(source) || !in_time) {
    return;
  }
  if ((spi_.awaited_marks() & irq_bit(source)) != 0) {
    touch(spi_unit);
    spi_.advance(time, *this);
    spi_.pwm_mark(source, *this);
  }
  if (source == IrqSource::pwm_zero_pulse && bridge_.uses(Trigger::pwm_zero)) {
    pending_triggers_ |= 1U << static_cast<unsigned>(Trigger::pwm_zero);
  }
}

void Block::trigger(Trigger trigger) {
  const auto trigger_watchdog = [this](WatchdogTrigger source) {
    touch(watchdog_unit);
    watchdog_.advance(now_, *this);
    watchdog_.trigger(source);
  };
  switch (trigger) {
    case Trigger::sync0:
      sync_counts_ = (sync_counts_ & 0xFFFF'0000U) | ((sync_counts_ + 1) & 0xFFFFU);
      break;
    case Trigger::sync1:
      sync_counts_ += 0x0001'0000U;
      break;
    case Trigger::start_of_frame:
      trigger_watchdog(WatchdogTrigger::start_of_frame);
      break;
    case Trigger::pdi_deselect:
      trigger_watchdog(WatchdogTrigger::pdi_select);
      break;
    case Trigger::mfc_deselect:
      trigger_watchdog(WatchdogTrigger::mfc_select);
      break;
    default:
      break;
  }
  if (bridge_.uses(trigger)) {
    pending_triggers_ |= 1U << static_cast<unsigned>(trigger);
  }
  settle();
}

void Block::before_bus_read(std::uint16_t address, std::size_t length) {
  if (memory_ == nullptr) {
    return;
  }
  advance_units();
  settle();
  bridge_.before_read(address, length, *memory_, *this);
  settle();
}

void Block::after_bus_write(std::uint16_t address, std::size_t length) {
  if (memory_ == nullptr) {
    return;
  }
  advance_units();
  bridge_.after_write(address, length, *memory_, *this);
  settle();
}

void Block::set_al_state(std::uint8_t state) {
  const bool enabled = outputs_enabled();
  al_state_ = state;
  ++output_changes_;
  bridge_.set_access(state == kSafeOperational || state == kOperational, state == kOperational);
  if (outputs_enabled() != enabled) {
    bring_pins_up_to_date();
  }
  settle();
}

void Block::load_configuration(std::span<const std::byte> parameters) {
  advance_units();
  const Configuration former = configuration_;
  ++output_changes_;
  configuration_ = Configuration(parameters);
  // HVIO_CFG and BUCK_CONV_CFG may have been written since; only other bytes here replace that.
  if (configuration_.high_voltage() != former.high_voltage()) {
    written_[register_number::kHvioCfg] = configuration_.high_voltage();
    pads_.configure(configuration_.high_voltage());
  }
  if (configuration_.regulators() != former.regulators()) {
    written_[register_number::kBuckConvCfg] = configuration_.regulators();
    regulators_.configure(now_, configuration_.regulators());
  }
  bridge_.configure(configuration_);
  crossbar_.configure(configuration_,
                      static_cast<std::uint32_t>(written_[register_number::kHvioCfg]));
  apply_crossbar();
  settle();
}

void Block::set_emergency_pin(bool high) {
  nes_high_ = high;
  irq_.set_emergency_pin(high);
  settle();
}

const StepDirection& Block::step_direction() {
  steps_.advance(now_, *this);
  touch(steps_unit);
  settle();
  return steps_;
}

const Pwm& Block::pwm() {
  pwm_.advance(now_, *this);
  touch(pwm_unit);
  settle();
  return pwm_;
}

const Dac& Block::dac() {
  dac_.advance(now_, *this);
  touch(dac_unit);
  return dac_;
}

WatchdogAction Block::watchdog_action() {
  watchdog_.advance(now_, *this);
  touch(watchdog_unit);
  settle();
  return watchdog_.action();
}

}  // namespace stator::mfc
