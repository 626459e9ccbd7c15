#include "stator/board/lines/spi_wire.hpp"

namespace stator::board {

Drive SpiWire::cs_changed(base::SimTime now, bool level) {
  const bool active = !level;
  if (active != selected_) {
    selected_ = active;
    if (active) {
      slave_->select(now);
      output_ = slave_->output();
    } else {
      slave_->deselect(now);
      output_ = Drive::released;
    }
  }
  return output_;
}

Drive SpiWire::sck_changed(base::SimTime now, bool level) {
  if (selected_) {
    if (level != samples_falling_edge_) {
      slave_->take(now, mosi_);
    } else {
      output_ = slave_->output();
    }
  }
  return output_;
}

}  // namespace stator::board
