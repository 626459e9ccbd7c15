#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/controller/spi_slave_port.hpp"

namespace stator::product {

/// The SPI slaves of a chip, by the number programs give them.
enum class HostSpi : std::uint8_t {
  pdi = 0,  ///< the slave controller
  mfc = 1,  ///< its multi-function I/O block (MFC CTRL)
};
inline constexpr std::size_t kHostSpis = 2;

/// What a chip tells the controller beside it, by bit number. Level 1 is the state the name says,
/// whatever voltage the pin has then.
enum class HostLine : std::uint8_t {
  interrupt = 0,          ///< PDI_SPI_IRQ: an AL event that the mask 0x0204 lets through
  sync0 = 1,              ///< SYNC_OUT0
  sync1 = 2,              ///< SYNC_OUT1
  reset_out = 3,          ///< RESET_OUT: a reset was asked for by register 0x0040 or 0x0041
  eeprom_loaded = 4,      ///< PROM_INIT
  run_led = 5,            ///< LED_RUN
  error_led = 6,          ///< LED_ERR
  link_activity0 = 7,     ///< LINK_ACT0
  link_activity1 = 8,     ///< LINK_ACT1
  watchdog_state = 9,     ///< PDI_WDSTATE: not expired
  watchdog_trigger = 10,  ///< PDI_WDTRIGGER, a pulse
  start_of_frame = 11,    ///< PDI_SOF, a pulse
  end_of_frame = 12,      ///< PDI_EOF, a pulse
  mfc_interrupt = 13,     ///< MFC_IRQ
  power = 14,             ///< the supply
};
inline constexpr std::size_t kHostLines = 15;
/// In the order of HostLine, as signals and programs name them.
inline constexpr std::array<std::string_view, kHostLines> kHostLineNames{
    "irq",           "sync0",   "sync1",     "reset_out", "prom_init",
    "led_run",       "led_err", "link_act0", "link_act1", "pdi_wdstate",
    "pdi_wdtrigger", "pdi_sof", "pdi_eof",   "mfc_irq",   "power"};

/// Levels or changes of lines: bit n is HostLine n.
using HostLines = std::uint16_t;
[[nodiscard]] constexpr HostLines host_line(HostLine line) {
  return static_cast<HostLines>(1U << static_cast<unsigned>(line));
}

/// Lines changed at one moment. One that rose and fell again is in both masks.
struct HostLineChange {
  base::SimTime time;
  HostLines levels = 0;  ///< of all lines, afterwards
  HostLines rose = 0;
  HostLines fell = 0;
};

/// Gets the changes of watched lines.
class HostLineSink {
 public:
  HostLineSink() = default;
  HostLineSink(const HostLineSink&) = delete;
  HostLineSink& operator=(const HostLineSink&) = delete;
  virtual ~HostLineSink() = default;
  /// May not call the port.
  virtual void on_lines(const HostLineChange& change) = 0;
};

/// What a controller drives.
enum class HostPin : std::uint8_t {
  latch0 = 0,     ///< LATCH_IN0
  latch1 = 1,     ///< LATCH_IN1
  emergency = 2,  ///< MFC_NES, low is an emergency
  reset = 3,      ///< NRESET, low resets; see HostPort::set_pin()
};
inline constexpr std::size_t kHostPins = 4;

/// The pins with which a chip is connected to the controller beside it: SPI slaves, lines, inputs.
/// The caller has brought the device to the present, at which everything happens.
class HostPort {
 public:
  HostPort() = default;
  HostPort(const HostPort&) = delete;
  HostPort& operator=(const HostPort&) = delete;
  virtual ~HostPort() = default;

  /// Chip select, bytes, and chip select's end with `surplus_clocks` (0..7) after the last byte.
  virtual void select(HostSpi spi) = 0;
  virtual void transfer(HostSpi spi, std::span<const std::byte> mosi, std::span<std::byte> miso,
                        std::optional<base::SimDuration> read_pause) = 0;
  virtual void deselect(HostSpi spi, unsigned surplus_clocks) = 0;
  /// A whole datagram.
  void exchange(HostSpi spi, std::span<const std::byte> mosi, std::span<std::byte> miso,
                const ethercat::SpiTiming& timing = {}) {
    select(spi);
    transfer(spi, mosi, miso, timing.read_pause);
    deselect(spi, timing.surplus_clocks);
  }

  [[nodiscard]] virtual HostLines levels() = 0;
  /// Tells `sink` of changes of the lines in `watched` from now on; null ends that. Only what is
  /// watched costs anything.
  virtual void watch(HostLines watched, HostLineSink* sink) = 0;
  /// No later than the next change of a watched line on the clock alone.
  [[nodiscard]] virtual base::SimTime next_line_change() = 0;

  /// Drives a pin. NRESET resets at its falling edge; while it is low the SPI slaves are silent.
  virtual void set_pin(HostPin pin, bool level) = 0;
};

}  // namespace stator::product
