// The waveforms of the I2C master's commands, step by step.

#include "stator/mfc/units/i2c_codes.hpp"
#include "stator/mfc/units/i2c_master.hpp"

namespace stator::mfc {

using namespace i2c;

void I2cMaster::make_step(SignalSink& sink) {
  if (rise_ == Rise::held) {
    set_scl(true, true, sink);
    wait_for_line();
    return;
  }
  switch (command_) {
    case Command::start:
      start_step(sink);
      break;
    case Command::repeated_start:
      repeated_start_step(sink);
      break;
    case Command::stop:
      stop_step(sink);
      break;
    default:
      byte_step(sink);
      break;
  }
}

void I2cMaster::next_step(int quarters) {
  ++step_;
  next_ = now_ + quarter_ * quarters;
}

void I2cMaster::release_scl(SignalSink& sink) {
  if (held_until_ > now_) {
    set_scl(true, false, sink);
    rise_ = Rise::held;
    next_ = held_until_;
    return;
  }
  set_scl(true, true, sink);
  wait_for_line();
}

void I2cMaster::wait_for_line() {
  if (outside_scl_) {
    go_on();
  } else {
    rise_ = Rise::awaited;
  }
}

void I2cMaster::go_on() {
  rise_ = Rise::none;
  // A start or stop keeps SCL high for half a bit before SDA changes; a bit is sampled in between.
  const bool byte = command_ != Command::repeated_start && command_ != Command::stop;
  next_step(byte ? 1 : 2);
}

void I2cMaster::start_step(SignalSink& sink) {
  if (step_ == 0) {
    if (!line(Signal::scl) || !line(Signal::sda)) {
      finish(Phase::idle, kGeneralError);
      return;
    }
    set_sda(false, true, sink);
    next_step(2);
    return;
  }
  set_scl(false, true, sink);
  tell_start();
  finish(Phase::started, kStarted);
}

void I2cMaster::repeated_start_step(SignalSink& sink) {
  switch (step_) {
    case 0:
      set_sda(true, true, sink);
      next_step(1);
      break;
    case 1:
      release_scl(sink);
      break;
    case 2:
      if (!line(Signal::sda)) {
        set_scl(false, true, sink);
        finish(Phase::failed, kGeneralError);
        break;
      }
      set_sda(false, true, sink);
      next_step(2);
      break;
    default:
      set_scl(false, true, sink);
      tell_start();
      finish(Phase::started, kStartedAgain);
      break;
  }
}

void I2cMaster::stop_step(SignalSink& sink) {
  switch (step_) {
    case 0:
      set_sda(false, true, sink);
      next_step(1);
      break;
    case 1:
      release_scl(sink);
      break;
    case 2:
      set_sda(true, true, sink);
      next_step(2);
      break;
    default:
      for (I2cSlave* slave : slaves_) {
        if (slave != nullptr) {
          slave->stop(now_);
        }
      }
      answering_ = {};
      finish(Phase::idle, kIdle);
      break;
  }
}

void I2cMaster::tell_start() {
  answering_ = {};
  for (I2cSlave* slave : slaves_) {
    if (slave != nullptr) {
      slave->start(now_);
    }
  }
}

void I2cMaster::byte_step(SignalSink& sink) {
  const int bit = step_ / kStepsPerBit;
  switch (step_ % kStepsPerBit) {
    case 0:
      put_bit(bit, sink);
      next_step(1);
      break;
    case 1:
      release_scl(sink);
      break;
    case 2:
      sample_bit(bit);
      next_step(1);
      break;
    default:
      set_scl(false, true, sink);
      end_bit(bit, sink);
      break;
  }
}

void I2cMaster::put_bit(int bit, SignalSink& sink) {
  const bool receives = command_ == Command::receive;
  if (bit == 8) {
    set_sda(!receives || !acknowledge_, receives || !slave_acknowledges_, sink);
    return;
  }
  const auto of = [bit](std::uint8_t byte) { return (byte << bit & 0x80) != 0; };
  set_sda(receives || of(shift_), !receives || of(slave_byte_), sink);
}

/// What the next `steps` of a byte leave behind, from the begin of a bit to before the last step of
/// another.
void I2cMaster::pass_bits_unseen(int steps) {
  const bool receives = command_ == Command::receive;
  const int first = step_ / kStepsPerBit;
  const int last = (step_ + steps) / kStepsPerBit;
  if (receives) {
    for (int bit = first; bit < 8 && bit <= last; ++bit) {
      shift_ = static_cast<std::uint8_t>(shift_ << 1 | (slave_byte_ << bit >> 7 & 1));
    }
  }
  if (last == 8) {
    sda_ = !receives || !acknowledge_;
    slave_sda_ = receives || !slave_acknowledges_;
    acknowledged_ = receives ? acknowledged_ : !slave_sda_;
  } else {
    const auto of = [last](std::uint8_t byte) { return (byte << last & 0x80) != 0; };
    sda_ = receives || of(shift_);
    slave_sda_ = !receives || of(slave_byte_);
  }
  scl_ = true;
  slave_scl_ = true;
  step_ += steps;
  next_ += quarter_ * steps;
}

void I2cMaster::sample_bit(int bit) {
  const bool level = line(Signal::sda);
  if (command_ == Command::receive) {
    if (bit < 8) {
      shift_ = static_cast<std::uint8_t>(shift_ << 1 | (level ? 1 : 0));
    }
  } else if (bit == 8) {
    acknowledged_ = !level;
  } else if (sda_ && !level) {
    conflict_ = true;
  }
}

void I2cMaster::end_bit(int bit, SignalSink& sink) {
  if (conflict_) {
    set_sda(true, true, sink);
    finish(Phase::failed, command_ == Command::address ? kAddressError : kDataError);
    sink.interrupt(now_, IrqSource::i2c_tx_complete);
    sink.interrupt(now_, IrqSource::i2c_new_data_or_tx_complete);
    return;
  }
  if (bit == 8) {
    set_sda(sda_, true, sink);
    end_byte(sink);
    return;
  }
  if (bit == 7 && command_ != Command::receive) {
    ask_for_acknowledge();
  }
  next_step(1);
}

void I2cMaster::ask_for_acknowledge() {
  slave_acknowledges_ = false;
  for (std::size_t i = 0; i < kSlaves; ++i) {
    I2cSlave* slave = slaves_[i];
    if (slave == nullptr || (command_ == Command::data && !answering_[i])) {
      continue;
    }
    const I2cAnswer answer =
        command_ == Command::address
            ? slave->address(now_, static_cast<std::uint8_t>(shift_ >> 1), (shift_ & 1U) != 0)
            : slave->write(now_, shift_);
    if (command_ == Command::address) {
      answering_[i] = answer.acknowledge;
    }
    slave_acknowledges_ = slave_acknowledges_ || answer.acknowledge;
    hold_scl(answer.stretch);
  }
}

void I2cMaster::end_byte(SignalSink& sink) {
  if (command_ == Command::receive) {
    received_ = shift_;
    for (std::size_t i = 0; i < kSlaves; ++i) {
      if (answering_[i]) {
        slaves_[i]->acknowledged(now_, acknowledge_);
      }
    }
    const bool shows_ack = acknowledge_ == (codes_ == ReceiveCodes::by_bits);
    finish(Phase::reading, kRead | (shows_ack ? kAcknowledged : kNotAcknowledged));
    sink.interrupt(now_, IrqSource::i2c_new_data);
  } else {
    const bool read = command_ == Command::address && (shift_ & 1U) != 0;
    // What the status has shown since the command began tells address, read, write.
    finish(read ? Phase::reading : Phase::writing,
           status_ | (acknowledged_ ? kAcknowledged : kNotAcknowledged));
    sink.interrupt(now_, IrqSource::i2c_tx_complete);
  }
  sink.interrupt(now_, IrqSource::i2c_new_data_or_tx_complete);
}

void I2cMaster::finish(Phase phase, std::uint8_t status) {
  phase_ = phase;
  status_ = status;
  command_ = Command::none;
}

}  // namespace stator::mfc
