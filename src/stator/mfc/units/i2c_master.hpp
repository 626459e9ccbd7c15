#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/mfc/pins/signal.hpp"

namespace stator::mfc {

/// How a slave answers a byte.
struct I2cAnswer {
  bool acknowledge = false;
  /// How long from this moment the slave holds SCL low (clock stretching).
  base::SimDuration stretch;
};

/// A byte from a slave.
struct I2cData {
  std::uint8_t value = 0xFF;
  base::SimDuration stretch;  ///< as in I2cAnswer
};

/// A chip on the I2C bus of the master.
class I2cSlave {
 public:
  I2cSlave() = default;
  I2cSlave(const I2cSlave&) = default;
  I2cSlave& operator=(const I2cSlave&) = default;
  I2cSlave(I2cSlave&&) = default;
  I2cSlave& operator=(I2cSlave&&) = default;
  virtual ~I2cSlave() = default;

  /// A start or repeated start; then the address comes.
  virtual void start(base::SimTime time) = 0;
  /// The address byte is complete: 7 bits and the direction. The answer acknowledges it if it is
  /// this slave's; only then do bytes follow.
  virtual I2cAnswer address(base::SimTime time, std::uint8_t address, bool read) = 0;
  /// The master has sent a byte.
  virtual I2cAnswer write(base::SimTime time, std::uint8_t value) = 0;
  /// The master begins to read a byte.
  virtual I2cData read(base::SimTime time) = 0;
  /// The master has acknowledged the byte read, or not.
  virtual void acknowledged(base::SimTime time, bool acknowledge) = 0;
  virtual void stop(base::SimTime time) = 0;
};

/// The I2C master (registers 12 to 17; TMC8461 datasheet L9332-L9560). A bit lasts T = I2C_TIMEBASE
/// us: SCL low for T/2, in the middle of which SDA changes, high for T/2, in the middle of
/// which it is sampled. A start takes T, a repeated start or a stop 3T/2, a byte 9T, and longer if
/// somebody holds SCL low. Both lines are open drain. The rules of all units are in signal.hpp.
class I2cMaster {
 public:
  static constexpr std::size_t kSlaves = 8;

  /// What a receive command reports: by the meaning of the bits, ACK sent 0x28 and NACK sent
  /// 0x48, or as the document's table prints them, the other way round.
  enum class ReceiveCodes : std::uint8_t { by_bits, as_printed };

  void advance(base::SimTime to, SignalSink& sink);
  [[nodiscard]] base::SimTime next_event() const;
  void watch(const SignalSet& signals) { watched_ = signals; }

  /// Puts a chip on the bus, which outlives its place here; false if there are kSlaves already.
  bool attach(I2cSlave& slave);
  void detach_all();
  /// Others than master and attached chips hold SCL or SDA low (false) or release it (true).
  void input(Signal signal, bool level);
  void set_receive_codes(ReceiveCodes codes) { codes_ = codes; }

  /// I2C_TIMEBASE: us per bit, valid from the next command on; 0 switches the master off.
  void write_timebase(std::uint8_t timebase) { timebase_ = timebase; }
  /// I2C_CONTROL: one command bit. More than one, or one out of turn, gives status 0xFF; while a
  /// command runs, or without a timebase, nothing happens.
  void write_control(std::uint8_t command);
  /// I2C_ADDRESS: 7 bits and R/nW.
  void write_address(std::uint8_t address) { address_ = address; }
  /// I2C_DATA_W.
  void write_data(std::uint8_t data) { data_ = data; }

  [[nodiscard]] std::uint8_t timebase() const { return timebase_; }
  [[nodiscard]] std::uint8_t control() const { return control_; }
  [[nodiscard]] std::uint8_t address() const { return address_; }
  [[nodiscard]] std::uint8_t sent_data() const { return data_; }
  /// I2C_DATA_R.
  [[nodiscard]] std::uint8_t received_data() const { return received_; }
  /// I2C_STATUS.
  [[nodiscard]] std::uint8_t status() const { return status_; }
  [[nodiscard]] bool busy() const { return command_ != Command::none; }

  /// Whether master and attached chips release SCL or SDA: what the pins show of them, and what
  /// change() tells.
  [[nodiscard]] bool level(Signal signal) const;
  /// The level of the line: nobody holds it low.
  [[nodiscard]] bool line(Signal signal) const;

 private:
  enum class Command : std::uint8_t { none, start, repeated_start, stop, address, data, receive };
  /// What the bus is in between commands.
  enum class Phase : std::uint8_t { idle, started, writing, reading, failed };
  /// Whether SCL, released by the master, is still low.
  enum class Rise : std::uint8_t {
    none,
    held,     ///< by an attached chip, until next_
    awaited,  ///< from outside
  };

  void begin(Command command, std::uint8_t status);
  void begin_byte(Phase required, Command command, std::uint8_t value, std::uint8_t status);
  void refuse();
  void make_step(SignalSink& sink);
  void start_step(SignalSink& sink);
  void repeated_start_step(SignalSink& sink);
  void stop_step(SignalSink& sink);
  void byte_step(SignalSink& sink);
  void put_bit(int bit, SignalSink& sink);
  void sample_bit(int bit);
  void end_bit(int bit, SignalSink& sink);
  void end_byte(SignalSink& sink);
  void ask_for_acknowledge();
  void tell_start();
  void hold_scl(base::SimDuration stretch);
  void release_scl(SignalSink& sink);
  void wait_for_line();
  void go_on();
  void next_step(int quarters);
  void finish(Phase phase, std::uint8_t status);
  void set_scl(bool master, bool slaves, SignalSink& sink);
  void set_sda(bool master, bool slaves, SignalSink& sink);
  [[nodiscard]] bool sends_or_receives() const;
  [[nodiscard]] bool may_pass_unseen() const;
  [[nodiscard]] int steps_to_slaves() const;
  [[nodiscard]] int quarters_to_slaves() const;
  void pass_bits_unseen(int steps);

  std::array<I2cSlave*, kSlaves> slaves_{};
  std::array<bool, kSlaves> answering_{};  ///< has acknowledged its address
  SignalSet watched_;
  ReceiveCodes codes_ = ReceiveCodes::by_bits;
  std::uint8_t timebase_ = 0;
  std::uint8_t control_ = 0;
  std::uint8_t address_ = 0;
  std::uint8_t data_ = 0;
  std::uint8_t received_ = 0;
  std::uint8_t status_ = 0;

  base::SimTime now_;
  Phase phase_ = Phase::idle;
  Command command_ = Command::none;
  base::SimDuration quarter_;  ///< of the running command's bits
  int step_ = 0;               ///< of the running command
  base::SimTime next_;         ///< when step_ is made
  Rise rise_ = Rise::none;
  base::SimTime held_until_;     ///< an attached chip holds SCL low until then
  std::uint8_t shift_ = 0;       ///< the byte sent, or the bits received
  std::uint8_t slave_byte_ = 0;  ///< what attached chips send
  bool acknowledge_ = false;     ///< by the master, of the byte received
  bool acknowledged_ = false;    ///< as sampled
  bool slave_acknowledges_ = false;
  bool conflict_ = false;  ///< a 1 was sent and the line was low
  // True: not held low by the master, by attached chips, by others.
  bool scl_ = true, slave_scl_ = true, outside_scl_ = true;
  bool sda_ = true, slave_sda_ = true, outside_sda_ = true;
};

}  // namespace stator::mfc
