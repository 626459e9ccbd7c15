#include "stator/ethercat/units/phy.hpp"

namespace stator::ethercat {

namespace {

// Registers of IEEE 802.3 clause 22.
constexpr unsigned kBasicControl = 0;
constexpr unsigned kBasicStatus = 1;
constexpr unsigned kIdentifierHigh = 2;
constexpr unsigned kIdentifierLow = 3;
constexpr unsigned kAdvertisement = 4;
constexpr unsigned kPartnerAbility = 5;
constexpr unsigned kExpansion = 6;

// Bits of register 0. Reset and restart of negotiation are done as soon as they are written.
constexpr std::uint16_t kControlReset = 0x8000;
constexpr std::uint16_t kControlRestart = 0x0200;
constexpr std::uint16_t kSelfClearing = kControlReset | kControlRestart;
constexpr std::uint16_t kControl100Megabit = 0x2000;
constexpr std::uint16_t kControlNegotiates = 0x1000;
constexpr std::uint16_t kControlPowerDown = 0x0800;
constexpr std::uint16_t kControlFullDuplex = 0x0100;

/// 10 and 100 Mbit/s in both duplex modes, short preambles, negotiation, extended registers.
constexpr std::uint16_t kStatusAbilities = 0x7849;
constexpr std::uint16_t kStatusLink = 0x0004;
constexpr std::uint16_t kStatusNegotiated = 0x0020;
constexpr std::uint16_t kPartnerNegotiates = 0x0001;

// Bits of registers 4 and 5.
constexpr std::uint16_t k10Half = 0x0020;
constexpr std::uint16_t k10Full = 0x0040;
constexpr std::uint16_t k100Half = 0x0080;
constexpr std::uint16_t k100Full = 0x0100;
constexpr std::uint16_t kModes = k10Half | k10Full | k100Half | k100Full;

/// Register 5 with each kind of partner. One that negotiates has acknowledged; of one that does not
/// the PHY sees only the speed (parallel detection).
constexpr std::uint16_t abilities(LinkPartner partner) {
  constexpr std::uint16_t kAcknowledged = 0x4001;
  switch (partner) {
    case LinkPartner::full:
      return kAcknowledged | kModes;
    case LinkPartner::ten_megabit:
      return kAcknowledged | k10Half | k10Full;
    case LinkPartner::half_duplex:
      return kAcknowledged | k10Half | k100Half;
    case LinkPartner::fixed:
      break;
  }
  return k100Half;
}

}  // namespace

void Phy::reset() {
  control_ = strapped_control_;
  advertisement_ = kAbilities;
  negotiate();
}

std::uint16_t Phy::read(unsigned number) const {
  const bool negotiates = (control_ & kControlNegotiates) != 0;
  switch (number) {
    case kBasicControl:
      return control_;
    case kBasicStatus:
      return static_cast<std::uint16_t>(kStatusAbilities | (link() ? kStatusLink : 0U) |
                                        (link() && negotiates ? kStatusNegotiated : 0U));
    case kIdentifierHigh:
      return static_cast<std::uint16_t>(identifier_ >> 16);
    case kIdentifierLow:
      return static_cast<std::uint16_t>(identifier_);
    case kAdvertisement:
      return advertisement_;
    case kPartnerAbility:
      return link() && negotiates ? abilities(partner_) : std::uint16_t{0};
    case kExpansion:
      return link() && negotiates && partner_ != LinkPartner::fixed ? kPartnerNegotiates
                                                                    : std::uint16_t{0};
    default:
      return 0xFFFF;
  }
}

bool Phy::write(unsigned number, std::uint16_t value) {
  if (number == kAdvertisement) {
    advertisement_ = value;  // counts from the next negotiation on
  }
  if (number != kBasicControl) {
    return false;
  }
  if ((value & kControlReset) != 0) {
    reset();
    return true;
  }
  const auto stored = static_cast<std::uint16_t>(value & ~unsigned{kSelfClearing});
  const bool negotiates = (value & kControlNegotiates) != 0;
  constexpr std::uint16_t kSwitches = kControlNegotiates | kControlPowerDown;
  const bool settles =
      !negotiates || (value & kControlRestart) != 0 || ((stored ^ control_) & kSwitches) != 0;
  control_ = stored;
  if (settles) {
    negotiate();
  }
  return settles;
}

void Phy::set_carrier(bool carrier) {
  if (carrier_ != carrier) {
    carrier_ = carrier;
    negotiate();
  }
}

void Phy::set_partner(LinkPartner partner) {
  partner_ = partner;
  negotiate();
}

void Phy::negotiate() {
  unsigned own = advertisement_ & kModes;
  if ((control_ & kControlNegotiates) == 0) {
    const bool full = (control_ & kControlFullDuplex) != 0;
    own = (control_ & kControl100Megabit) != 0 ? (full ? k100Full : k100Half)
                                               : (full ? k10Full : k10Half);
    // The partner finds the speed alone and takes this end for half duplex.
    own |= own >> 1 & (k10Half | k100Half);
  }
  const bool powered = (control_ & kControlPowerDown) == 0;
  modes_ = static_cast<std::uint16_t>(carrier_ && powered ? own & abilities(partner_) : 0U);
}

bool Phy::usable() const {
  return (control_ & kControlNegotiates) != 0 && (modes_ & k100Full) != 0;
}

bool Phy::partner_error() const {
  return link() && partner_ != LinkPartner::full;
}

bool Phy::configured() const {
  return (control_ & kControlNegotiates) != 0 && (control_ & kControlPowerDown) == 0 &&
         (advertisement_ & k100Full) != 0;
}

void Phy::configure() {
  control_ = kControlAfterReset;
  advertisement_ = kAbilities;
  negotiate();
}

}  // namespace stator::ethercat
