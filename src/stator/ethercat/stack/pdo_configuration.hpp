#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "stator/base/expected.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/quirks.hpp"

namespace stator::ethercat {

/// Seen from the device: receive = outputs of the master (SM2), transmit = its inputs (SM3).
enum class PdoDirection : std::uint8_t { receive, transmit };

inline constexpr std::uint16_t kSyncManagerTypeObject = 0x1C00;
inline constexpr std::uint16_t kOutputAssignment = 0x1C12;
inline constexpr std::uint16_t kInputAssignment = 0x1C13;

[[nodiscard]] constexpr std::uint16_t assignment_object(PdoDirection direction) {
  return direction == PdoDirection::receive ? kOutputAssignment : kInputAssignment;
}

/// The direction of the PDO with mapping object `index`; empty if `index` is none
/// (1600h..17FFh and 1A00h..1BFFh are).
[[nodiscard]] std::optional<PdoDirection> pdo_direction(std::uint16_t index);

/// One entry of a mapping object (CiA 301 §7.5.2.36): index, subindex, length.
struct MappingEntry {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t bits = 0;

  [[nodiscard]] static constexpr MappingEntry decode(std::uint64_t value) {
    return {static_cast<std::uint16_t>(value >> 16), static_cast<std::uint8_t>(value >> 8),
            static_cast<std::uint8_t>(value)};
  }
};

/// Most bytes of process data per direction.
struct PdoLimits {
  std::size_t receive_bytes = 0;
  std::size_t transmit_bytes = 0;
};

/// The rules for writing 1C00h, PDO mappings and PDO assignments (CiA 301 §7.5.2.36,
/// ETG.1000.6 §5.6.7.4): installed once as the check hooks of all these objects a dictionary has.
///
/// Entries change only while subindex 0 is 0; each must name an existing object that can be mapped
/// in this direction with its exact length; the whole must fit the process memory.
class PdoConfiguration {
 public:
  PdoConfiguration(dictionary::Dictionary& dictionary, const PdoLimits& limits,
                   dictionary::Quirks quirks = {});

  /// Pre-Operational is the only state in which the configuration may change.
  void allow_changes(bool allowed) { changes_allowed_ = allowed; }

  /// True for mapping and assignment objects: those whose subindex 0 must be 0 while entries
  /// change.
  [[nodiscard]] static bool is_configuration(std::uint16_t index);

  /// The abort code of a refused write where the declared range stands for a PDO's capacity:
  /// 06040042h for the number of mapped objects, 06090030h for the number of assigned PDOs.
  [[nodiscard]] static dictionary::AbortCode refine(const dictionary::Entry& entry,
                                                    dictionary::AbortCode code);

  /// The object that `mapping` puts into a PDO, null for padding, or why it cannot stand there.
  [[nodiscard]] base::Expected<const dictionary::Entry*, dictionary::Refusal> resolve(
      const dictionary::Entry& source, MappingEntry mapping, PdoDirection direction) const;

 private:
  using Entry = dictionary::Entry;
  using Verdict = dictionary::Verdict;

  [[nodiscard]] Verdict check_sync_manager_type(const Entry& entry, std::uint64_t value);
  [[nodiscard]] Verdict check_mapping_count(const Entry& entry, std::uint64_t count);
  [[nodiscard]] Verdict check_mapping_entry(const Entry& entry, std::uint64_t value);
  [[nodiscard]] Verdict check_assignment_count(const Entry& entry, std::uint64_t count);
  [[nodiscard]] Verdict check_assignment_entry(const Entry& entry, std::uint64_t value);
  [[nodiscard]] Verdict check_changeable(const Entry& entry) const;
  [[nodiscard]] Verdict check_length(const Entry& entry, std::size_t bits,
                                     PdoDirection direction) const;
  void install(const dictionary::Object& object);
  void assign_one_pdo();

  dictionary::Dictionary& dictionary_;
  PdoLimits limits_;
  dictionary::Quirks quirks_;
  bool changes_allowed_ = false;
};

// Arguments: {0} index, {1} subindex, {2} name of the written entry, then what the rule adds.
namespace rules {
inline constexpr base::EventRule kPdoState{
    "pdo-state", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: PDO mapping and assignment change in Pre-Operational "
    "only; request that state first"};
inline constexpr base::EventRule kPdoActive{
    "pdo-active", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: subindex 0 is {3}; write 0 to {0:x4}:00h before "
    "changing entries, then the number of entries"};
inline constexpr base::EventRule kPdoObjectMissing{
    "pdo-object-missing", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: it maps {3:x4}:{4:x2}, which does not exist"};
inline constexpr base::EventRule kPdoNotMappable{
    "pdo-not-mappable", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3:x4}:{4:x2} cannot stand in a {5}; see the PDO "
    "column "
    "of the object list"};
inline constexpr base::EventRule kPdoEntryLength{
    "pdo-entry-length", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: it maps {3:x4} with {4} bits, the object has {5}"};
inline constexpr base::EventRule kPdoTooLong{
    "pdo-too-long", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} bytes would be mapped, the process memory takes "
    "{4} in this direction"};
inline constexpr base::EventRule kPdoMissing{
    "pdo-missing", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3:x4} is not the mapping object of a {4} of this "
    "device"};
inline constexpr base::EventRule kPdoOne{
    "pdo-one", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} PDOs are to be assigned, and the quirk one-pdo "
    "is on; take it off the device's table in the rack file"};
inline constexpr base::EventRule kPdoMappingFixed{
    "pdo-mapping-fixed", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: the quirk fixed-mapping is on; take it off the "
    "device's table in the rack file"};
inline constexpr base::EventRule kPdoFixed{"pdo-fixed", base::Severity::refusal,
                                           "write to {0:x4}:{1:x2} \"{2}\" refused: the use of the "
                                           "sync managers is fixed, the value stays "
                                           "{3}"};
}  // namespace rules

}  // namespace stator::ethercat
