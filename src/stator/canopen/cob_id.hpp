#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "stator/base/event.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

// Bits of the objects that hold a COB-ID (CiA 301 §7.5.2.5, §7.5.2.17, §7.5.2.35, §7.5.2.37).
inline constexpr std::uint32_t kCobIdInvalid = 0x80000000;   ///< PDO and EMCY: does not exist
inline constexpr std::uint32_t kCobIdNoRemote = 0x40000000;  ///< TPDO: remote frames not answered
inline constexpr std::uint32_t kCobIdProduce = 0x40000000;   ///< SYNC and TIME: produced here
inline constexpr std::uint32_t kCobIdExtended = 0x20000000;  ///< a CAN-ID of 29 bits
inline constexpr std::uint32_t kCanIdMask = 0x7FF;

[[nodiscard]] constexpr std::uint16_t can_id_of(std::uint64_t cob_id) {
  return static_cast<std::uint16_t>(cob_id & kCanIdMask);
}

/// CAN-IDs from `first` to `last`.
struct CanIdRange {
  std::uint16_t first = 0;
  std::uint16_t last = 0;
};

/// CAN-IDs that no configurable communication object may use (CiA 301 table 41, "Restricted
/// CAN-IDs").
inline constexpr std::array<CanIdRange, 8> kRestrictedCanIds{{
    {0x000, 0x000},  // NMT
    {0x001, 0x07F},  // reserved
    {0x101, 0x180},  // reserved
    {0x581, 0x5FF},  // default SDO, server to client
    {0x601, 0x67F},  // default SDO, client to server
    {0x6E0, 0x6FF},  // reserved
    {0x701, 0x77F},  // NMT error control
    {0x780, 0x7FF},  // reserved, among them LSS
}};
[[nodiscard]] bool is_restricted(std::uint16_t can_id);

/// What a configurable COB-ID is for, which decides what its upper bits mean.
enum class CobIdKind : std::uint8_t { sync, time, emergency, receive_pdo, transmit_pdo };

/// Objects of one kind of COB-ID, `first` to `last`.
struct CobIdObjects {
  std::uint16_t first = 0;
  std::uint16_t last = 0;
  std::uint8_t subindex = 0;
  CobIdKind kind = CobIdKind::sync;
};
inline constexpr std::array<CobIdObjects, 5> kCobIdObjects{{
    {0x1005, 0x1005, 0, CobIdKind::sync},
    {0x1012, 0x1012, 0, CobIdKind::time},
    {0x1014, 0x1014, 0, CobIdKind::emergency},
    {0x1400, 0x15FF, 1, CobIdKind::receive_pdo},
    {0x1800, 0x19FF, 1, CobIdKind::transmit_pdo},
}};
/// The kind of COB-ID that the entry holds; empty if it holds none that can be configured.
[[nodiscard]] std::optional<CobIdKind> cob_id_kind(std::uint16_t index, std::uint8_t subindex);

/// What a product allows beyond or below CiA 301.
struct CobIdRules {
  bool produce_sync = true;             ///< 1005h bit 30 may be set
  bool produce_time = true;             ///< 1012h bit 30 may be set
  bool remote_requests = true;          ///< 18xxh:01 bit 30 may be 0: remote frames are answered
  bool receive_pdo_bit_30_set = false;  ///< 14xxh:01 bit 30, reserved by CiA 301, must be 1
  /// The CAN-ID of 1014h may be changed while the emergency object is valid.
  bool change_valid_emergency = false;
};

/// Whether `value` may be written to `entry`, which holds a COB-ID of `kind`: its bits and CAN-ID
/// (06090030h), and whether it may change now (08000022h): a CAN-ID changes only while its object
/// does not exist, or ceases to.
[[nodiscard]] dictionary::Verdict check_cob_id(const dictionary::Entry& entry, CobIdKind kind,
                                               std::uint64_t value, const CobIdRules& limits);

/// The entry of another communication object that exists and uses `can_id`; null if there is none.
[[nodiscard]] const dictionary::Entry* user_of_can_id(const dictionary::Dictionary& dictionary,
                                                      std::uint16_t can_id,
                                                      const dictionary::Entry& except);

// Arguments: {0} index, {1} subindex, {2} name, {3} the value that came, then what the rule adds.
namespace rules {
inline constexpr base::EventRule kCobIdExtendedFrame{
    "cob-id-extended", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3:x8} asks for a CAN-ID of 29 bits, the device knows "
    "11-bit CAN-IDs; bits 11 to 29 must be 0"};
inline constexpr base::EventRule kCobIdRestricted{
    "cob-id-restricted", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3:x8} uses CAN-ID {4:x3}, which CiA 301 restricts to "
    "NMT, SDO, error control and LSS; choose another one"};
inline constexpr base::EventRule kCobIdProduced{"cob-id-produce", base::Severity::refusal,
                                                "write to {0:x4}:{1:x2} \"{2}\" refused: {3:x8} "
                                                "has bit 30 set, but the device does not produce "
                                                "this message; clear the bit"};
inline constexpr base::EventRule kCobIdBit30{
    "cob-id-bit-30", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3:x8} has bit 30 cleared, but the device answers no "
    "remote frames for PDOs; set the bit"};
inline constexpr base::EventRule kCobIdReserved{
    "cob-id-reserved", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3:x8} has reserved bit 30 set; clear it"};
inline constexpr base::EventRule kCobIdInUse{
    "cob-id-in-use", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3:x8} changes the CAN-ID of an object that exists "
    "with {4:x8}; switch it off first (PDO and EMCY: set bit 31, SYNC and TIME: clear bit 30)"};
inline constexpr base::EventRule kCobIdShared{"cob-id-shared", base::Severity::refusal,
                                              "write to {0:x4}:{1:x2} \"{2}\" refused: CAN-ID "
                                              "{3:x3} is used by {4:x4}:{5:x2} of this device; "
                                              "choose another one"};
}  // namespace rules

}  // namespace stator::canopen
