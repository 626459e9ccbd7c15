#include "ethercat/mii_management.hpp"

#include <utility>

#include "base/byte_order.hpp"
#include "ethercat/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

using base::load_le;
using base::store_le;

// Bits of 0x0510.
constexpr std::uint16_t kWriteEnable = 0x0001;
constexpr std::uint16_t kShownAddress = 0x00F8;
constexpr unsigned kShownAddressShift = 3;
constexpr std::uint16_t kCommandMask = 0x0300;
constexpr std::uint16_t kReadError = 0x2000;
constexpr std::uint16_t kCommandError = 0x4000;
constexpr std::uint16_t kBusy = 0x8000;

// Bits of 0x0512.
constexpr unsigned kAddressMask = 0x1F;
constexpr unsigned kShowPort = 0x80;

// Bits of 0x0518..0x051B.
constexpr unsigned kPhyLink = 0x01;
constexpr unsigned kUsableLink = 0x02;
constexpr unsigned kPortReadError = 0x08;

// Registers of IEEE 802.3 clause 22.
enum PhyRegister : unsigned {
  kBasicControl = 0,
  kBasicStatus = 1,
  kIdentifierHigh = 2,
  kIdentifierLow = 3,
  kAdvertisement = 4,
  kPartnerAbility = 5,
  kExpansion = 6,
};
/// Reset and restart of negotiation are done as soon as they are written.
constexpr std::uint16_t kSelfClearing = 0x8200;
constexpr std::uint16_t kControlReset = 0x8000;
/// 10 and 100 Mbit/s in both duplex modes, short preambles, negotiation, extended registers.
constexpr std::uint16_t kStatusAbilities = 0x7849;
constexpr std::uint16_t kStatusLink = 0x0004;
constexpr std::uint16_t kStatusNegotiated = 0x0020;
/// A partner that has acknowledged and can do what this PHY can.
constexpr std::uint16_t kPartner = 0x41E1;
constexpr std::uint16_t kPartnerNegotiates = 0x0001;

}  // namespace

void Phy::reset() {
  control_ = kControlAfterReset;
  advertisement_ = kAbilities;
}

std::uint16_t Phy::read(unsigned number, bool link) const {
  switch (number) {
    case kBasicControl:
      return control_;
    case kBasicStatus:
      return link ? kStatusAbilities | kStatusLink | kStatusNegotiated : kStatusAbilities;
    case kIdentifierHigh:
      return static_cast<std::uint16_t>(identifier_ >> 16);
    case kIdentifierLow:
      return static_cast<std::uint16_t>(identifier_);
    case kAdvertisement:
      return advertisement_;
    case kPartnerAbility:
      return link ? kPartner : std::uint16_t{0};
    case kExpansion:
      return link ? kPartnerNegotiates : std::uint16_t{0};
    default:
      return 0xFFFF;
  }
}

void Phy::write(unsigned number, std::uint16_t value) {
  if (number == kBasicControl) {
    if ((value & kControlReset) != 0) {
      reset();
    } else {
      control_ = static_cast<std::uint16_t>(value & ~unsigned{kSelfClearing});
    }
  } else if (number == kAdvertisement) {
    advertisement_ = value;
  }
}

MiiManagement::MiiManagement(std::span<std::byte, kRegisterSpace> registers,
                             const MiiSettings& settings, bool detects_links)
    : registers_(registers),
      settings_(settings),
      detects_links_(detects_links),
      phys_{Phy(settings.phy_identifier), Phy(settings.phy_identifier)} {}

void MiiManagement::reset() {
  deadline_ = base::SimTime::never();
  command_ = Command::idle;
  for (std::size_t port = 0; port < kPortCount; ++port) {
    phys_[port].reset();
    read_error_[port] = port_at(static_cast<unsigned>(port) + settings_.phy_offset) != port;
  }
  update_port_address();
}

bool MiiManagement::host_owns() const {
  return (registers_[kMiiHostAccess] & std::byte{1}) != std::byte{0};
}

bool MiiManagement::host_may_take() const {
  return (registers_[kMiiBusAccess] & std::byte{1}) == std::byte{0};
}

void MiiManagement::update_owner() {
  if ((registers_[kMiiHostAccess] & std::byte{2}) != std::byte{0}) {
    registers_[kMiiHostAccess] &= std::byte{0xFE};
  }
  set_status(kWriteEnable, host_owns() ? kWriteEnable : std::uint16_t{0});
}

void MiiManagement::update_port_address() {
  const auto written = std::to_integer<unsigned>(registers_[kPhyAddress]);
  const unsigned port = (written & kShowPort) != 0 ? written & kAddressMask : 0;
  const unsigned shown = port < 4 ? port + settings_.phy_offset : 0;
  set_status(kShownAddress, static_cast<std::uint16_t>(shown << kShownAddressShift));
}

MiiManagement::CommandResult MiiManagement::start_command(base::SimTime now) {
  const auto status = load_le<std::uint16_t>(registers_, kMiiControl);
  const auto command = static_cast<Command>((status & kCommandMask) >> 8);
  set_status(kCommandMask | kReadError, 0);
  if (command == Command::idle) {
    set_status(kCommandError, 0);
    return CommandResult::idle;
  }
  if (command == Command::invalid) {
    set_status(0, kCommandError);
    return CommandResult::invalid;
  }
  if (command == Command::write && (status & kWriteEnable) == 0) {
    set_status(0, kCommandError);
    return CommandResult::not_write_enabled;
  }
  command_ = command;
  deadline_ = now + settings_.transfer;
  set_status(kCommandError, static_cast<std::uint16_t>(kBusy | (status & kCommandMask)));
  return CommandResult::started;
}

void MiiManagement::start_of_frame() {
  if (!host_owns()) {
    set_status(kWriteEnable, 0);
  }
}

void MiiManagement::finish(base::SimTime now, unsigned links) {
  if (now < deadline_) {
    return;
  }
  deadline_ = base::SimTime::never();
  set_status(kBusy | kCommandMask, 0);
  const Command command = std::exchange(command_, Command::idle);
  const unsigned address = std::to_integer<unsigned>(registers_[kPhyAddress]) & kAddressMask;
  const unsigned number = std::to_integer<unsigned>(registers_[kPhyRegister]) & kAddressMask;
  const std::size_t port = port_at(address);
  const bool answers = port < kPortCount && Phy::has_register(number);
  if (command == Command::read) {
    const bool link = (links >> port & 1U) != 0;
    store_le(registers_, kPhyData,
             answers ? phys_[port].read(number, link) : std::uint16_t{0xFFFF});
    set_status(0, answers ? std::uint16_t{0} : kReadError);
  } else if (answers) {
    phys_[port].write(number, load_le<std::uint16_t>(registers_, kPhyData));
  }
}

void MiiManagement::show_port_status(unsigned links) {
  for (std::size_t port = 0; port < kPortCount; ++port) {
    unsigned status = read_error_[port] ? kPortReadError : 0U;
    const bool found = port_at(static_cast<unsigned>(port) + settings_.phy_offset) == port;
    if (found && (links >> port & 1U) != 0) {
      status |= kPhyLink | kUsableLink;
    }
    registers_[kPhyPortStatus + port] = static_cast<std::byte>(detects_links_ ? status : 0U);
  }
}

void MiiManagement::clear_port_errors() {
  read_error_.fill(false);
}

std::size_t MiiManagement::port_at(unsigned address) const {
  for (std::size_t port = 0; port < kPortCount; ++port) {
    if (settings_.phy_addresses[port] == address) {
      return port;
    }
  }
  return kPortCount;
}

void MiiManagement::set_status(std::uint16_t clear, std::uint16_t set) {
  const unsigned status = load_le<std::uint16_t>(registers_, kMiiControl);
  store_le(registers_, kMiiControl, static_cast<std::uint16_t>((status & ~unsigned{clear}) | set));
}

}  // namespace stator::ethercat
