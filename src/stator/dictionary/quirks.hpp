#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "stator/base/sim_time.hpp"

namespace stator::dictionary {

/// What a device with an object dictionary does otherwise than its kind should, so that masters can
/// be tried against it. All off by default. CoE stacks and CANopen nodes act on those that
/// quirks() says they have.
struct Quirks {
  // SDO.
  bool no_complete_access = false;
  bool no_sdo_information = false;
  bool no_segments = false;
  bool no_block_transfer = false;
  bool size_not_indicated = false;
  bool toggle_stuck = false;
  bool abort_with_size = false;
  bool short_sdo = false;
  base::SimDuration slow_sdo{};

  // Mailbox.
  bool no_mailbox_repeat = false;
  bool repeats_executed = false;
  bool mailbox_counter_zero = false;

  // Process data.
  bool one_pdo = false;
  bool fixed_mapping = false;
  bool any_process_data_length = false;

  // Start and identity.
  base::SimDuration late_boot{};
  bool no_boot_up_message = false;
  std::optional<std::uint32_t> wrong_vendor{};
  std::optional<std::uint32_t> wrong_product{};
  std::optional<std::uint32_t> wrong_revision{};
  std::string wrong_name{};

  // Emergencies.
  unsigned emergency_storm = 0;  ///< per second
};

/// One quirk as rack files name it. Rack section, documents and `stator describe --quirks` derive
/// from the table of all.
struct QuirkDeclaration {
  using Member = std::variant<bool Quirks::*, base::SimDuration Quirks::*, unsigned Quirks::*,
                              std::optional<std::uint32_t> Quirks::*, std::string Quirks::*>;

  std::string_view name;
  Member member;
  bool coe = false;          ///< EtherCAT slaves with CoE have it
  bool canopen = false;      ///< CANopen nodes have it
  std::string_view summary;  ///< what the device does then
  std::string_view trap;     ///< what goes wrong in a master that does not expect it
  // Of quirks with a parameter: a duration in ns, else a plain number.
  std::int64_t minimum = 0;
  std::int64_t maximum = 0;
  std::int64_t usual = 0;  ///< when the quirk is named without a parameter
};

[[nodiscard]] std::span<const QuirkDeclaration> quirks();

/// Code of the emergencies of a storm: device-specific (CiA 301 table 27), which no product of ours
/// sends otherwise.
inline constexpr std::uint16_t kStormEmergency = 0xFF77;

}  // namespace stator::dictionary
