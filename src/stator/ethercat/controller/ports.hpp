#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/controller/slave_controller_configuration.hpp"
#include "stator/ethercat/registers/register_table.hpp"
#include "stator/ethercat/standard/forwarding.hpp"
#include "stator/ethercat/units/mii_management.hpp"

namespace stator::ethercat {

/// The ports of a slave controller: their links and loops, by loop control (0x0101), and what of
/// them decides on the way of frames (datasheet "ESC DL Control", "ESC DL Status"). Works on the
/// controller's register memory and PHYs.
class Ports {
 public:
  /// What something at a port has done to its link.
  enum class LinkChange : std::uint8_t {
    none,
    changed,
    lost,  ///< likewise, and a lost link counts (0x0310..0x0313)
  };

  /// Keeps the references: follows what `configuration` and `mii` become.
  Ports(std::span<std::byte, kRegisterSpace> registers,
        const SlaveControllerConfiguration& configuration, MiiManagement& mii)
      : registers_(registers), configuration_(configuration), mii_(mii) {}

  /// As after power-on: no loop control in force. Cables and link pins stay as they are.
  void reset();
  /// While the chip is held in reset no port has a link, from the next update_link() on.
  void hold_in_reset(bool hold) { held_in_reset_ = hold; }
  /// The chip is held in reset.
  [[nodiscard]] bool held_in_reset() const { return held_in_reset_; }

  /// A cable with a powered device at its other end came to `port` or went.
  [[nodiscard]] LinkChange set_carrier(unsigned port, bool up);
  /// What the device at the other end of the cable of port 0 or 1 can do.
  [[nodiscard]] LinkChange set_partner(unsigned port, LinkPartner partner);
  /// Holds the link pin of `port` at a level; nothing: the PHY drives it again.
  [[nodiscard]] LinkChange hold_pin(unsigned port, std::optional<bool> level);
  /// Makes the link of `port` what PHY, pin and controller say together.
  [[nodiscard]] LinkChange update_link(unsigned port);

  /// The chip has this port (0x0007).
  [[nodiscard]] bool has(unsigned port) const {
    return port < kPortsPerSlave && (configuration_.port_descriptor >> (2 * port) & 3U) > 1;
  }
  /// The port has a link.
  [[nodiscard]] bool link(unsigned port) const { return ports_[port].link; }
  /// A frame leaves through the port; false: its loop is closed.
  [[nodiscard]] bool open(unsigned port) const { return ports_[port].open; }
  /// The level at the link pin of `port`.
  [[nodiscard]] bool pin(unsigned port) const;

  /// Loop control has been written, in a frame that ended at `now`.
  void apply_loop_control(base::SimTime now);
  /// When a temporary loop control ends.
  [[nodiscard]] base::SimTime deadline() const { return loop_control_expires_; }
  /// The deadline has come: the former loop control is in force again.
  void expire();
  /// A valid frame came in at a closed port; true: Auto Close has opened it.
  [[nodiscard]] bool receive_at_closed(unsigned port);

  /// Makes DL status follow the ports, with `others` as its bits 2:0; true if it has changed.
  [[nodiscard]] bool show_dl_status(unsigned others);

  /// What of ports and delays decides on the way of frames.
  [[nodiscard]] SlaveForwarding forwarding() const;
  /// From port to port, as the size of the receive FIFO (0x0102) makes it.
  [[nodiscard]] base::SimDuration forwarding_delay() const;
  /// Sets `*changed` whenever forwarding() may have changed; null ends that.
  void watch_topology(bool* changed) { topology_changed_ = changed; }
  /// Something that forwarding() tells may have changed.
  void note_topology_change() {
    if (topology_changed_ != nullptr) {
      *topology_changed_ = true;
    }
  }

 private:
  struct Port {
    bool carrier = false;  ///< a cable with somebody at its other end
    bool link = false;
    bool open = false;
    std::optional<bool> pin;  ///< level that somebody else than the PHY gives the link pin
  };

  [[nodiscard]] unsigned loop_setting(unsigned port) const {
    return loop_control_ >> (2 * port) & 3U;
  }
  /// Bits sent at the port are understood at the other end of its cable and the other way round.
  [[nodiscard]] bool passes_bits(unsigned port) const;
  [[nodiscard]] unsigned receive_fifo_size() const;
  void update_loops(bool loop_control_written);

  std::span<std::byte, kRegisterSpace> registers_;
  const SlaveControllerConfiguration& configuration_;
  MiiManagement& mii_;
  bool* topology_changed_ = nullptr;  ///< see watch_topology()
  std::array<Port, kPortsPerSlave> ports_{};
  base::SimTime loop_control_expires_ = base::SimTime::never();
  std::uint8_t loop_control_ = 0;         ///< 0x0101 as it is in force
  std::uint8_t former_loop_control_ = 0;  ///< in force again when the temporary one expires
  bool held_in_reset_ = false;
};

}  // namespace stator::ethercat
