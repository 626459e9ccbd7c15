#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/board/lines/line.hpp"
#include "stator/mfc/units/i2c_master.hpp"

namespace stator::board {

/// Clocks an mfc::I2cSlave from the edges on SCL and SDA (NXP UM10204 §3.1): data is taken while
/// SCL is high and changes while it is low; SDA falling at high SCL is a start, rising a stop.
class I2cWire {
 public:
  explicit I2cWire(mfc::I2cSlave& slave) : slave_(&slave) {}

  /// Each returns what the slave does to SDA from then on: low or released.
  Drive scl_changed(base::SimTime now, bool level);
  Drive sda_changed(base::SimTime now, bool level);

 private:
  enum class Phase : std::uint8_t {
    idle,         ///< not addressed
    address,      ///< eight bits after a start
    write,        ///< eight bits from the master
    acknowledge,  ///< the slave holds SDA for the ninth
    read,         ///< eight bits to the master
    answer,       ///< the master acknowledges, or not
  };

  Drive fall(base::SimTime now);
  void acknowledge(bool yes) {
    phase_ = yes ? Phase::acknowledge : Phase::idle;
    sda_out_ = yes ? Drive::low : Drive::released;
  }
  void begin_byte(base::SimTime now);
  void show_bit();

  mfc::I2cSlave* slave_;
  Phase phase_ = Phase::idle;
  bool scl_ = true;
  bool sda_ = true;
  bool reads_ = false;  ///< the master reads from this slave
  bool acknowledged_ = false;
  unsigned bits_ = 0;
  std::uint8_t data_ = 0;
  Drive sda_out_ = Drive::released;
};

}  // namespace stator::board
