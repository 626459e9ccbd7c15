#include "stator/canopen/cob_id.hpp"

#include <algorithm>

namespace stator::canopen {

namespace {

using base::EventArgument;
using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::Verdict;

/// Bits that make up the CAN-ID and its length.
constexpr std::uint64_t kIdentifierBits = 0x3FFFFFFF;

/// Whether an object of `kind` with this value sends or takes messages whose CAN-ID is fixed by it.
bool exists(CobIdKind kind, std::uint64_t value) {
  switch (kind) {
    case CobIdKind::sync:
      return (value & kCobIdProduce) != 0;
    case CobIdKind::time:
      return (value & (kCobIdProduce | kCobIdInvalid)) != 0;  // bit 31 of 1012h: consumer
    case CobIdKind::emergency:
    case CobIdKind::receive_pdo:
    case CobIdKind::transmit_pdo:
      return (value & kCobIdInvalid) == 0;
  }
  return false;
}

/// The rule that bit 30 of `value` breaks; null if it breaks none.
const base::EventRule* broken_bit_30_rule(CobIdKind kind, std::uint64_t value,
                                          const CobIdRules& limits) {
  const bool set = (value & kCobIdNoRemote) != 0;
  switch (kind) {
    case CobIdKind::sync:
      return set && !limits.produce_sync ? &rules::kCobIdProduced : nullptr;
    case CobIdKind::time:
      return set && !limits.produce_time ? &rules::kCobIdProduced : nullptr;
    case CobIdKind::emergency:
      return set ? &rules::kCobIdReserved : nullptr;
    case CobIdKind::receive_pdo:
      return !set && limits.receive_pdo_bit_30_set ? &rules::kCobIdBit30 : nullptr;
    case CobIdKind::transmit_pdo:
      return !set && !limits.remote_requests ? &rules::kCobIdBit30 : nullptr;
  }
  return nullptr;
}

/// An object that does not exist may name no CAN-ID at all.
bool restricted_for(CobIdKind kind, std::uint64_t value) {
  const std::uint16_t can_id = can_id_of(value);
  const bool unused = can_id == 0 && (value & kCobIdInvalid) != 0 && kind != CobIdKind::sync &&
                      kind != CobIdKind::time;
  return !unused && is_restricted(can_id);
}

}  // namespace

bool is_restricted(std::uint16_t can_id) {
  return std::ranges::any_of(kRestrictedCanIds, [can_id](const CanIdRange& range) {
    return can_id >= range.first && can_id <= range.last;
  });
}

std::optional<CobIdKind> cob_id_kind(std::uint16_t index, std::uint8_t subindex) {
  for (const CobIdObjects& objects : kCobIdObjects) {
    if (index >= objects.first && index <= objects.last && subindex == objects.subindex) {
      return objects.kind;
    }
  }
  return std::nullopt;
}

Verdict check_cob_id(const Entry& entry, CobIdKind kind, std::uint64_t value,
                     const CobIdRules& limits) {
  const auto refuse = [&](AbortCode code, const base::EventRule& rule,
                          const EventArgument& more = {}) {
    return dictionary::refuse(
        code, rule, {int{entry.index()}, int{entry.subindex()}, entry.shared_name(), value, more});
  };
  if ((value & kIdentifierBits & ~std::uint64_t{kCanIdMask}) != 0) {
    return refuse(AbortCode::value_range_exceeded, rules::kCobIdExtendedFrame);
  }
  if (const base::EventRule* broken = broken_bit_30_rule(kind, value, limits); broken != nullptr) {
    return refuse(AbortCode::value_range_exceeded, *broken);
  }
  if (restricted_for(kind, value)) {
    return refuse(AbortCode::value_range_exceeded, rules::kCobIdRestricted, int{can_id_of(value)});
  }
  const bool changes = ((entry.value() ^ value) & kIdentifierBits) != 0;
  const bool may_change = kind == CobIdKind::emergency && limits.change_valid_emergency;
  if (changes && !may_change && exists(kind, entry.value()) && exists(kind, value)) {
    return refuse(AbortCode::device_state, rules::kCobIdInUse, entry.value());
  }
  return {};
}

const Entry* user_of_can_id(const dictionary::Dictionary& dictionary, std::uint16_t can_id,
                            const Entry& except) {
  for (const Entry& entry : dictionary.entries()) {
    const auto kind = cob_id_kind(entry.index(), entry.subindex());
    if (!kind || &entry == &except || can_id_of(entry.value()) != can_id) {
      continue;
    }
    if (*kind == CobIdKind::sync || exists(*kind, entry.value())) {
      return &entry;
    }
  }
  return nullptr;
}

}  // namespace stator::canopen
