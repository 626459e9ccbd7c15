#include "stator/canopen/nmt/lss_slave.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"

namespace stator::canopen {

namespace {

using base::SimDuration;
using base::SimTime;
using lss::Command;

constexpr std::uint16_t kIdentity = 0x1018;
constexpr std::size_t kRevision = 2;
constexpr std::size_t kSerial = 3;

constexpr base::EventRule kState{"lss-state", base::Severity::information, "LSS state: {0}"};
constexpr base::EventRule kNodeIdRefused{
    "lss-node-id", base::Severity::refusal,
    "LSS configure node-ID refused: {0} came, 1 to 127 are possible, and 255 for none"};
constexpr base::EventRule kBitRateRefused{
    "lss-bit-timing", base::Severity::refusal,
    "LSS configure bit timing refused: entry {1} of table {0} is no bit rate this device supports"};
constexpr base::EventRule kStoringRefused{"lss-store", base::Severity::refusal,
                                          "LSS store configuration refused: {0}"};
constexpr base::EventRule kWrongLength{"lss-length", base::Severity::refusal,
                                       "LSS message ignored: it has {0} data bytes, must have 8"};

/// One request of the service identify remote slave: the part of the address it is about, and how
/// the value must compare. Four of them give ranges of revision and serial number.
struct Identification {
  enum class Comparison : std::uint8_t { equal, at_least, at_most };
  std::size_t part;
  Comparison comparison;
};
constexpr std::array<Identification, 6> kIdentification{{
    {0, Identification::Comparison::equal},
    {1, Identification::Comparison::equal},
    {kRevision, Identification::Comparison::at_least},
    {kRevision, Identification::Comparison::at_most},
    {kSerial, Identification::Comparison::at_least},
    {kSerial, Identification::Comparison::at_most},
}};

bool holds(Identification::Comparison comparison, std::uint32_t own, std::uint32_t asked) {
  switch (comparison) {
    case Identification::Comparison::equal:
      return own == asked;
    case Identification::Comparison::at_least:
      return own >= asked;
    case Identification::Comparison::at_most:
      return own <= asked;
  }
  return false;
}

/// `command` counted from `first`.
std::size_t distance(Command command, Command first) {
  return static_cast<std::size_t>(command) - static_cast<std::size_t>(first);
}

}  // namespace

LssSlave::LssSlave(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
                   base::EventReporter reporter, const LssConfiguration& configuration)
    : transmitter_(transmitter), reporter_(reporter), configuration_(configuration) {
  for (std::size_t part = 0; part < kAddressParts; ++part) {
    identity_[part] = dictionary.find(kIdentity, static_cast<std::uint8_t>(part + 1));
  }
}

void LssSlave::forget_configuration() {
  pending_node_id_.reset();
  pending_bit_rate_.reset();
}

void LssSlave::start(SimTime /*now*/) {
  configuring_ = false;
  selective_matches_ = 0;
  identify_matches_ = 0;
  fastscan_part_ = 0;
  activation_ = SimTime::never();
}

std::uint32_t LssSlave::address(std::size_t part) const {
  if (identity_[part] != nullptr) {
    return static_cast<std::uint32_t>(identity_[part]->value());
  }
  return part == kSerial ? configuration_.serial_number : 0;
}

/// Has no node-ID and will have none after the next reset.
bool LssSlave::unconfigured() const {
  return active_node_id_ == kUnconfiguredNodeId &&
         pending_node_id_.value_or(kUnconfiguredNodeId) == kUnconfiguredNodeId;
}

bool LssSlave::receive(const can::Frame& frame, SimTime now) {
  if (frame.identifier != lss::kMasterIdentifier || frame.remote || frame.extended) {
    return false;
  }
  if (frame.length != can::kMaximumData) {
    reporter_.report(now, kWrongLength, {int{frame.length}});
    return true;
  }
  const std::span<const std::byte> data = frame.data;
  const auto command = static_cast<Command>(data[0]);
  const auto value = base::load_le<std::uint32_t>(data, 1);
  if (command == Command::switch_global) {
    switch_global(std::to_integer<std::uint8_t>(data[1]), now);
  } else if (command >= Command::switch_selective_vendor &&
             command <= Command::switch_selective_serial) {
    switch_selective(distance(command, Command::switch_selective_vendor), value, now);
  } else if (command >= Command::identify_vendor && command <= Command::identify_serial_high) {
    identify(distance(command, Command::identify_vendor), value);
  } else if (command == Command::identify_non_configured) {
    if (unconfigured()) {
      reply(Command::identify_non_configured_response);
    }
  } else if (command == Command::fastscan) {
    fastscan(data, now);
  } else if (configuring_) {
    configure(command, data, now);
  }
  return true;
}

void LssSlave::switch_global(std::uint8_t mode, SimTime now) {
  selective_matches_ = 0;
  if (mode == 1) {
    enter_configuration(now);
  } else if (mode == 0 && configuring_) {
    configuring_ = false;
    reporter_.report(now, kState, {"Waiting"});
  }
}

void LssSlave::enter_configuration(SimTime now) {
  if (!configuring_) {
    configuring_ = true;
    reporter_.report(now, kState, {"Configuration"});
  }
}

/// The master sends an LSS address part by part; the slave with this address answers the last.
void LssSlave::switch_selective(std::size_t part, std::uint32_t value, SimTime now) {
  if (part == 0) {
    selective_matches_ = 0;
  }
  selective_matches_ =
      part == selective_matches_ && value == address(part) ? selective_matches_ + 1 : 0;
  if (selective_matches_ == kAddressParts) {
    selective_matches_ = 0;
    enter_configuration(now);
    reply(Command::switch_selective_response);
  }
}

void LssSlave::identify(std::size_t stage, std::uint32_t value) {
  if (stage == 0) {
    identify_matches_ = 0;
  }
  const Identification& asked = kIdentification[stage];
  identify_matches_ =
      stage == identify_matches_ && holds(asked.comparison, address(asked.part), value)
          ? identify_matches_ + 1
          : 0;
  if (identify_matches_ == kIdentification.size()) {
    identify_matches_ = 0;
    reply(Command::identify_response);
  }
}

/// CiA 305 §6.3.4.3: the master guesses the address bit by bit from the highest; slaves without a
/// node-ID whose bits agree so far answer, all with the same frame.
void LssSlave::fastscan(std::span<const std::byte> data, SimTime now) {
  if (configuring_ || !unconfigured()) {
    return;
  }
  const auto guess = base::load_le<std::uint32_t>(data, 1);
  const auto bit_check = std::to_integer<std::uint8_t>(data[5]);
  const auto part = std::to_integer<std::uint8_t>(data[6]);
  const auto next = std::to_integer<std::uint8_t>(data[7]);
  if (bit_check == lss::kFastscanReset) {
    fastscan_part_ = 0;
    reply(Command::identify_response);
    return;
  }
  if (bit_check >= 32 || part >= kAddressParts || next >= kAddressParts || part != fastscan_part_ ||
      (guess ^ address(part)) >> bit_check != 0) {
    return;
  }
  reply(Command::identify_response);
  if (bit_check == 0) {
    fastscan_part_ = next;
    if (next < part) {  // all parts have been scanned
      enter_configuration(now);
    }
  }
}

/// Services of the state Configuration.
void LssSlave::configure(Command command, std::span<const std::byte> data, SimTime now) {
  const auto first = std::to_integer<std::uint8_t>(data[1]);
  switch (command) {
    case Command::configure_node_id:
      if (is_node_id(first) || first == kUnconfiguredNodeId) {
        pending_node_id_ = first;
        reply(command, lss::kSuccess);
      } else {
        reporter_.report(now, kNodeIdRefused, {int{first}});
        reply(command, lss::kNodeIdOutOfRange);
      }
      break;
    case Command::configure_bit_timing:
      reply(command, configure_bit_timing(first, std::to_integer<std::uint8_t>(data[2]), now));
      break;
    case Command::activate_bit_timing:
      activation_ =
          now + SimDuration(std::int64_t{base::load_le<std::uint16_t>(data, 1)} * 1'000'000);
      break;
    case Command::store_configuration:
      reply(command, store_configuration(now));
      break;
    case Command::inquire_vendor:
    case Command::inquire_product:
    case Command::inquire_revision:
    case Command::inquire_serial:
      reply(command, address(distance(command, Command::inquire_vendor)));
      break;
    case Command::inquire_node_id:
      reply(command, active_node_id_);
      break;
    default:
      break;
  }
}

std::uint8_t LssSlave::configure_bit_timing(std::uint8_t table, std::uint8_t index, SimTime now) {
  const std::uint32_t bit_rate =
      table == 0 && index < lss::kBitRates.size() ? lss::kBitRates[index] : 0;
  if (bit_rate == 0 || (hooks_.supports && !hooks_.supports(bit_rate))) {
    reporter_.report(now, kBitRateRefused, {int{table}, int{index}});
    return lss::kBitRateNotSupported;
  }
  pending_bit_rate_ = bit_rate;
  return lss::kSuccess;
}

std::uint8_t LssSlave::store_configuration(SimTime now) {
  if (!hooks_.store) {
    reporter_.report(now, kStoringRefused, {"the device cannot store"});
    return lss::kStoringNotSupported;
  }
  // The hook may call forget_pending_node_id(); a node-ID that LSS stores stays pending all the
  // same.
  const std::optional<std::uint8_t> node_id = pending_node_id_;
  const bool stored = hooks_.store(node_id, pending_bit_rate_);
  pending_node_id_ = node_id;
  if (!stored) {
    reporter_.report(now, kStoringRefused, {"the device's memory could not be written"});
    return lss::kStorageAccessError;
  }
  return lss::kSuccess;
}

void LssSlave::advance(SimTime now) {
  if (now < activation_) {
    return;
  }
  activation_ = SimTime::never();
  if (pending_bit_rate_ && hooks_.activate) {
    hooks_.activate(*pending_bit_rate_, now);
  }
}

void LssSlave::reply(Command command, std::uint32_t data) {
  std::array<std::byte, can::kMaximumData> bytes{static_cast<std::byte>(command)};
  base::store_le(std::span<std::byte>(bytes), 1, data);
  transmitter_.send(can::data_frame(lss::kSlaveIdentifier, bytes));
}

}  // namespace stator::canopen
