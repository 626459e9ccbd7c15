#include "stator/ethercat/stack/sync_manager_settings.hpp"

#include "stator/base/byte_order.hpp"

namespace stator::ethercat {

namespace {

using base::EventArgument;

constexpr std::uint16_t kProcessMemoryStart = 0x1000;
constexpr std::size_t kRegisterBytes = 128;  ///< of 16 channels

const base::EventRule& length_rule(const SyncManagerRequirement& requirement) {
  return requirement.mode == SyncManagerSettings::kMailboxMode ? rules::kSyncManagerMailboxLength
                                                               : rules::kSyncManagerLength;
}

}  // namespace

SyncManagerBank read_sync_managers(ProcessDataInterface& interface) {
  std::array<std::byte, kRegisterBytes> bytes{};
  interface.read(register_address::kSyncManagers, bytes);
  SyncManagerBank bank;
  for (std::size_t channel = 0; channel < bank.size(); ++channel) {
    const auto registers = std::span(bytes).subspan(channel * 8, 8);
    bank[channel] = {.start = base::load_le<std::uint16_t>(registers, 0),
                     .length = base::load_le<std::uint16_t>(registers, 2),
                     .control = std::to_integer<std::uint8_t>(registers[4]),
                     .status = std::to_integer<std::uint8_t>(registers[5]),
                     .activate = std::to_integer<std::uint8_t>(registers[6]),
                     .host_control = std::to_integer<std::uint8_t>(registers[7])};
  }
  return bank;
}

std::optional<SyncManagerFault> check_sync_manager(const SyncManagerBank& bank,
                                                   const SyncManagerRequirement& requirement,
                                                   AlState state, AlStatusCode code) {
  const SyncManagerSettings& settings = bank[requirement.channel];
  const auto fault = [&](const base::EventRule& rule, EventArgument a = {}, EventArgument b = {},
                         EventArgument c = {}) {
    return SyncManagerFault{&rule,
                            {EventArgument(to_text(state)), EventArgument(static_cast<int>(code)),
                             EventArgument(requirement.channel), a, b, c}};
  };
  if (requirement.max_length == 0) {
    if (settings.enabled() && settings.length != 0) {
      return fault(rules::kSyncManagerUnmapped, int{settings.length});
    }
    return std::nullopt;
  }
  if (!settings.enabled()) {
    return fault(rules::kSyncManagerDisabled);
  }
  const int needed = requirement.mode | requirement.direction;
  if ((settings.control & 0x0F) != needed) {
    return fault(rules::kSyncManagerMode, int{settings.control}, needed);
  }
  if (settings.length < requirement.min_length || settings.length > requirement.max_length) {
    return fault(length_rule(requirement), int{settings.length}, requirement.min_length,
                 requirement.max_length);
  }
  if (settings.start < kProcessMemoryStart || settings.end() > requirement.memory_end) {
    return fault(rules::kSyncManagerArea, int{settings.start}, settings.end() - 1,
                 requirement.memory_end - 1);
  }
  for (unsigned other = 0; other < bank.size(); ++other) {
    if (other != requirement.channel && settings.overlaps(bank[other])) {
      return fault(rules::kSyncManagerOverlap, int{settings.start}, other, int{bank[other].start});
    }
  }
  return std::nullopt;
}

}  // namespace stator::ethercat
