#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/board/assembly/block_pins.hpp"
#include "stator/board/assembly/board.hpp"
#include "stator/devices/tmc8461/block_on_controller.hpp"
#include "stator/devices/tmc8461/configuration.hpp"
#include "stator/devices/tmc8461/mfc_spi_memory.hpp"
#include "stator/devices/tmc8461/process_data_objects.hpp"
#include "stator/ethercat/controller/controller_spi_memory.hpp"
#include "stator/product/device/ethercat_device.hpp"

namespace stator::devices {

/// The TMC8461 of Trinamic as a chip on a board (TMC8461 datasheet): its slave controller, EEPROM,
/// configuration pins, and the pins to a controller beside it. There is no firmware inside. Either
/// the AL state follows the master by itself (device emulation), or a controller at the PDI
/// answers: a program of one's own through HostPort.
///
/// What its configuration wires to the pins of the I/O block goes through time with it; signals and
/// inputs of those peripherals are the device's.
///
/// Lines are looked at when something happens; edges on the clock alone (SYNC, LEDs, watchdogs) are
/// stopped at only while somebody watches them, so an idle chip costs nothing.
class Tmc8461 final : public product::EtherCatDevice,
                      public product::HostPort,
                      private mfc::PinListener {
 public:
  /// Throws board::BoardError for what cannot be wired.
  explicit Tmc8461(const Tmc8461Configuration& configuration, base::EventReporter reporter = {});

  // The device.
  [[nodiscard]] ethercat::SlaveController& controller() override { return controller_; }
  [[nodiscard]] const ethercat::SlaveController& controller() const override { return controller_; }
  [[nodiscard]] const ethercat::DeviceDescription& description() const override {
    return description_;
  }
  [[nodiscard]] const dictionary::Dictionary& dictionary() const override {
    return objects_.dictionary();
  }
  [[nodiscard]] dictionary::Dictionary& dictionary() override { return objects_.dictionary(); }
  [[nodiscard]] std::vector<std::byte> sii_image() const override;
  void advance(base::SimTime now) override;
  void handle_bus_events(base::SimTime now) override;
  void set_power(bool on, base::SimTime now) override;
  [[nodiscard]] std::vector<product::Signal> signals() const override;
  [[nodiscard]] std::vector<product::Input> inputs() override;
  [[nodiscard]] product::HostPort* host_port() override { return this; }
  [[nodiscard]] std::optional<product::TracedPins> traced_pins() override {
    return product::TracedPins{"tmc8461", board_, configuration_.board, io()};
  }
  [[nodiscard]] std::vector<board::KeptPart> kept_parts() override { return board_.kept_parts(); }

  // The controller beside it.
  void select(product::HostSpi spi) override;
  void transfer(product::HostSpi spi, std::span<const std::byte> mosi, std::span<std::byte> miso,
                std::optional<base::SimDuration> read_pause) override;
  void deselect(product::HostSpi spi, unsigned surplus_clocks) override;
  [[nodiscard]] product::HostLines levels() override;
  void watch(product::HostLines watched, product::HostLineSink* sink) override;
  [[nodiscard]] base::SimTime next_line_change() override;
  void set_pin(product::HostPin pin, bool level) override;

  /// The multi-function I/O block with its pins, for plants, peripherals and instruments. Whoever
  /// acts there advances the chip first.
  [[nodiscard]] mfc::Block& io() { return io_; }
  /// What is wired to its pins.
  [[nodiscard]] board::Board& board() { return board_; }
  [[nodiscard]] const Tmc8461Configuration& configuration() const { return configuration_; }

  /// Resets since power-on that register 0x0040 or 0x0041 asked for.
  [[nodiscard]] std::uint32_t reset_requests() const { return reset_requests_; }

 private:
  /// A line or pin with its chip, for signals and inputs.
  struct Probe {
    Tmc8461* chip = nullptr;
    std::size_t number = 0;
    [[nodiscard]] double level() const;
    void drive(double value) const;
    [[nodiscard]] double io_level() const;
    void drive_io(double value) const;
  };

  [[nodiscard]] bool running() const { return powered_ && pins_[index(product::HostPin::reset)]; }
  static constexpr std::size_t index(product::HostPin pin) { return static_cast<std::size_t>(pin); }
  static constexpr std::size_t index(product::HostSpi spi) { return static_cast<std::size_t>(spi); }

  void step_to(base::SimTime moment);
  void trigger(mfc::Trigger trigger);

  // mfc::PinListener; pins are the board's.
  void pin_changed(base::SimTime /*time*/, std::size_t /*line*/, mfc::PinState /*state*/) override {
  }
  void interrupt_changed(base::SimTime time, bool level) override;

  [[nodiscard]] base::SimTime next_led_edge() const;
  void take_reset_request();
  void reset();
  void hold_reset(bool hold);
  /// What a reset does beside the slave controller's own.
  void reset_host_side();
  /// Tells the sink what has changed since last time; `pulses` rose and fell in between.
  void publish(product::HostLines pulses = 0);
  [[nodiscard]] product::HostLines sync_pulses();
  [[nodiscard]] bool lit(ethercat::LedCode code) const;
  [[nodiscard]] bool link_led(unsigned port) const;
  [[nodiscard]] double al_state() const;
  [[nodiscard]] double pdi_errors() const;
  [[nodiscard]] double interrupt_pin() const;

  Tmc8461Configuration configuration_;
  ethercat::DeviceDescription description_;
  tmc8461::ProcessDataObjects objects_;
  ethercat::SlaveController controller_;
  ethercat::ControllerSpiMemory pdi_memory_{controller_};
  mfc::Block io_;
  tmc8461::BlockOnController halves_{controller_, io_};
  board::BlockPins board_pins_{io_, this};
  board::Board board_{configuration_.board, board_pins_, base::SimTime()};
  tmc8461::MfcSpiMemory mfc_memory_{io_, controller_, configuration_.shared_bus};
  std::array<ethercat::SpiSlavePort, product::kHostSpis> ports_{
      ethercat::SpiSlavePort(pdi_memory_), ethercat::SpiSlavePort(mfc_memory_)};

  base::SimTime now_;
  base::SimTime last_frame_ = base::SimTime::never();
  bool powered_ = true;
  bool reset_out_ = false;
  bool host_seen_ = false;  ///< something has used the PDI
  std::uint32_t reset_requests_ = 0;
  std::array<bool, product::kHostPins> pins_{};

  product::HostLineSink* sink_ = nullptr;
  product::HostLines watched_ = 0;
  product::HostLines reported_levels_ = 0;  ///< levels as the sink knows them
  std::array<std::uint64_t, 2> sync_counts_{};
  std::array<base::SimTime, 2> sync_ends_{base::SimTime::never(), base::SimTime::never()};
  std::uint32_t watchdog_triggers_ = 0;
  std::array<Probe, product::kHostLines> line_probes_{};
  std::array<Probe, product::kHostPins> pin_probes_{};
  std::array<Probe, mfc::kLines> io_probes_{};
};

}  // namespace stator::devices
