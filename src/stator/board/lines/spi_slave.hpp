#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/board/lines/line.hpp"
#include "stator/mfc/units/spi_master.hpp"

namespace stator::board {

/// The serial logic of an SPI peripheral, bit by bit. Whoever clocks it knows the mode: SpiWire
/// from edges on lines, or the chip's SPI master, which exchanges whole words without edges.
///
/// Within one SCK period the slave first shows a bit, which follows from what it took before, then
/// takes one.
class SpiSlave : public mfc::SpiSlave {
 public:
  /// What the slave's data output does during the SCK period that is to come; only while selected.
  [[nodiscard]] virtual Drive output() const = 0;
  /// The bit of the present SCK period, taken at its sampling edge.
  virtual void take(base::SimTime now, bool bit) = 0;
  /// Modes 1 and 2 take data at the falling edge of SCK, 0 and 3 at the rising one.
  [[nodiscard]] virtual bool samples_falling_edge() const { return false; }

  /// A bit the slave does not drive reads as 0. Where the master works at the other edges of SCK,
  /// one side changes its line at the edge at which the other one looks, and that one still sees
  /// the bit before: with clock phase 0 the master, with clock phase 1 the slave. The first bit the
  /// master sees of a further transfer of a datagram is then the present one.
  std::uint64_t exchange(const mfc::SpiTransfer& transfer) override {
    return clock_word(*this, transfer);
  }

 protected:
  /// exchange() of a slave whose type is known: its bits then take no virtual calls.
  template <typename Slave>
  static std::uint64_t clock_word(Slave& slave, const mfc::SpiTransfer& transfer);
  /// When the first bit of a word is taken: the first edge comes half a period after the start;
  /// with clock phase 1 data is taken at the second.
  [[nodiscard]] static base::SimTime first_sample(const mfc::SpiTransfer& transfer) {
    const base::SimDuration half(transfer.clock_period.nanoseconds() / 2);
    return transfer.start + half * (transfer.clock_phase ? 2 : 1);
  }
  /// For an exchange() that does not clock its bits.
  void keep_late_bit(const mfc::SpiTransfer& transfer) { late_bit_ = (transfer.sent & 1U) != 0; }

 private:
  bool late_bit_ = false;  ///< the master's latest bit, where the edges differ
};

template <typename Slave>
std::uint64_t SpiSlave::clock_word(Slave& slave, const mfc::SpiTransfer& transfer) {
  const bool at_first_edge = transfer.clock_polarity == slave.samples_falling_edge();
  const bool agree = at_first_edge != transfer.clock_phase;
  const bool takes_late = !agree && transfer.clock_phase;
  const bool shows_late = !agree && !transfer.clock_phase;
  const base::SimDuration half(transfer.clock_period.nanoseconds() / 2);
  base::SimTime now = transfer.start + half * (at_first_edge ? 1 : 2);
  bool shown = slave.output() == Drive::high;
  std::uint64_t received = 0;
  for (unsigned k = transfer.bits; k-- > 0;) {
    SpiSlave& base = slave;
    const bool bit = ((transfer.sent >> k) & 1U) != 0;
    const bool output = slave.output() == Drive::high;
    received = received << 1U | ((shows_late ? shown : output) ? 1U : 0U);
    shown = output;
    slave.take(now, takes_late ? base.late_bit_ : bit);
    base.late_bit_ = bit;
    now += transfer.clock_period;
  }
  return received;
}

}  // namespace stator::board
