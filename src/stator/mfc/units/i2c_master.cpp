#include "stator/mfc/units/i2c_master.hpp"

#include <algorithm>

#include "stator/mfc/units/i2c_codes.hpp"

namespace stator::mfc {

namespace {

using namespace i2c;

// I2C_CONTROL (L9348-L9368).
constexpr std::uint8_t kReceiveNack = 0x01;
constexpr std::uint8_t kReceiveAck = 0x02;
constexpr std::uint8_t kSendData = 0x04;
constexpr std::uint8_t kSendAddress = 0x08;
constexpr std::uint8_t kStop = 0x10;
constexpr std::uint8_t kStart = 0x20;
constexpr std::uint8_t kCommands = 0x3F;

}  // namespace

bool I2cMaster::attach(I2cSlave& slave) {
  const auto free = std::find(slaves_.begin(), slaves_.end(), nullptr);
  if (free == slaves_.end()) {
    return false;
  }
  *free = &slave;
  return true;
}

void I2cMaster::detach_all() {
  slaves_ = {};
  answering_ = {};
}

bool I2cMaster::level(Signal signal) const {
  return signal == Signal::scl ? scl_ && slave_scl_ : sda_ && slave_sda_;
}

bool I2cMaster::line(Signal signal) const {
  return level(signal) && (signal == Signal::scl ? outside_scl_ : outside_sda_);
}

void I2cMaster::set_scl(bool master, bool slaves, SignalSink& sink) {
  const bool before = level(Signal::scl);
  scl_ = master;
  slave_scl_ = slaves;
  if (level(Signal::scl) != before && watched_.contains(Signal::scl)) {
    sink.change(now_, Signal::scl, !before);
  }
}

void I2cMaster::set_sda(bool master, bool slaves, SignalSink& sink) {
  const bool before = level(Signal::sda);
  sda_ = master;
  slave_sda_ = slaves;
  if (level(Signal::sda) != before && watched_.contains(Signal::sda)) {
    sink.change(now_, Signal::sda, !before);
  }
}

void I2cMaster::input(Signal signal, bool level) {
  (signal == Signal::scl ? outside_scl_ : outside_sda_) = level;
  if (rise_ == Rise::awaited && line(Signal::scl)) {
    go_on();
  }
}

void I2cMaster::write_control(std::uint8_t command) {
  control_ = command;
  command &= kCommands;
  if (timebase_ == 0 || busy() || command == 0) {
    return;
  }
  if ((command & (command - 1)) != 0) {  // more than one bit
    refuse();
    return;
  }
  switch (command) {
    case kStart:
      begin(phase_ == Phase::idle ? Command::start : Command::repeated_start, kIdle);
      return;
    case kStop:
      if (phase_ == Phase::idle) {
        status_ = kIdle;
      } else {
        begin(Command::stop, status_);
      }
      return;
    case kSendAddress:
      begin_byte(Phase::started, Command::address, address_,
                 kAddress | ((address_ & 1U) != 0 ? kRead : kWrite));
      return;
    case kSendData:
      begin_byte(Phase::writing, Command::data, data_, kWrite);
      return;
    case kReceiveAck:
    case kReceiveNack:
      acknowledge_ = command == kReceiveAck;
      begin_byte(Phase::reading, Command::receive, 0xFF, kRead);
      return;
    default:
      return;
  }
}

void I2cMaster::refuse() {
  status_ = kGeneralError;
  if (phase_ != Phase::idle) {
    phase_ = Phase::failed;
  }
}

void I2cMaster::begin(Command command, std::uint8_t status) {
  command_ = command;
  status_ = status;
  step_ = 0;
  quarter_ = base::SimDuration(std::int64_t{timebase_} * 250);
  // A first start finds both lines high; everything else begins while SCL is low.
  next_ = now_ + quarter_ * (command == Command::start ? 2 : 1);
}

void I2cMaster::begin_byte(Phase required, Command command, std::uint8_t value,
                           std::uint8_t status) {
  if (phase_ != required) {
    refuse();
    return;
  }
  shift_ = value;
  conflict_ = false;
  begin(command, status);
  if (command == Command::receive) {
    std::uint8_t sent = 0xFF;
    for (std::size_t i = 0; i < kSlaves; ++i) {
      if (answering_[i]) {
        const I2cData data = slaves_[i]->read(now_);
        sent &= data.value;
        hold_scl(data.stretch);
      }
    }
    slave_byte_ = sent;
  }
}

void I2cMaster::hold_scl(base::SimDuration stretch) {
  held_until_ = std::max(held_until_, now_ + stretch);
}

bool I2cMaster::sends_or_receives() const {
  return command_ == Command::address || command_ == Command::data || command_ == Command::receive;
}

/// The lines are not watched, and nothing holds SCL low to lengthen the bits.
bool I2cMaster::may_pass_unseen() const {
  return outside_scl_ && held_until_ <= now_ && !watched_.contains_any({Signal::scl, Signal::sda});
}

/// From the present step of a byte to the one in which slaves or host are told something.
int I2cMaster::steps_to_slaves() const {
  const bool asks = command_ != Command::receive && step_ <= kLastStepOfData;
  return (asks ? kLastStepOfData : kLastStepOfByte) - step_;
}

/// The same of any command, in quarters of a bit.
int I2cMaster::quarters_to_slaves() const {
  static constexpr std::array<int, 2> kStartQuarters{2, 0};
  static constexpr std::array<int, 4> kStopQuarters{5, 4, 2, 0};
  if (sends_or_receives()) {
    return steps_to_slaves();
  }
  const auto step = static_cast<std::size_t>(step_);
  return command_ == Command::start ? kStartQuarters[step] : kStopQuarters[step];
}

base::SimTime I2cMaster::next_event() const {
  if (!busy() || rise_ == Rise::awaited) {
    return base::SimTime::never();
  }
  return may_pass_unseen() ? next_ + quarter_ * quarters_to_slaves() : next_;
}

void I2cMaster::advance(base::SimTime to, SignalSink& sink) {
  while (busy() && rise_ != Rise::awaited && next_ <= to) {
    if (sends_or_receives() && step_ % kStepsPerBit == 0 && outside_sda_ && may_pass_unseen()) {
      const int steps = steps_to_slaves();
      if (next_ + quarter_ * steps <= to) {
        pass_bits_unseen(steps);
      }
    }
    now_ = next_;
    make_step(sink);
  }
  now_ = to;
}

}  // namespace stator::mfc
