// What is around the chip: its regulators, its heat, and the chips on its buses.

#include "stator/mfc/block/block.hpp"

namespace stator::mfc {

void Block::set_high_voltage_overheated(bool overheated) {
  if (overheated && !overheated_) {
    irq_.raise(IrqSource::hv_ot_flag);
  }
  overheated_ = overheated;
  ++output_changes_;
  bring_pins_up_to_date();
  settle();
}

void Block::set_fixed_regulator_short(bool shorted) {
  const bool before = regulators_.fixed_short_flag();
  regulators_.set_fixed_short(shorted);
  if (!before && regulators_.fixed_short_flag()) {
    irq_.raise(IrqSource::b3v3_sc_flag);
  }
  settle();
}

void Block::set_adjustable_regulator_short(bool shorted) {
  const bool before = regulators_.adjustable_short_flag();
  regulators_.set_adjustable_short(shorted);
  if (!before && regulators_.adjustable_short_flag()) {
    irq_.raise(IrqSource::bvout_sc_flag);
  }
  settle();
}

void Block::set_adjustable_regulator_overheated(bool overheated) {
  const bool before = regulators_.adjustable_overheated_flag();
  regulators_.set_adjustable_overheated(now_, overheated);
  if (!before && overheated) {
    irq_.raise(IrqSource::bvout_ot_flag);
  }
  settle();
}

void Block::attach_spi(std::size_t select, SpiSlave* slave) {
  spi_slaves_[select] = slave;
  spi_.attach(select, slave);
}

bool Block::attach_i2c(I2cSlave& slave) {
  if (i2c_slave_count_ == kI2cSlaves || !i2c_.attach(slave)) {
    return false;
  }
  i2c_slaves_[i2c_slave_count_++] = &slave;
  return true;
}

}  // namespace stator::mfc
