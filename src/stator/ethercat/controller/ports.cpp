#include "stator/ethercat/controller/ports.hpp"

#include "stator/base/byte_order.hpp"
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

void Ports::reset() {
  loop_control_ = 0;
  loop_control_expires_ = base::SimTime::never();
}

Ports::LinkChange Ports::set_carrier(unsigned port, bool up) {
  up = up && has(port);
  if (ports_[port].carrier == up) {
    return LinkChange::none;
  }
  ports_[port].carrier = up;
  if (MiiManagement::has_phy(port)) {
    mii_.set_carrier(port, up);
  }
  note_topology_change();
  return update_link(port);
}

Ports::LinkChange Ports::set_partner(unsigned port, LinkPartner partner) {
  if (!MiiManagement::has_phy(port)) {
    return LinkChange::none;
  }
  mii_.set_partner(port, partner);
  note_topology_change();
  return update_link(port);
}

Ports::LinkChange Ports::hold_pin(unsigned port, std::optional<bool> level) {
  ports_[port].pin = level;
  return update_link(port);
}

bool Ports::passes_bits(unsigned port) const {
  return ports_[port].carrier && !held_in_reset_ &&
         (!MiiManagement::has_phy(port) || mii_.usable(port));
}

bool Ports::pin(unsigned port) const {
  const bool active_high = MiiManagement::has_phy(port)
                               ? configuration_.mii.phy_link_active_high[port]
                               : configuration_.link_active_high;
  return ports_[port].pin.value_or(passes_bits(port) == active_high);
}

Ports::LinkChange Ports::update_link(unsigned port) {
  // The pin alone would do; with link detection the PHY's registers must agree, so that it must be
  // found.
  const bool found = !MiiManagement::has_phy(port) || mii_.finds(port);
  const bool detected =
      !has_feature(configuration_.features, ControllerFeature::mii_link_detection) ||
      (found && passes_bits(port));
  const bool up =
      has(port) && !held_in_reset_ && detected && pin(port) == configuration_.link_active_high;
  if (ports_[port].link == up) {
    return LinkChange::none;
  }
  const bool lost = !up && ports_[port].open && loop_setting(port) == automatic;
  ports_[port].link = up;
  update_loops(false);
  return lost ? LinkChange::lost : LinkChange::changed;
}

void Ports::update_loops(bool loop_control_written) {
  loop_control_ = std::to_integer<std::uint8_t>(registers_[kLoopControl]);
  for (unsigned i = 0; i < kPortsPerSlave; ++i) {
    Port& port = ports_[i];
    bool open = false;
    switch (loop_setting(i)) {
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
    port.open = open && has(i);
  }
  note_topology_change();
}

SlaveForwarding Ports::forwarding() const {
  SlaveForwarding forwarding;
  for (unsigned i = 0; i < kPortsPerSlave; ++i) {
    forwarding.open_ports |= static_cast<std::uint8_t>((ports_[i].open ? 1U : 0U) << i);
    forwarding.links |=
        static_cast<std::uint8_t>((ports_[i].link && passes_bits(i) ? 1U : 0U) << i);
  }
  for (unsigned i = 0; i < configuration_.mii.transmit_shift.size(); ++i) {
    forwarding.transmit_delay[i] = transmit_delay(configuration_.mii, i);
  }
  forwarding.clock_deviation_ppb = configuration_.clock_deviation_ppb;
  forwarding.fifo_size = static_cast<std::uint8_t>(receive_fifo_size());
  const unsigned setting = loop_setting(0);
  forwarding.marks_circulating = !ports_[0].link && (setting == automatic || setting == auto_close);
  forwarding.delay = forwarding_delay();
  return forwarding;
}

base::SimDuration Ports::forwarding_delay() const {
  const bool reduced = receive_fifo_size() <= kLargestReducedFifo;
  return configuration_.forwarding_delay - (reduced ? kReducedFifoGain : base::SimDuration());
}

unsigned Ports::receive_fifo_size() const {
  return std::to_integer<unsigned>(registers_[kReceiveFifoSize]) & 7U;
}

bool Ports::receive_at_closed(unsigned port) {
  if (loop_setting(port) != auto_close || !ports_[port].link || !has(port)) {
    return false;
  }
  ports_[port].open = true;
  note_topology_change();
  return true;
}

bool Ports::show_dl_status(unsigned others) {
  unsigned status = others;
  for (unsigned i = 0; i < kPortsPerSlave; ++i) {
    // Communication is the link's, whether or not the loop lets frames use it.
    const unsigned link = ports_[i].link ? 1U : 0U;
    status |= link << (4 + i) | link << (9 + 2 * i);
    status |= (ports_[i].open ? 0U : 1U) << (8 + 2 * i);
  }
  const auto former = base::load_le<std::uint16_t>(registers_, kDlStatus);
  base::store_le(registers_, kDlStatus, static_cast<std::uint16_t>(status));
  return former != status;
}

void Ports::apply_loop_control(base::SimTime now) {
  constexpr std::byte kTemporaryUse{0x02};
  if ((registers_[kDlControl] & kTemporaryUse) != std::byte{0}) {
    if (loop_control_expires_ == base::SimTime::never()) {
      former_loop_control_ = loop_control_;
    }
    loop_control_expires_ = now + kTemporaryLoopControl;
  } else {
    loop_control_expires_ = base::SimTime::never();
  }
  update_loops(true);
}

void Ports::expire() {
  loop_control_expires_ = base::SimTime::never();
  registers_[kLoopControl] = std::byte{former_loop_control_};
  update_loops(true);
}

}  // namespace stator::ethercat
