#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/canopen/cob_id.hpp"
#include "stator/dictionary/abort_code.hpp"
#include "stator/dictionary/quirks.hpp"

namespace stator::canopen {

/// Seen from the device: it consumes receive PDOs and produces transmit PDOs.
enum class PdoDirection : std::uint8_t { receive, transmit };

/// PDOs of one direction that CiA 301 has room for.
inline constexpr std::uint16_t kMaximumPdos = 512;
/// Most bits of process data in a PDO.
inline constexpr unsigned kMaximumPdoBits = 64;

// First objects of PDOs (CiA 301 §7.5.2.35 to §7.5.2.38).
inline constexpr std::uint16_t kReceivePdoCommunication = 0x1400;
inline constexpr std::uint16_t kReceivePdoMapping = 0x1600;
inline constexpr std::uint16_t kTransmitPdoCommunication = 0x1800;
inline constexpr std::uint16_t kTransmitPdoMapping = 0x1A00;

// Transmission types (CiA 301 tables 67 and 71).
inline constexpr std::uint8_t kAcyclicSynchronous = 0;
inline constexpr std::uint8_t kLastCyclicSynchronous = 240;
inline constexpr std::uint8_t kRemoteSynchronous = 252;
inline constexpr std::uint8_t kRemoteEventDriven = 253;
inline constexpr std::uint8_t kEventDrivenManufacturer = 254;
inline constexpr std::uint8_t kEventDrivenProfile = 255;

/// Transmission types from `first` to `last`.
struct TransmissionTypes {
  std::uint8_t first = 0;
  std::uint8_t last = 0;
};
inline constexpr std::array<TransmissionTypes, 2> kReceiveTypesOfCia301{{{0, 240}, {254, 255}}};
inline constexpr std::array<TransmissionTypes, 2> kTransmitTypesOfCia301{{{0, 240}, {252, 255}}};

/// What becomes of a receive PDO with more bytes than are mapped.
enum class LongPdo : std::uint8_t {
  process,             ///< the mapped ones are taken
  process_and_report,  ///< so, and emergency 8220h tells
  reject,              ///< nothing is taken, and emergency 8220h tells
};

/// What a product makes of the PDOs of CiA 301; the defaults are the standard's.
struct PdoRules {
  std::span<const TransmissionTypes> receive_types = kReceiveTypesOfCia301;
  std::span<const TransmissionTypes> transmit_types = kTransmitTypesOfCia301;
  /// Unit of 18xxh:03.
  base::SimDuration inhibit_unit{100'000};
  /// Synchronous PDOs respect the inhibit time too: a SYNC that comes earlier is passed over.
  bool inhibit_synchronous = false;
  /// Data types that may stand in a receive PDO as a gap: bit n for the type with index n, 1 to 7.
  std::uint8_t dummy_usage = 0xFE;
  /// Mapping objects may be written while the PDO is valid.
  bool map_valid_pdos = false;
  /// Answer to a write to a mapping object while the PDO is valid, or to one of its entries while
  /// the number of entries is not 0.
  dictionary::AbortCode mapping_locked = dictionary::AbortCode::unsupported_access;
  /// Answer to a mapping entry whose length is not that of its object.
  dictionary::AbortCode wrong_entry_length = dictionary::AbortCode::length_mismatch;
  LongPdo long_pdo = LongPdo::process_and_report;
  CobIdRules cob_id{};
  bool one_pdo = false;        ///< quirk: only the first PDO of each direction can be made valid
  bool fixed_mapping = false;  ///< quirk: mapping objects cannot be written
};

/// The rules of a product, and what its quirks make of them.
[[nodiscard]] inline PdoRules with_quirks(PdoRules rules, const dictionary::Quirks& quirks) {
  rules.one_pdo = quirks.one_pdo;
  rules.fixed_mapping = quirks.fixed_mapping;
  return rules;
}

// Arguments: {0} index, {1} subindex, {2} name, then what the rule adds.
namespace rules {
inline constexpr base::EventRule kPdoOne{
    "pdo-one", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: it makes a second PDO valid, and the quirk one-pdo is "
    "on; take it off the device's table in the rack file"};
inline constexpr base::EventRule kPdoMappingFixed{
    "pdo-mapping-fixed", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: the quirk fixed-mapping is on; take it off the "
    "device's table in the rack file"};
inline constexpr base::EventRule kPdoTransmissionType{
    "pdo-transmission-type", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: the device does not support transmission type {3} "
    "here; see the object's description"};
inline constexpr base::EventRule kPdoValid{
    "pdo-valid", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: the PDO is valid; set bit 31 of {3:x4}:01 first"};
inline constexpr base::EventRule kPdoMappingActive{
    "pdo-mapping-active", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} entries are active; write 0 to {0:x4}:00 first"};
inline constexpr base::EventRule kPdoObjectMissing{
    "pdo-object-missing", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: there is no object {3:x4}:{4:x2} to map"};
inline constexpr base::EventRule kPdoNotMappable{
    "pdo-not-mappable", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3:x4}:{4:x2} cannot stand in a {5}; see the PDO "
    "column of the object list"};
inline constexpr base::EventRule kPdoEntryLength{
    "pdo-entry-length", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: it maps {3:x4}:{4:x2} with a length of its own; the "
    "object has {5} bits"};
inline constexpr base::EventRule kPdoTooLong{
    "pdo-too-long", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} entries with {4} bits; the PDO has {5} entries "
    "and 64 bits at most"};
inline constexpr base::EventRule kPdoLength{
    "pdo-length", base::Severity::warning,
    "PDO with {2} bytes came for {0:x4}, which maps {1}: {3}; make both ends map the same"};
inline constexpr base::EventRule kPdoValueRefused{
    "pdo-value-refused", base::Severity::refusal,
    "value {3} for {1:x4}:{2:x2} in the PDO of {0:x4} not taken: the object keeps its value; "
    "abort code {4:x8} tells why"};
}  // namespace rules

}  // namespace stator::canopen
