#include "stator/devices/tmc8461/tmc8461.hpp"

#include <algorithm>
#include <string>

#include "stator/base/byte_order.hpp"
#include "stator/devices/tmc8461/controller.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::devices {

namespace {

using base::SimDuration;
using base::SimTime;

constexpr std::uint16_t kMailboxes = 0x1000;
constexpr unsigned kSpiSlave = 0x05;
constexpr unsigned kDeviceEmulation = 1U << 8;  // 0x0141 bit 0
constexpr unsigned kClocks = 3U << 10;          // SYNC and latch units
constexpr std::uint8_t kSyncPinsAreOutputs = 0x44;

ethercat::DeviceDescription describe(const Tmc8461Configuration& configuration) {
  ethercat::DeviceDescription description;
  description.vendor_id = configuration.vendor_id;
  description.vendor_name = "TRINAMIC Motion Control GmbH & Co. KG";
  description.product_code = configuration.product_code;
  description.revision = configuration.revision;
  description.serial_number = configuration.serial_number;
  description.order_code = "TMC8461";
  description.name = configuration.name;
  description.group = "Slave controllers";
  description.station_alias = configuration.station_alias;
  const unsigned emulation = configuration.device_emulation ? kDeviceEmulation : 0U;
  description.pdi_control = static_cast<std::uint16_t>(kSpiSlave | kClocks | emulation);
  description.pdi_configuration = configuration.pdi_configuration;
  description.sync_latch_configuration = configuration.sync_latch_configuration;
  description.sync_pulse_length = configuration.sync_pulse_length;
  if (configuration.mailbox_bytes != 0) {
    description.receive_mailbox = {kMailboxes, configuration.mailbox_bytes};
    description.transmit_mailbox = {
        static_cast<std::uint16_t>(kMailboxes + configuration.mailbox_bytes),
        configuration.mailbox_bytes};
    description.coe = configuration.coe;
    description.sdo_information = configuration.coe;
  }
  description.output_offset = configuration.output_address;
  description.input_offset = configuration.input_address;
  description.distributed_clocks =
      (configuration.sync_latch_configuration & kSyncPinsAreOutputs) != 0;
  description.sii_size_kbit = configuration.large_eeprom ? 32 : 16;
  return description;
}

ethercat::SlaveControllerConfiguration controller_of(const Tmc8461Configuration& configuration) {
  ethercat::SlaveControllerConfiguration chip = tmc8461::kController.configuration;
  chip.device_emulation = configuration.device_emulation;
  chip.acknowledge_by_write = configuration.acknowledge_by_write;
  chip.reset_by_board = true;
  if (configuration.phy_offset) {
    chip.mii.phy_offset = 1;
    chip.mii.phy_addresses = {1, 2};
  }
  chip.link_active_high = configuration.link_polarity;
  chip.mii.phy_link_active_high = configuration.phy_link_active_high;
  chip.mii.automatic_transmit_shift = !configuration.tx_shift.has_value();
  chip.mii.transmit_shift.fill(configuration.tx_shift.value_or(std::uint8_t{0}));
  chip.mii.transmit_clock_phase = configuration.tx_clock_phase;
  chip.mii.phy_addresses = configuration.phy_addresses.value_or(chip.mii.phy_addresses);
  return chip;
}

/// The bytes reach a slave whose answer nobody sees.
void overhear(ethercat::SpiSlavePort& port, std::span<const std::byte> mosi,
              std::optional<SimDuration> read_pause) {
  std::array<std::byte, 64> unseen{};
  while (!mosi.empty()) {
    const std::size_t length = std::min(mosi.size(), unseen.size());
    port.transfer(mosi.first(length), std::span(unseen).first(length), read_pause);
    mosi = mosi.subspan(length);
  }
}

}  // namespace

Tmc8461::Tmc8461(const Tmc8461Configuration& configuration, base::EventReporter reporter)
    : configuration_(configuration),
      description_(describe(configuration)),
      objects_(configuration.output_bytes, configuration.input_bytes),
      controller_(controller_of(configuration)) {
  controller_.set_event_reporter(reporter);
  halves_.set_board(&board_);
  controller_.load_sii(sii_image());
  io_.set_emergency_pin(configuration_.emergency_released);
  pins_[index(product::HostPin::emergency)] = configuration_.emergency_released;
  pins_[index(product::HostPin::reset)] = true;
  for (std::size_t i = 0; i < product::kHostLines; ++i) {
    line_probes_[i] = {this, i};
  }
  for (std::size_t i = 0; i < product::kHostPins; ++i) {
    pin_probes_[i] = {this, i};
  }
  for (std::size_t i = 0; i < mfc::kLines; ++i) {
    io_probes_[i] = {this, i};
  }
}

std::vector<std::byte> Tmc8461::sii_image() const {
  return configuration_.sii.empty() ? ethercat::build_sii_image(description_, objects_.dictionary())
                                    : configuration_.sii;
}

void Tmc8461::advance(SimTime now) {
  if (!powered_) {
    if (now > now_) {
      halves_.advance_block(now);  // what is wired to its pins goes on without it
      now_ = now;
    }
    return;
  }
  for (SimTime next = next_line_change(); next < now; next = next_line_change()) {
    step_to(std::max(next, now_ + SimDuration(1)));
  }
  if (now > now_) {
    step_to(now);
  }
}

// Called with the moments at which something may happen; between them nothing does that steps have
// to stop at.
void Tmc8461::step_to(SimTime moment) {
  halves_.advance(moment);
  now_ = moment;
  publish();
}

void Tmc8461::trigger(mfc::Trigger trigger) {
  halves_.advance_block(now_);
  io_.trigger(trigger);
}

void Tmc8461::interrupt_changed(SimTime time, bool /*level*/) {
  now_ = std::max(now_, time);
  publish();
}

void Tmc8461::handle_bus_events(SimTime now) {
  if (!powered_) {
    return;
  }
  now_ = std::max(now_, now);
  last_frame_ = now_;
  take_reset_request();
  product::HostLines pulses = product::host_line(product::HostLine::start_of_frame) |
                              product::host_line(product::HostLine::end_of_frame);
  if (controller_.process_data_watchdog_triggers() != watchdog_triggers_) {
    watchdog_triggers_ = controller_.process_data_watchdog_triggers();
    pulses |= product::host_line(product::HostLine::watchdog_trigger);
  }
  publish(pulses);
}

// RESET_OUT rises; on a board with the loop that is a pulse at NRESET, which ends it (L522-L529).
void Tmc8461::take_reset_request() {
  if (!controller_.take_reset_request()) {
    return;
  }
  ++reset_requests_;
  reset_out_ = true;
  if (configuration_.reset_loop) {
    reset();
    publish(product::host_line(product::HostLine::reset_out));
  }
}

void Tmc8461::reset() {
  controller_.power_on_reset();
  reset_host_side();
}

// NRESET low resets the whole device (L497): it forwards no frames, and starts when the pin rises.
void Tmc8461::hold_reset(bool hold) {
  controller_.hold_reset(hold);
  static_cast<void>(controller_.take_reset_request());  // of the pin, no register
  reset_host_side();
}

void Tmc8461::reset_host_side() {
  reset_out_ = false;
  for (ethercat::SpiSlavePort& port : ports_) {
    port.reset();
  }
  if (host_seen_) {
    controller_.set_host_polling(false);
  }
}

void Tmc8461::set_power(bool on, SimTime now) {
  advance(now);
  powered_ = on;
  reset_out_ = false;
  for (ethercat::SpiSlavePort& port : ports_) {
    port.reset();
  }
  if (on) {
    static_cast<void>(controller_.take_reset_request());  // of the supply, no register
    if (host_seen_) {
      controller_.set_host_polling(false);
    }
  } else {
    io_.reset();  // its drivers let go of the pins, its registers are lost
  }
  publish();
}

void Tmc8461::select(product::HostSpi spi) {
  if (!running()) {
    return;
  }
  if (spi == product::HostSpi::pdi && !host_seen_) {
    host_seen_ = true;  // from now on the PDI watchdog supervises it
    controller_.set_host_polling(false);
  }
  trigger(spi == product::HostSpi::pdi ? mfc::Trigger::pdi_select : mfc::Trigger::mfc_select);
  if (spi == product::HostSpi::mfc) {
    mfc_memory_.begin();
  }
  ports_[index(spi)].select();
}

// On a shared bus everything selected hears the same bytes; MISO is that of the slave meant
// (L1189).
void Tmc8461::transfer(product::HostSpi spi, std::span<const std::byte> mosi,
                       std::span<std::byte> miso, std::optional<SimDuration> read_pause) {
  std::fill(miso.begin(), miso.end(), ethercat::SpiSlavePort::kUndefined);
  if (!running()) {
    return;
  }
  halves_.advance_block(now_);
  for (std::size_t other = 0; other < ports_.size(); ++other) {
    if (configuration_.shared_bus && other != index(spi) && ports_[other].selected()) {
      overhear(ports_[other], mosi, read_pause);
    }
  }
  ports_[index(spi)].transfer(mosi, miso, read_pause);
  take_reset_request();
  publish();
}

void Tmc8461::deselect(product::HostSpi spi, unsigned surplus_clocks) {
  if (!running()) {
    return;
  }
  ports_[index(spi)].deselect(surplus_clocks);
  trigger(spi == product::HostSpi::pdi ? mfc::Trigger::pdi_deselect : mfc::Trigger::mfc_deselect);
  publish();
}

void Tmc8461::set_pin(product::HostPin pin, bool level) {
  const bool before = pins_[index(pin)];
  pins_[index(pin)] = level;
  if (pin == product::HostPin::reset && before != level) {
    hold_reset(!level);
  } else if (pin == product::HostPin::latch0 || pin == product::HostPin::latch1) {
    halves_.set_latch_input(static_cast<unsigned>(pin), level);
  } else if (pin == product::HostPin::emergency) {
    halves_.advance_block(now_);
    io_.set_emergency_pin(level);
  }
  publish();
}

}  // namespace stator::devices
