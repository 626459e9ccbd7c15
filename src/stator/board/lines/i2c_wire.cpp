#include "stator/board/lines/i2c_wire.hpp"

namespace stator::board {

Drive I2cWire::sda_changed(base::SimTime now, bool level) {
  sda_ = level;
  if (scl_) {
    if (!level) {
      phase_ = Phase::address;
      bits_ = 0;
      slave_->start(now);
    } else {
      phase_ = Phase::idle;
      slave_->stop(now);
    }
    sda_out_ = Drive::released;
  }
  return sda_out_;
}

Drive I2cWire::scl_changed(base::SimTime now, bool level) {
  scl_ = level;
  if (!level) {
    return fall(now);
  }
  if (phase_ == Phase::address || phase_ == Phase::write) {
    data_ = static_cast<std::uint8_t>(unsigned{data_} << 1U | (sda_ ? 1U : 0U));
    ++bits_;
  } else if (phase_ == Phase::read) {
    ++bits_;
  } else if (phase_ == Phase::answer) {
    acknowledged_ = !sda_;
  }
  return sda_out_;
}

Drive I2cWire::fall(base::SimTime now) {
  switch (phase_) {
    case Phase::address:
      if (bits_ == 8) {
        reads_ = (data_ & 1U) != 0;
        acknowledge(
            slave_->address(now, static_cast<std::uint8_t>(data_ >> 1U), reads_).acknowledge);
      }
      break;
    case Phase::write:
      if (bits_ == 8) {
        acknowledge(slave_->write(now, data_).acknowledge);
      }
      break;
    case Phase::acknowledge:
      begin_byte(now);
      break;
    case Phase::read:
      if (bits_ == 8) {
        phase_ = Phase::answer;
        sda_out_ = Drive::released;
      } else {
        show_bit();
      }
      break;
    case Phase::answer:
      slave_->acknowledged(now, acknowledged_);
      if (acknowledged_) {
        begin_byte(now);
      } else {
        phase_ = Phase::idle;
      }
      break;
    case Phase::idle:
      break;
  }
  return sda_out_;
}

void I2cWire::begin_byte(base::SimTime now) {
  bits_ = 0;
  sda_out_ = Drive::released;
  if (reads_) {
    phase_ = Phase::read;
    data_ = slave_->read(now).value;
    show_bit();
  } else {
    phase_ = Phase::write;
  }
}

void I2cWire::show_bit() {
  sda_out_ = ((data_ >> (7U - bits_)) & 1U) != 0 ? Drive::released : Drive::low;
}

}  // namespace stator::board
