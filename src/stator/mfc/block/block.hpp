#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/mfc/block/memory_bridge.hpp"
#include "stator/mfc/pins/configuration.hpp"
#include "stator/mfc/pins/crossbar.hpp"
#include "stator/mfc/pins/pads.hpp"
#include "stator/mfc/pins/signal.hpp"
#include "stator/mfc/registers/register_map.hpp"
#include "stator/mfc/units/dac.hpp"
#include "stator/mfc/units/encoder.hpp"
#include "stator/mfc/units/gpio.hpp"
#include "stator/mfc/units/i2c_master.hpp"
#include "stator/mfc/units/irq_unit.hpp"
#include "stator/mfc/units/pwm.hpp"
#include "stator/mfc/units/regulators.hpp"
#include "stator/mfc/units/spi_master.hpp"
#include "stator/mfc/units/step_direction.hpp"
#include "stator/mfc/units/watchdog.hpp"

namespace stator::mfc {

/// Gets the changes of the block's pins in order of time, pins of one moment by line. It may drive
/// pins and read registers of the block from there, at that time.
class PinListener {
 public:
  PinListener() = default;
  PinListener(const PinListener&) = default;
  PinListener& operator=(const PinListener&) = default;
  PinListener(PinListener&&) = default;
  PinListener& operator=(PinListener&&) = default;
  virtual ~PinListener() = default;

  /// A watched line has another state.
  virtual void pin_changed(base::SimTime time, std::size_t line, PinState state) = 0;
  /// MFC_IRQ has another level.
  virtual void interrupt_changed(base::SimTime time, bool level) = 0;
};

/// The multi-function I/O block of the TMC8461 with its pins (datasheet chapter 7): the units, the
/// crossbar between units and pins, the registers with their two sides, and the memory bridge to
/// process data.
///
/// Time is passive: next_event() says when something that matters happens next, advance() makes it.
/// Every other call acts at now(); to act later, call advance() first. Allocates nothing. Chips at
/// the SPI and I2C masters, listener and process data are referred to and outlive their place here.
class Block final : private SignalSink, private BridgedRegisters {
 public:
  static constexpr std::uint8_t kSafeOperational = 4;
  static constexpr std::uint8_t kOperational = 8;

  Block();

  void advance(base::SimTime to);
  [[nodiscard]] base::SimTime next_event() const;
  [[nodiscard]] base::SimTime now() const { return now_; }
  /// The chip is reset: registers, units and configuration. What is around the chip stays.
  void reset();

  // The side of the MFC CTRL SPI. Addresses are register number << 4 | byte number (L1156-L1168).

  /// Reads bytes as of now. Bytes without a register are 0; a register of which any byte is read
  /// counts as read. A caller that reads byte by byte fetches the rest of a register with its first
  /// byte, so that the bytes belong together.
  void read(std::uint16_t address, std::span<std::byte> out);
  /// Writes what one datagram has brought. Bytes beyond a register's size, registers without write
  /// access and registers mapped for the master are left alone (L8854-L8858).
  void write(std::uint16_t address, std::span<const std::byte> data);

  // The side of the EtherCAT controller.

  /// The parameter RAM 0x0580..0x05FF, loaded or written; up to 128 bytes. In force at once.
  void load_configuration(std::span<const std::byte> parameters);
  [[nodiscard]] const Configuration& configuration() const { return configuration_; }
  [[nodiscard]] const MemoryMap& memory_map() const { return bridge_.map(); }
  void set_process_data(ProcessData* memory) { memory_ = memory; }
  /// AL status 3:0. Outputs are active in Operational only, unless AL_OVERRIDE is set.
  void set_al_state(std::uint8_t state);
  void before_bus_read(std::uint16_t address, std::size_t length);
  void after_bus_write(std::uint16_t address, std::size_t length);
  /// The edge behind a trigger source (SYNC, LATCH, frames, chip selects) has come. Those that
  /// trigger the watchdog do so, SYNC edges are counted.
  void trigger(Trigger trigger);
  void set_flag_clearing(MemoryBridge::FlagClearing clearing) {
    bridge_.set_flag_clearing(clearing);
  }

  // Pins.

  /// The outside drives `line` from `time` on, which is not before now(): advances to it.
  void drive(std::size_t line, OutsideDrive outside, base::SimTime time);
  void set_short(std::size_t line, Short fault);
  /// VIO1..VIO3 as 0..2, mV.
  void set_supply(std::size_t supply, std::int32_t millivolts);
  [[nodiscard]] PinState pin(std::size_t line);
  [[nodiscard]] std::int32_t voltage(std::size_t line);
  [[nodiscard]] Signal signal(std::size_t line) const { return crossbar_.signal(line); }
  [[nodiscard]] const Pads& pads() const { return pads_; }
  /// MFC_NES, active low; low when nothing is connected.
  void set_emergency_pin(bool high);
  /// MFC_IRQ.
  [[nodiscard]] bool interrupt_pin() const { return irq_.output(); }
  void set_listener(PinListener* listener) { listener_ = listener; }
  /// Lines of which the listener is told. Edges of others are not computed.
  void watch(LineSet lines);

  /// Grows with whatever may change what outputs do on the whole, as against their single edges:
  /// writes to registers of generators and pins, states, configuration, shorts.
  [[nodiscard]] std::uint64_t output_changes() const { return output_changes_; }

  // What is around the chip.

  void attach_spi(std::size_t select, SpiSlave* slave);
  /// False if there are too many.
  bool attach_i2c(I2cSlave& slave);
  /// The high-voltage block is too hot: its drivers are off (L300-L301).
  void set_high_voltage_overheated(bool overheated);
  void set_fixed_regulator_short(bool shorted);
  void set_adjustable_regulator_short(bool shorted);
  void set_adjustable_regulator_overheated(bool overheated);
  [[nodiscard]] Regulators& regulators() { return regulators_; }

  /// The units, brought to now(), for plants and displays.
  [[nodiscard]] const StepDirection& step_direction();
  [[nodiscard]] const Pwm& pwm();
  [[nodiscard]] const Dac& dac();
  [[nodiscard]] const Encoder& encoder() const { return encoder_; }
  [[nodiscard]] WatchdogAction watchdog_action();

 private:
  // SignalSink: what units tell
  void change(base::SimTime time, Signal signal, bool level) override;
  void enable(base::SimTime time, Signal signal, bool driven) override;
  void interrupt(base::SimTime time, IrqSource source) override;

  // BridgedRegisters
  std::uint64_t transfer_out(unsigned number, bool clear) override;
  void transfer_in(unsigned number, std::uint64_t value, std::uint8_t written) override;

  // block.cpp: time, triggers, state
  void step(base::SimTime to);
  void advance_units(std::uint32_t units = kAllUnits);
  void settle();
  [[nodiscard]] bool settled() const;
  void run_pending_triggers();
  void update_watching();
  void update_listening();
  void update_emergency();
  void update_interrupt_pin();
  [[nodiscard]] bool outputs_enabled() const { return al_state_ == kOperational || al_override_; }

  // block_pins.cpp: between units and pads
  void apply_crossbar();
  void fetch(Signal signal);
  void update_lines(LineSet lines);
  [[nodiscard]] PinCommand command(std::size_t line) const;
  bool deliver_inputs();
  void deliver(Signal signal);
  void tell_listener();
  [[nodiscard]] bool unit_level(Signal signal) const;
  void bring_pins_up_to_date();

  // block_registers.cpp: registers to and from units
  [[nodiscard]] static std::uint32_t units_of(std::size_t number);
  void advance_units_of(std::uint16_t address, std::size_t length);
  [[nodiscard]] std::uint64_t read_register(unsigned number, bool clear);
  void write_register(unsigned number, std::uint64_t value, std::uint8_t written);
  [[nodiscard]] std::uint64_t held(unsigned number) const;
  bool write_serial_register(unsigned number, std::uint64_t value, std::uint8_t written);
  bool write_generator_register(unsigned number, std::uint64_t value);
  void write_other_register(unsigned number, std::uint64_t value);
  [[nodiscard]] std::uint32_t analog_status();

  /// Units with events of their own, as bits of stale_ and places in unit_next_.
  enum Unit : std::uint8_t { dac_unit, i2c_unit, pwm_unit, spi_unit, steps_unit, watchdog_unit };
  static constexpr std::size_t kUnits = 6;
  static constexpr std::uint32_t kAllUnits = (1U << kUnits) - 1;
  /// A unit was called: its next event may be another.
  void touch(Unit unit) { stale_ |= 1U << unit; }
  void refresh_next_events() const;

  static constexpr std::size_t kSpiSelects = SpiMaster::kSelects;
  static constexpr std::size_t kI2cSlaves = 8;

  Encoder encoder_;
  SpiMaster spi_;
  I2cMaster i2c_;
  StepDirection steps_;
  Pwm pwm_;
  Gpio gpio_;
  Dac dac_;
  IrqUnit irq_;
  Watchdog watchdog_;
  Crossbar crossbar_;
  Pads pads_;
  Regulators regulators_;
  MemoryBridge bridge_;
  Configuration configuration_;
  /// What was last written to each register.
  std::array<std::uint64_t, kRegisterCount> written_{};

  base::SimTime now_;
  // What next_event() has worked out, for units that were not called since.
  mutable std::array<base::SimTime, kUnits> unit_next_{};
  mutable base::SimTime next_of_units_;
  mutable std::uint32_t stale_ = kAllUnits;
  SignalSet levels_;   ///< of output signals, as far as they are watched
  SignalSet drivens_;  ///< general purpose outputs that are driven
  LineSet watched_ = 0;
  LineSet untold_ = 0;  ///< lines that may have another state than the listener knows
  LineSet seen_ = 0;    ///< levels the units have been told
  std::array<PinState, kLines> shown_{};
  SignalSet watched_signals_;
  IrqSet listened_ = 0;
  std::uint64_t output_changes_ = 0;
  WatchdogAction action_;
  std::uint32_t pending_triggers_ = 0;  ///< bit n: trigger n
  std::uint32_t sync_counts_ = 0;       ///< SYNC0 in 15:0, SYNC1 in 31:16
  std::uint8_t al_state_ = 1;
  bool al_override_ = false;
  bool emergency_ = false;
  bool interrupt_shown_ = false;
  bool nes_high_ = false;
  bool overheated_ = false;
  bool settling_ = false;

  ProcessData* memory_ = nullptr;
  PinListener* listener_ = nullptr;
  std::array<SpiSlave*, kSpiSelects> spi_slaves_{};
  std::array<I2cSlave*, kI2cSlaves> i2c_slaves_{};
  std::size_t i2c_slave_count_ = 0;
};

}  // namespace stator::mfc
