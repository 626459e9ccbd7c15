#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/registers/register_table.hpp"
#include "stator/ethercat/units/phy.hpp"

namespace stator::ethercat {

/// The PHYs of a board and how the controller reaches them.
struct MiiSettings {
  std::uint8_t phy_offset = 0;                      ///< pin PHY_OFFSET: port n is at n + offset
  std::array<std::uint8_t, 2> phy_addresses{0, 1};  ///< where the PHYs of ports 0 and 1 really are
  std::uint32_t phy_identifier = 0x00221560;        ///< registers 2 and 3: a Micrel KSZ8081
  /// Register 0 of each PHY after a reset, as its pins are strapped.
  std::array<std::uint16_t, 2> phy_control{Phy::kControlAfterReset, Phy::kControlAfterReset};
  std::array<bool, 2> phy_link_active_high{};  ///< polarity of the PHYs' link pins
  /// Straps MIIx_TX_SHIFT, 0..3: steps of 10 ns by which ports 0 and 1 send later, so that the PHY
  /// finds the signals stable at its clock.
  std::array<std::uint8_t, 2> transmit_shift{};
  /// Pins MIIx_TXCLK are connected: the controller finds the steps itself and the straps are idle.
  bool automatic_transmit_shift = false;
  /// ns by which the PHYs' transmit clocks are late against the controller's, 0..30.
  std::array<std::uint8_t, 2> transmit_clock_phase{};
  /// One transfer on the management bus: 64 bits at 2.5 MHz (IEEE 802.3 clause 22).
  base::SimDuration transfer = base::SimDuration(25'600);
};

/// What a strapped or found shift adds to everything that leaves port 0 or 1.
[[nodiscard]] base::SimDuration transmit_delay(const MiiSettings& settings, unsigned port);

/// Registers 0x0510..0x051B, through which master or host reads and writes the PHYs (ETG.1000.4
/// §6.6; TMC8461 datasheet "MII management"). Works on the controller's register memory. Busy is a
/// deadline; finish() completes what is due.
///
/// With link detection the controller configures PHYs that would not negotiate 100 Mbit/s full
/// duplex, whenever these settle their link anew, and shows that in the port status.
class MiiManagement {
 public:
  MiiManagement(std::span<std::byte, kRegisterSpace> registers, const MiiSettings& settings,
                bool detects_links);

  /// Registers and PHYs after power-on.
  void reset();

  [[nodiscard]] bool busy() const { return deadline_ != base::SimTime::never(); }
  [[nodiscard]] bool host_owns() const;
  [[nodiscard]] bool bus_may_write() const { return !host_owns() && !busy(); }
  [[nodiscard]] bool host_may_write() const { return host_owns() && !busy(); }
  /// 0x0516 is the bus's to write while the host has no access.
  [[nodiscard]] bool bus_may_claim() const { return !host_owns(); }
  /// 0x0517 bit 0 is the host's to write while the bus claims no exclusive access.
  [[nodiscard]] bool host_may_take() const;

  /// After a write to 0x0516 or 0x0517: a forced release takes the interface from the host.
  void update_owner();
  /// After a write to 0x0512: shows the port's PHY address in 0x0510 bits 7:3.
  void update_port_address();

  /// What became of a command.
  enum class CommandResult : std::uint8_t {
    started,
    idle,               ///< command 0: errors cleared
    invalid,            ///< command 3
    not_write_enabled,  ///< write without 0x0510 bit 0 in the same frame
  };
  /// Runs what a write to 0x0510..0x0511 has left in the command bits.
  CommandResult start_command(base::SimTime now);

  /// A new frame begins: the bus's write enable of an earlier frame is over.
  void start_of_frame();

  /// Completes the transfer if it is due.
  void finish(base::SimTime now);
  [[nodiscard]] base::SimTime deadline() const { return deadline_; }

  // The cables of ports 0 and 1; of other ports nothing is known here.
  void set_carrier(unsigned port, bool carrier);
  void set_partner(unsigned port, LinkPartner partner);
  /// The PHY of the port has a link on which the port can exchange frames.
  [[nodiscard]] bool usable(unsigned port) const { return phys_[port].usable(); }
  /// The PHY of the port answers where link detection looks for it.
  [[nodiscard]] bool finds(std::size_t port) const {
    return port_at(expected_address(port)) == port;
  }
  /// The address at which link detection looks for the PHY of the port.
  [[nodiscard]] unsigned expected_address(std::size_t port) const {
    return static_cast<unsigned>(port) + settings_.phy_offset;
  }
  [[nodiscard]] static bool has_phy(unsigned port) { return port < kPortCount; }

  /// Writes the port status registers as they are to be read now.
  void show_port_status();
  /// After a write to any of them: the sticky bits of all are cleared.
  void clear_port_errors();

 private:
  enum class Command : std::uint8_t { idle = 0, read = 1, write = 2, invalid = 3 };
  static constexpr std::size_t kPortCount = 2;

  void set_status(std::uint16_t clear, std::uint16_t set);
  /// Port whose PHY answers at `address`; kPortCount if none does.
  [[nodiscard]] std::size_t port_at(unsigned address) const;
  /// After the PHY has settled its link: configures it if that could not give a usable one.
  void check_configuration(std::size_t port);

  std::span<std::byte, kRegisterSpace> registers_;
  MiiSettings settings_;
  bool detects_links_;
  std::array<Phy, kPortCount> phys_;
  std::array<bool, kPortCount> read_error_{};  ///< link detection did not find the port's PHY
  std::array<bool, kPortCount> configuration_updated_{};
  base::SimTime deadline_ = base::SimTime::never();
  Command command_ = Command::idle;
};

}  // namespace stator::ethercat
