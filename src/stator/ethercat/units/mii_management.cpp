#include "stator/ethercat/units/mii_management.hpp"

#include <algorithm>
#include <utility>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

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
constexpr unsigned kLinkInhibited = 0x04;
constexpr unsigned kPortReadError = 0x08;
constexpr unsigned kPartnerError = 0x10;
constexpr unsigned kConfigurationUpdated = 0x20;

constexpr int kShiftStep = 10;  // ns
constexpr int kLargestShift = 3;

}  // namespace

base::SimDuration transmit_delay(const MiiSettings& settings, unsigned port) {
  const int late = settings.transmit_clock_phase[port];
  const int steps = settings.automatic_transmit_shift
                        ? std::min((late + kShiftStep - 1) / kShiftStep, kLargestShift)
                        : settings.transmit_shift[port] & kLargestShift;
  return base::SimDuration(std::int64_t{steps} * kShiftStep);
}

MiiManagement::MiiManagement(std::span<std::byte, kRegisterSpace> registers,
                             const MiiSettings& settings, bool detects_links)
    : registers_(registers),
      settings_(settings),
      detects_links_(detects_links),
      phys_{Phy(settings.phy_identifier, settings.phy_control[0]),
            Phy(settings.phy_identifier, settings.phy_control[1])} {}

void MiiManagement::reset() {
  deadline_ = base::SimTime::never();
  command_ = Command::idle;
  for (std::size_t port = 0; port < kPortCount; ++port) {
    phys_[port].reset();
    read_error_[port] = !finds(port);
    configuration_updated_[port] = false;
    check_configuration(port);
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

void MiiManagement::finish(base::SimTime now) {
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
    store_le(registers_, kPhyData, answers ? phys_[port].read(number) : std::uint16_t{0xFFFF});
    set_status(0, answers ? std::uint16_t{0} : kReadError);
  } else if (answers && phys_[port].write(number, load_le<std::uint16_t>(registers_, kPhyData))) {
    check_configuration(port);
  }
}

void MiiManagement::set_carrier(unsigned port, bool carrier) {
  phys_[port].set_carrier(carrier);
  check_configuration(port);
}

void MiiManagement::set_partner(unsigned port, LinkPartner partner) {
  phys_[port].set_partner(partner);
  check_configuration(port);
}

void MiiManagement::check_configuration(std::size_t port) {
  if (detects_links_ && finds(port) && !phys_[port].configured()) {
    phys_[port].configure();
    configuration_updated_[port] = true;
  }
}

void MiiManagement::show_port_status() {
  for (std::size_t port = 0; port < kPortCount; ++port) {
    const Phy& phy = phys_[port];
    unsigned status = read_error_[port] ? kPortReadError : 0U;
    status |= configuration_updated_[port] ? kConfigurationUpdated : 0U;
    if (finds(port) && phy.link()) {
      status |= kPhyLink | (phy.usable() ? kUsableLink : kLinkInhibited);
      status |= phy.partner_error() ? kPartnerError : 0U;
    }
    registers_[kPhyPortStatus + port] = static_cast<std::byte>(detects_links_ ? status : 0U);
  }
}

void MiiManagement::clear_port_errors() {
  read_error_.fill(false);
  configuration_updated_.fill(false);
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
