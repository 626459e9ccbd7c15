#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/controller/distributed_clock_unit.hpp"
#include "stator/ethercat/controller/frame_work.hpp"
#include "stator/ethercat/controller/memory_partner.hpp"
#include "stator/ethercat/controller/ports.hpp"
#include "stator/ethercat/controller/reset_sequence.hpp"
#include "stator/ethercat/controller/slave_controller_configuration.hpp"
#include "stator/ethercat/registers/register_table.hpp"
#include "stator/ethercat/registers/time_stamp.hpp"
#include "stator/ethercat/standard/ecat_event.hpp"
#include "stator/ethercat/standard/forwarding.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/ethercat/standard/process_data_interface.hpp"
#include "stator/ethercat/standard/receive_error.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/ethercat/units/distributed_clock.hpp"
#include "stator/ethercat/units/fmmu.hpp"
#include "stator/ethercat/units/led.hpp"
#include "stator/ethercat/units/mii_management.hpp"
#include "stator/ethercat/units/sii_interface.hpp"
#include "stator/ethercat/units/sync_manager.hpp"
#include "stator/ethercat/units/sync_unit.hpp"
#include "stator/ethercat/units/watchdog.hpp"

namespace stator::ethercat {

/// An EtherCAT slave controller: the chip between bus and host (ETG.1000.4; TMC8461 and TMC8670
/// datasheets). The bus side is process(), called by Segment for each frame that passes; the host
/// side is ProcessDataInterface.
///
/// Memory is one block, registers below 0x1000 and process memory above. What a register byte
/// allows comes from the declared tables (register_table_*.cpp); what an access causes is in
/// register_effects.cpp. FMMUs and sync managers act at once, in every AL state: each write to
/// their registers compiles them into the mappings the frame path walks (logical_access.cpp).
///
/// Time comes with frames and with advance(); it never goes back. What happens on the clock alone
/// (watchdogs, end of an EEPROM access) is a deadline, see next_deadline().
class SlaveController final : public ProcessDataInterface {
 public:
  static constexpr std::size_t kMaximumFmmus = 16;
  static constexpr std::size_t kMaximumSyncManagers = 16;
  static constexpr unsigned kPorts = kPortsPerSlave;

  explicit SlaveController(const SlaveControllerConfiguration& configuration);

  /// Where refused accesses and expired watchdogs are reported.
  void set_event_reporter(const base::EventReporter& reporter) { reporter_ = reporter; }

  /// One frame passes: executes its datagrams in order and ORs this slave's event requests into
  /// them. Allocates nothing.
  void process(std::span<DatagramView> datagrams, const FrameTiming& timing);

  /// A frame with a malformed datagram passed (0x030C).
  void count_malformed_frame();
  /// An error was seen at `port` (0..3).
  void count_receive_error(unsigned port, ReceiveError error);

  /// The host made an access that its interface refused: counts it (0x030D) and keeps the cause
  /// (0x030E, coded as the datasheet's "PDI Error Code").
  void count_host_error(std::uint8_t code);

  /// What the status LEDs show, with or without override (0x0138, 0x0139).
  [[nodiscard]] LedCode run_led() const;
  [[nodiscard]] LedCode error_led() const;
  /// What the link/activity LED of a port shows (ETG.1300): off without link, on with one,
  /// flickering while frames pass.
  [[nodiscard]] LedCode link_led(unsigned port) const;

  /// A cable with a powered device at its other end came to `port` or went. Whether that gives a
  /// link is up to the PHY, its link pin, and the controller.
  void set_link(unsigned port, bool up);
  [[nodiscard]] bool link(unsigned port) const { return ports_.link(port); }
  /// What the device at the other end of the cable of port 0 or 1 can do.
  void set_link_partner(unsigned port, LinkPartner partner);
  /// Holds the link pin of `port` at a level; nothing: the PHY drives it again.
  void hold_link_pin(unsigned port, std::optional<bool> level);
  [[nodiscard]] bool link_pin(unsigned port) const { return ports_.pin(port); }
  /// A frame leaves through the port; false: it is turned back inside (loop closed).
  [[nodiscard]] bool port_open(unsigned port) const { return ports_.open(port); }
  /// The chip has this port (0x0007).
  [[nodiscard]] bool has_port(unsigned port) const { return ports_.has(port); }
  /// What of ports and delays decides on the way of frames.
  [[nodiscard]] SlaveForwarding forwarding() const { return ports_.forwarding(); }
  /// From port to port, as the size of the receive FIFO (0x0102) makes it.
  [[nodiscard]] base::SimDuration forwarding_delay() const { return ports_.forwarding_delay(); }
  /// As SlaveControllerConfiguration::forwarding_delay, for the board at hand.
  void set_forwarding_delay(base::SimDuration delay) {
    configuration_.forwarding_delay = delay;
    ports_.note_topology_change();
  }
  /// Makes the controller set `*changed` whenever forwarding() may have changed; null ends that.
  void watch_topology(bool* changed) { ports_.watch_topology(changed); }
  /// A valid frame came in at a closed port, where it ends: Auto Close opens the port.
  void receive_at_closed_port(unsigned port);
  /// The forwarding rule (0x0100 bit 0) for frames that carry no EtherCAT datagrams.
  [[nodiscard]] bool destroys_foreign_frames() const {
    return register_bit(register_address::kDlControl, 0);
  }

  /// As ProcessDataInterface says; the time of the access is that of the last frame or advance().
  void read(std::uint16_t address, std::span<std::byte> out) override;
  void write(std::uint16_t address, std::span<const std::byte> data) override;
  [[nodiscard]] std::uint32_t al_event_request() const override {
    return host_open_ ? al_event_request_ : 0U;
  }
  /// An EEPROM is loaded and names the host interface that is built, an SPI slave (0x0110 bit 0,
  /// 0x0140 = 05h; datasheets "ESC DL Status" and "PDI Control").
  [[nodiscard]] bool answers() const override { return host_open_; }
  /// The interrupt pin: AL events that the mask 0x0204 lets through.
  [[nodiscard]] bool host_interrupt() const;

  /// The PDI watchdog (0x0410) supervises a host that polls all the time. Simulated firmware runs
  /// only when something happens, so by default it counts as polling. `false`: the host hangs, and
  /// from now on only real accesses restart the watchdog.
  void set_host_polling(bool polling);

  // Logic on the same chip and its view of the process memory, see MemoryPartner; null: none.
  void set_memory_partner(MemoryPartner* partner);
  void read_process_data(std::uint16_t address, std::span<std::byte> out) const;
  void write_process_data(std::uint16_t address, std::span<const std::byte> data);
  void finish_process_data(std::uint16_t address, std::size_t length);

  /// Puts an EEPROM with this SII image on the board and loads from it as after power-on: PDI
  /// configuration, station alias, SYNC pulse length. Without a valid one process memory (DL status
  /// bit 0) and host interface are closed, until one is written and loaded. Allocates.
  void load_sii(std::span<const std::byte> image);
  /// The EEPROM's content with all that was written to it.
  [[nodiscard]] std::span<const std::byte> sii() const { return sii_.content(); }
  /// Null: the EEPROM's content lasts as long as the controller.
  void set_sii_keeper(SiiKeeper* keeper) { sii_.set_keeper(keeper); }
  /// See SiiInterface::finish_write().
  void finish_sii_write(bool kept, base::SimTime now) {
    sii_.finish_write(kept, now);
    update_deadline();
  }

  /// Lets a byte of the EEPROM read wrong, see SiiInterface::corrupt().
  void corrupt_sii(std::size_t offset, std::uint8_t mask) { sii_.corrupt(offset, mask); }

  /// Brings the controller to `now`; a `now` before the last one is ignored.
  void advance(base::SimTime now);
  /// No later than the next moment at which something happens without an access.
  [[nodiscard]] base::SimTime next_deadline() const { return next_deadline_; }
  [[nodiscard]] base::SimTime now() const { return now_; }
  /// From now() on the oscillator runs fast by so much.
  void set_clock_deviation(std::int32_t ppb);
  /// System time of the distributed clock, ns.
  [[nodiscard]] std::uint64_t system_time(base::SimTime t) const {
    return clock_unit_.system_time(t);
  }

  /// The SYNC outputs of the distributed clocks (`output` 0 or 1), as a host that wired the pin to
  /// an interrupt sees them. Pulses cost nothing while nobody asks: no deadline is made for them
  /// unless an AL event has to be raised.
  ///
  /// When the next pulse begins, as the clock runs at present; it changes with each correction of
  /// the clock. never() if none is to come.
  [[nodiscard]] base::SimTime next_sync_edge(unsigned output);
  /// Pulses up to now() since power-on; more than one further than last time if nobody looked.
  [[nodiscard]] std::uint64_t sync_pulse_count(unsigned output);
  /// True while a pulse lasts; in acknowledge mode (0x0982 = 0) until the host has read its status.
  [[nodiscard]] bool sync_output(unsigned output);
  /// What the pin does, with driver and polarity of 0x0151.
  [[nodiscard]] PinLevel sync_pin(unsigned output);
  /// Sets the level at latch input 0 or 1 from now() on; call advance() first.
  void set_latch_input(unsigned input, bool level);

  /// The pin PDI_WDSTATE: false once the process data watchdog has expired.
  [[nodiscard]] bool process_data_watchdog_state() const {
    return !process_data_watchdog_.expired();
  }
  /// Counts what restarted that watchdog: pulses at the pin PDI_WDTRIGGER.
  [[nodiscard]] std::uint32_t process_data_watchdog_triggers() const { return watchdog_triggers_; }

  /// Power-on reset: all registers to their reset values, EEPROM loaded again, links as they are.
  void power_on_reset();
  /// Power comes back after a failure: power_on_reset() with an empty process memory, and a request
  /// to the board to start its firmware again.
  void restore_power();
  /// True once after master or host have completed the reset sequence (0x0040, 0x0041), or after
  /// restore_power(). The controller has then been reset; the board resets its firmware too. With
  /// SlaveControllerConfiguration::reset_by_board it waits for the board's power_on_reset().
  [[nodiscard]] bool take_reset_request();
  /// Holds the chip in reset, or lets it go with restore_power(). Meanwhile no port has a link.
  void hold_reset(bool hold);
  [[nodiscard]] bool held_in_reset() const { return ports_.held_in_reset(); }

  /// Copies memory as it is, with no rights and no effects, for displays and tests; addresses
  /// outside the memory read 0. Registers computed at each access (event requests, watchdog status,
  /// system time) show what was read last.
  void peek(std::uint16_t address, std::span<std::byte> out) const;
  [[nodiscard]] const SyncManager& sync_manager(std::size_t channel) const {
    return sync_managers_[channel];
  }
  [[nodiscard]] const SlaveControllerConfiguration& configuration() const { return configuration_; }

 private:
  using Side = AccessSide;
  // slave_controller.cpp: life, time, host accesses
  void load_configuration_area(bool first);
  void open_host_interface();
  void report_missing_phys();
  void load_parameter_ram();
  void note_host_access();
  void expire(base::SimTime now);
  void update_deadline();
  void request_reset(Side by);

  // frame_processing.cpp
  void begin_frame_work();
  void end_frame_work(const FrameTiming& timing);
  void process_physical(DatagramView& datagram);
  void read_datagram(DatagramView& datagram, bool broadcast);
  void write_datagram(DatagramView& datagram);
  void exchange_datagram(DatagramView& datagram, bool broadcast, std::uint16_t write_address);

  // port_effects.cpp
  void take_link_change(unsigned port, Ports::LinkChange change);
  void update_link(unsigned port) { take_link_change(port, ports_.update_link(port)); }
  void update_dl_status();
  void apply_loop_control();

  // memory_access.cpp: bytes of both sides, with rights
  bool read_memory(Side side, std::uint32_t address, std::span<std::byte> out);
  bool write_memory(Side side, std::uint32_t address, std::span<const std::byte> data,
                    std::uint8_t first_mask = 0xFF, std::uint8_t last_mask = 0xFF);
  bool read_registers(Side side, std::uint32_t address, std::span<std::byte> out);
  bool write_registers(Side side, std::uint32_t address, std::span<const std::byte> data,
                       std::uint8_t first_mask, std::uint8_t last_mask);
  bool read_area(Side side, std::size_t channel, std::uint32_t address, std::span<std::byte> out);
  bool write_area(Side side, std::size_t channel, std::uint32_t address,
                  std::span<const std::byte> data, std::uint8_t first_mask, std::uint8_t last_mask);
  void tell_partner_of_write(Side side, std::uint32_t address, std::size_t length);
  struct Piece {
    std::size_t channel;  ///< sync manager in charge, kNoChannel for plain memory
    std::size_t length;
  };
  static constexpr std::size_t kNoChannel = kMaximumSyncManagers;
  [[nodiscard]] Piece piece_at(std::uint32_t address, std::size_t length) const;
  [[nodiscard]] bool register_bit(std::size_t address, unsigned bit) const {
    return (std::to_integer<unsigned>(memory_[address]) >> bit & 1U) != 0;
  }
  /// Whether a condition lets a side write a register byte that it has the right to write.
  [[nodiscard]] bool accepts_write(Side side, std::size_t address) const;
  [[nodiscard]] bool accepts_bus_write(Effect effect, std::size_t address) const;
  [[nodiscard]] bool accepts_host_write(Effect effect, std::size_t address) const;
  [[nodiscard]] bool protects_writes() const;
  [[nodiscard]] bool write_protected(std::uint32_t address) const;

  // logical_access.cpp
  void process_logical(DatagramView& datagram);
  [[nodiscard]] bool concerns(const DatagramView& datagram) const {
    const std::uint32_t last = datagram.address + (datagram.length - 1U);
    return datagram.address <= logical_last_ &&
           (last >= logical_first_ || last < datagram.address) && datagram.length != 0;
  }
  void process_logical_bitwise(DatagramView& datagram, bool reads, bool writes);
  void compile_mappings();
  [[nodiscard]] bool compile_mapping(const Fmmu& fmmu);

  // command_effects.cpp
  void start_sii_command();
  void start_mii_command();

  // status_leds.cpp, with run_led() and error_led()
  void show_leds();

  // register_effects.cpp
  void before_read(EffectSet effects);
  void after_bus_read(EffectSet effects);
  void after_host_read(EffectSet effects, std::uint32_t address, std::size_t length);
  void after_bus_write(EffectSet effects, std::uint32_t address, std::span<const std::byte> data);
  void after_host_write(EffectSet effects, std::uint32_t address, std::span<const std::byte> data);
  /// What a write causes from either side.
  void after_write(Effect effect, std::uint32_t address, std::size_t length);
  void acknowledge(EffectSet effects, std::uint32_t address, std::size_t length);
  void take_al_control();
  /// Reports a request for a state that the slave has not taken and, without a host, will not take.
  void report_unanswered_al_control(std::uint16_t requested, bool locked);
  void change_al_status();
  void update_sync_managers(std::uint32_t address, std::size_t length);
  void configure_sync_manager(std::size_t channel);
  void update_watchdog_times();
  void clear_registers(std::size_t first, std::size_t last);
  void count(std::size_t address);

  // clock_effects.cpp
  void take_clock_work(unsigned work) {
    frame_work_ |= static_cast<std::uint8_t>(work);
    if ((work & ClockWork::kAny) != 0) [[unlikely]] {
      follow_clocks(work);
    }
  }
  void follow_clocks(unsigned work);
  void advance_sync() { take_clock_work(clock_unit_.advance(now_)); }
  void latch_buffer_event(Side side, std::size_t channel, bool start, bool change);

  /// Makes status register and event requests follow the state of a sync manager.
  void publish_sync_manager(std::size_t channel) {
    const SyncManager& manager = sync_managers_[channel];
    memory_[register_address::kSyncManagers + 8 * channel + 5] = std::byte{manager.status()};
    if (manager.interrupts_host()) {
      const std::uint32_t bit = al_event::sync_manager(static_cast<unsigned>(channel));
      al_event_request_ = (al_event_request_ & ~bit) | (manager.host_interrupt() ? bit : 0U);
    }
    if (manager.interrupts_bus()) {
      set_ecat_event(ecat_event::sync_manager(channel), manager.bus_interrupt());
    }
  }
  void trigger_process_data_watchdog() {
    ++watchdog_triggers_;
    process_data_watchdog_.trigger(now_);
    next_deadline_ = std::min(next_deadline_, process_data_watchdog_.deadline());
  }
  void set_ecat_event(std::uint16_t bit, bool pending) {
    ecat_event_request_ = static_cast<std::uint16_t>(pending ? ecat_event_request_ | bit
                                                             : ecat_event_request_ & ~bit);
    interrupt_ = ecat_event_request_ & ecat_event_mask_;
  }

  [[nodiscard]] std::span<std::byte, kRegisterSpace> registers() {
    return std::span<std::byte, kRegisterSpace>(memory_.data(), kRegisterSpace);
  }

  // Bits of a sync manager's activate register: which accesses are time-stamped at 0x09F0..0x09FF.
  static constexpr std::uint8_t kLatchBusEvents = 0x40;
  static constexpr std::uint8_t kLatchHostEvents = 0x80;
  static constexpr std::uint8_t kLatchEvents = kLatchBusEvents | kLatchHostEvents;

  // What every datagram needs, together at the front.
  std::uint32_t logical_first_ = 0xFFFFFFFF;  ///< lowest mapped logical address
  std::uint32_t logical_last_ = 0;            ///< highest mapped logical address
  std::uint16_t station_address_ = 0;
  std::uint16_t station_alias_ = 0;
  std::uint16_t interrupt_ = 0;  ///< for the IRQ field of datagrams
  std::uint16_t ecat_event_request_ = 0;
  std::uint16_t ecat_event_mask_ = 0;
  std::uint8_t frame_work_ = 0;
  bool alias_enabled_ = false;
  bool direct_only_ = false;  ///< all active FMMUs are direct mappings
  std::uint8_t write_mapping_count_ = 0;
  std::uint8_t read_mapping_count_ = 0;
  std::uint32_t al_event_request_ = 0;
  base::SimTime now_;
  base::SimTime frame_start_;  ///< when the present frame reached the processing unit
  base::SimTime next_deadline_ = base::SimTime::never();
  std::array<DirectMapping, kMaximumFmmus> write_mappings_{};
  std::array<DirectMapping, kMaximumFmmus> read_mappings_{};
  std::array<SyncManager, kMaximumSyncManagers> sync_managers_{};
  Watchdog process_data_watchdog_;
  MemoryPartner* partner_ = nullptr;

  std::vector<std::byte> memory_;  ///< registers, then process memory
  SlaveControllerConfiguration configuration_;
  RegisterMap register_map_;
  SiiInterface sii_;
  MiiManagement mii_;
  Ports ports_{registers(), configuration_, mii_};
  base::EventReporter reporter_;
  DistributedClockUnit clock_unit_{registers(), configuration_, reporter_};
  Watchdog host_watchdog_;
  ResetSequence reset_sequence_{registers()};
  std::uint32_t watchdog_triggers_ = 0;

  std::array<Fmmu, kMaximumFmmus> fmmus_{};  ///< active ones, for the bitwise path
  std::size_t fmmu_count_ = 0;
  std::array<std::uint8_t, kMaximumSyncManagers> activations_{};  ///< activate registers in force
  std::uint16_t changed_activations_ = 0;  ///< sync managers whose change the host has not seen
  std::uint16_t al_status_ = 1;            ///< as last reported to the bus
  bool al_control_taken_ = true;           ///< the host has seen the last AL control
  bool loaded_ = false;                    ///< EEPROM valid: process memory open
  bool enhanced_link_detection_ = false;   ///< of any port, as first loaded after power-on
  bool host_open_ = false;                 ///< see answers()
  bool host_seen_ = false;                 ///< somebody has used the host interface, or tried to
  bool host_polling_ = true;
  bool registers_unlocked_ = false;   ///< by 0x0020, for the rest of this frame
  bool controller_unlocked_ = false;  ///< by 0x0030
  bool reset_requested_ = false;
};

}  // namespace stator::ethercat
