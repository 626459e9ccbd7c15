// Data link: ports and their loops, DL status, error counters.

#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

/// With this size or a smaller one, forwarding starts earlier (datasheet, "ESC DL Control").
constexpr unsigned kLargestReducedFifo = 3;
constexpr base::SimDuration kReducedFifoGain{40};
/// "About 1 s" in the datasheet.
constexpr base::SimDuration kTemporaryLoopControl{1'000'000'000};

enum LoopSetting : unsigned { automatic = 0, auto_close = 1, always_open = 2, always_closed = 3 };

}  // namespace

void SlaveController::count_malformed_frame() {
  count(kProcessingUnitErrors);
}

void SlaveController::count_receive_error(unsigned port, ReceiveError error) {
  if (!ports_[port].open) {
    return;  // only enabled ports count
  }
  switch (error) {
    case ReceiveError::invalid_frame:
      count(kReceiveErrors + 2 * std::size_t{port});
      break;
    case ReceiveError::physical:
      count(kReceiveErrors + 1 + 2 * std::size_t{port});
      break;
    case ReceiveError::forwarded_error:
      count(kForwardedErrors + std::size_t{port});
      break;
  }
}

void SlaveController::set_link(unsigned port, bool up) {
  up = up && has_port(port);
  if (ports_[port].carrier == up) {
    return;
  }
  ports_[port].carrier = up;
  if (MiiManagement::has_phy(port)) {
    mii_.set_carrier(port, up);
  }
  note_topology_change();
  update_link(port);
}

void SlaveController::set_link_partner(unsigned port, LinkPartner partner) {
  if (MiiManagement::has_phy(port)) {
    mii_.set_partner(port, partner);
    note_topology_change();
    update_link(port);
  }
}

void SlaveController::hold_link_pin(unsigned port, std::optional<bool> level) {
  ports_[port].pin = level;
  update_link(port);
}

bool SlaveController::passes_bits(unsigned port) const {
  return ports_[port].carrier && !held_in_reset_ &&
         (!MiiManagement::has_phy(port) || mii_.usable(port));
}

bool SlaveController::link_pin(unsigned port) const {
  const bool active_high = MiiManagement::has_phy(port)
                               ? configuration_.mii.phy_link_active_high[port]
                               : configuration_.link_active_high;
  return ports_[port].pin.value_or(passes_bits(port) == active_high);
}

void SlaveController::update_link(unsigned port) {
  // The pin alone would do; with link detection the PHY's registers must agree, so that it must be
  // found.
  const bool found = !MiiManagement::has_phy(port) || mii_.finds(port);
  const bool detected =
      !has_feature(configuration_.features, ControllerFeature::mii_link_detection) ||
      (found && passes_bits(port));
  const bool up = has_port(port) && !held_in_reset_ && detected &&
                  link_pin(port) == configuration_.link_active_high;
  if (ports_[port].link == up) {
    return;
  }
  const unsigned setting = loop_control_ >> (2 * port) & 3U;
  if (!up && ports_[port].open && setting == automatic) {
    count(kLostLinks + std::size_t{port});
  }
  ports_[port].link = up;
  update_ports(false);
}

void SlaveController::update_ports(bool loop_control_written) {
  loop_control_ = std::to_integer<std::uint8_t>(memory_[kLoopControl]);
  for (unsigned i = 0; i < kPorts; ++i) {
    Port& port = ports_[i];
    const unsigned setting = loop_control_ >> (2 * i) & 3U;
    bool open = false;
    switch (setting) {
      case automatic:
        open = port.link;
        break;
      case auto_close:
        // Opens again only when the setting is written while the link is up.
        open = port.link && (port.open || loop_control_written);
        break;
      case always_open:
        open = true;
        break;
      default:
        break;
    }
    port.open = open && has_port(i);
  }
  note_topology_change();
  update_dl_status();
}

SlaveForwarding SlaveController::forwarding() const {
  SlaveForwarding forwarding;
  for (unsigned i = 0; i < kPorts; ++i) {
    forwarding.open_ports |= static_cast<std::uint8_t>((ports_[i].open ? 1U : 0U) << i);
    forwarding.links |=
        static_cast<std::uint8_t>((ports_[i].link && passes_bits(i) ? 1U : 0U) << i);
  }
  for (unsigned i = 0; i < configuration_.mii.transmit_shift.size(); ++i) {
    forwarding.transmit_delay[i] = transmit_delay(configuration_.mii, i);
  }
  forwarding.clock_deviation_ppb = configuration_.clock_deviation_ppb;
  forwarding.fifo_size = std::to_integer<std::uint8_t>(memory_[kReceiveFifoSize]) & 7U;
  const unsigned setting = loop_control_ & 3U;
  forwarding.marks_circulating = !ports_[0].link && (setting == automatic || setting == auto_close);
  forwarding.delay = forwarding_delay();
  return forwarding;
}

base::SimDuration SlaveController::forwarding_delay() const {
  const unsigned fifo_size = std::to_integer<unsigned>(memory_[kReceiveFifoSize]) & 7U;
  const bool reduced = fifo_size <= kLargestReducedFifo;
  return configuration_.forwarding_delay - (reduced ? kReducedFifoGain : base::SimDuration());
}

void SlaveController::receive_at_closed_port(unsigned port) {
  const unsigned setting = loop_control_ >> (2 * port) & 3U;
  if (setting == auto_close && ports_[port].link && has_port(port)) {
    ports_[port].open = true;
    note_topology_change();
    update_dl_status();
  }
}

void SlaveController::update_dl_status() {
  const bool host_alive = host_open_ && (host_polling_ || host_watchdog_.running());
  unsigned status =
      (loaded_ ? 0x01U : 0U) | (host_alive ? 0x02U : 0U) | (enhanced_link_detection_ ? 0x04U : 0U);
  for (unsigned i = 0; i < kPorts; ++i) {
    // Communication is the link's, whether or not the loop lets frames use it.
    const unsigned link = ports_[i].link ? 1U : 0U;
    status |= link << (4 + i) | link << (9 + 2 * i);
    status |= (ports_[i].open ? 0U : 1U) << (8 + 2 * i);
  }
  const auto former = base::load_le<std::uint16_t>(registers(), kDlStatus);
  if (former != status) {
    base::store_le(registers(), kDlStatus, static_cast<std::uint16_t>(status));
    set_ecat_event(ecat_event::kDlStatus, true);
  }
}

void SlaveController::apply_loop_control() {
  if (register_bit(kDlControl, 1)) {
    if (loop_control_expires_ == base::SimTime::never()) {
      former_loop_control_ = loop_control_;
    }
    loop_control_expires_ = now_ + kTemporaryLoopControl;
    next_deadline_ = std::min(next_deadline_, loop_control_expires_);
  } else {
    loop_control_expires_ = base::SimTime::never();
  }
  update_ports(true);
}

}  // namespace stator::ethercat
