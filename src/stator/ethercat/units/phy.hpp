#pragma once

#include <cstdint>

namespace stator::ethercat {

/// What the other end of a PHY's cable can do.
enum class LinkPartner : std::uint8_t {
  full,         ///< negotiates 100 Mbit/s full duplex, which is what EtherCAT needs
  ten_megabit,  ///< negotiates, but 10 Mbit/s at most
  half_duplex,  ///< negotiates, but half duplex only
  fixed,        ///< set to 100 Mbit/s without negotiation: the PHY takes it for half duplex
};

/// A PHY with registers 0..6 of IEEE 802.3 clause 22. What it negotiates with its partner is
/// settled when the cable is plugged, when negotiation is restarted or switched on or off, and at a
/// reset, each time at once. The link bit shows the present link and does not hold a short
/// interruption.
class Phy {
 public:
  static constexpr std::uint16_t kControlAfterReset =
      0x3100;  ///< register 0: 100 Mbit/s full duplex, negotiates

  /// `strapped_control` is register 0 as the pins of the board set it at a reset.
  explicit Phy(std::uint32_t identifier = 0, std::uint16_t strapped_control = kControlAfterReset)
      : identifier_(identifier), strapped_control_(strapped_control) {}

  void reset();
  [[nodiscard]] static bool has_register(unsigned number) { return number <= 6; }
  [[nodiscard]] std::uint16_t read(unsigned number) const;
  /// True if that made the PHY settle its link anew.
  bool write(unsigned number, std::uint16_t value);

  /// A cable with somebody switched on at its other end is plugged or pulled.
  void set_carrier(bool carrier);
  void set_partner(LinkPartner partner);

  /// Register 1 bit 2: there is a link of whatever kind.
  [[nodiscard]] bool link() const { return modes_ != 0; }
  /// A link at 100 Mbit/s full duplex that both ends have negotiated.
  [[nodiscard]] bool usable() const;
  /// There is a link, but the partner cannot negotiate 100 Mbit/s full duplex.
  [[nodiscard]] bool partner_error() const;
  /// Its registers let it negotiate 100 Mbit/s full duplex.
  [[nodiscard]] bool configured() const;
  /// Writes its registers so and restarts negotiation.
  void configure();

 private:
  static constexpr std::uint16_t kAbilities = 0x01E1;  ///< 10 and 100 Mbit/s, half and full

  void negotiate();

  std::uint32_t identifier_;
  std::uint16_t strapped_control_;
  std::uint16_t control_ = strapped_control_;
  std::uint16_t advertisement_ = kAbilities;
  std::uint16_t modes_ = 0;  ///< what both ends can do, coded as in register 4; 0: no link
  LinkPartner partner_ = LinkPartner::full;
  bool carrier_ = false;
};

}  // namespace stator::ethercat
