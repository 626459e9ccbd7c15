#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/mfc/pins/signal.hpp"

namespace stator::mfc {

/// One transfer as a slave sees it.
struct SpiTransfer {
  base::SimTime start;             ///< select goes low, or the datagram goes on
  base::SimDuration clock_period;  ///< of SCK; the first edge comes half of it after start
  std::uint8_t bits = 0;           ///< 1 to 64
  bool clock_polarity = false;
  bool clock_phase = false;
  std::uint64_t sent = 0;  ///< SDO in order of the wire: the bit sent last is bit 0
};

/// A chip at one select line of the SPI master.
class SpiSlave {
 public:
  SpiSlave() = default;
  SpiSlave(const SpiSlave&) = default;
  SpiSlave& operator=(const SpiSlave&) = default;
  SpiSlave(SpiSlave&&) = default;
  SpiSlave& operator=(SpiSlave&&) = default;
  virtual ~SpiSlave() = default;

  /// The select line goes low: a datagram begins.
  virtual void select(base::SimTime time) = 0;
  /// The bits of a transfer, told at its start. Returns what the slave puts on SDI in order of the
  /// wire, the bit of the last clock in bit 0; bit i may depend on what was sent before it.
  virtual std::uint64_t exchange(const SpiTransfer& transfer) = 0;
  /// The select line goes high: the datagram, of one or more transfers, is complete.
  virtual void deselect(base::SimTime time) = 0;
};

/// The SPI master (registers 6 to 11; TMC8461 datasheet L9031-L9331). Half an SCK period is
/// 2 + SPI_TIME ticks of 40 ns: select to first edge, between edges, last edge to deselect. The
/// rules of all units are in signal.hpp.
class SpiMaster {
 public:
  static constexpr std::size_t kSelects = 4;

  void advance(base::SimTime to, SignalSink& sink);
  /// While a transfer runs: the next edge of a watched signal, or the transfer's end.
  [[nodiscard]] base::SimTime next_event() const;
  void watch(const SignalSet& signals) { watched_ = signals; }

  /// The chip at CS`select`, which outlives its place here; null for none. Where there is none, SDI
  /// is what input() says.
  void attach(std::size_t select, SpiSlave* slave) { slaves_[select] = slave; }
  /// The level of the pin SDI from now on.
  void input(bool level) { input_ = level; }

  /// SPI_TX_DATA. `complete`: the access has written the highest byte that SPI_LENGTH uses
  /// (index SPI_LENGTH / 8, A-76); only then does it start a transfer, with trigger 0.
  void write_data(std::uint64_t data, bool complete, SignalSink& sink);
  /// SPI_CONF; during a transfer for the next one. Bit 15 starts one, with trigger 7.
  void write_configuration(std::uint16_t configuration, SignalSink& sink);
  /// SPI_LENGTH: bits - 1 in bits 5:0.
  void write_length(std::uint8_t length) { length_ = length; }
  /// SPI_TIME.
  void write_time(std::uint8_t time) { time_ = time; }
  /// A mark of the PWM unit (sources 12 to 15) has come: starts a transfer with trigger 1 to 5.
  void pwm_mark(IrqSource mark, SignalSink& sink);
  /// The PWM marks that would start a transfer now, to be listened to; none while one runs.
  [[nodiscard]] IrqSet awaited_marks() const { return busy_ ? 0 : marks_; }

  [[nodiscard]] std::uint64_t sent_data() const { return data_; }
  [[nodiscard]] std::uint64_t received_data() const { return received_; }
  [[nodiscard]] std::uint16_t configuration() const { return configuration_; }
  [[nodiscard]] std::uint8_t length() const { return length_; }
  [[nodiscard]] std::uint8_t time() const { return time_; }
  /// SPI_STATUS: bit 0, ready for the next transfer.
  [[nodiscard]] std::uint8_t status() const { return busy_ ? 0 : 1; }

  /// Level of SCK, SDO, CS0 to CS3, and SDI as the slave drives it or as input() has told.
  [[nodiscard]] bool level(Signal signal) const;

 private:
  void start(SignalSink& sink);
  void make_edge(SignalSink& sink);
  void pass_edges_unseen();
  void finish(SignalSink& sink);
  void set(base::SimTime time, Signal signal, bool level, SignalSink& sink);
  void select(SignalSink& sink);
  void deselect(base::SimTime time, SignalSink& sink);
  void put_bit(base::SimTime time, unsigned index, SignalSink& sink);
  [[nodiscard]] std::int64_t edge_tick(int edge) const;
  [[nodiscard]] bool edges_watched() const;

  std::array<SpiSlave*, kSelects> slaves_{};
  SignalSet watched_;
  base::SimTime now_;
  std::uint64_t data_ = 0;
  std::uint64_t received_ = 0;
  std::uint16_t configuration_ = 0;
  IrqSet marks_ = 0;  ///< that start a transfer as configured
  std::uint8_t length_ = 0;
  std::uint8_t time_ = 0;
  bool input_ = false;

  bool busy_ = false;
  bool selected_ = false;  ///< a select line is low
  std::uint8_t selected_line_ = 0;
  SpiTransfer transfer_;        ///< the running one
  std::uint16_t in_force_ = 0;  ///< configuration of the running transfer
  std::int64_t start_tick_ = 0;
  std::int64_t half_ = 0;    ///< ticks
  int edge_ = 0;             ///< next SCK edge, 0 to 2 bits; then the end
  std::uint64_t reply_ = 0;  ///< of the slave, in order of the wire
  std::uint64_t sampled_ = 0;
  bool sck_ = false;
  bool sdo_ = false;
  bool sdi_ = false;  ///< what the slave drives
};

}  // namespace stator::mfc
