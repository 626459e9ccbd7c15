#pragma once

#include "stator/base/sim_time.hpp"
#include "stator/board/lines/line.hpp"
#include "stator/board/lines/spi_slave.hpp"

namespace stator::board {

/// Clocks an SpiSlave from the edges on its lines. All four modes come down to the edge of SCK at
/// which data is taken: the rising one in modes 0 and 3, the falling one in modes 1 and 2
/// (spi_master_modes.csv). CS selects at low level. The slave's output changes with CS and at the
/// other edge.
class SpiWire {
 public:
  explicit SpiWire(SpiSlave& slave)
      : slave_(&slave), samples_falling_edge_(slave.samples_falling_edge()) {}

  /// Each returns what the slave's output does from then on.
  Drive cs_changed(base::SimTime now, bool level);
  Drive sck_changed(base::SimTime now, bool level);
  void mosi_changed(bool level) { mosi_ = level; }

 private:
  SpiSlave* slave_;
  bool samples_falling_edge_;
  bool selected_ = false;
  bool mosi_ = false;
  Drive output_ = Drive::released;
};

}  // namespace stator::board
