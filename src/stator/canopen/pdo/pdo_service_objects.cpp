#include <algorithm>

#include "stator/canopen/pdo/pdo_service.hpp"

namespace stator::canopen {

namespace {

using base::EventArgument;
using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::Verdict;

// Subindices of 14xxh and 18xxh (CiA 301 §7.5.2.35, §7.5.2.37).
constexpr std::uint8_t kCobIdSubindex = 1;
constexpr std::uint8_t kTransmissionTypeSubindex = 2;
constexpr std::uint8_t kInhibitTimeSubindex = 3;
constexpr std::uint8_t kSyncStartSubindex = 6;

constexpr std::uint16_t kFirstPdoObject = 0x1400;
constexpr std::uint16_t kEndOfPdoObjects = 0x1C00;

std::array<EventArgument, 6> about(const Entry& entry, EventArgument more = {}) {
  return {int{entry.index()}, int{entry.subindex()}, entry.shared_name(), more};
}

}  // namespace

PdoService::Place PdoService::place_of(std::uint16_t index) {
  const bool transmit = index >= kTransmitPdoCommunication;
  const auto offset = static_cast<std::uint16_t>(
      index - (transmit ? kTransmitPdoCommunication : kReceivePdoCommunication));
  return {.direction = transmit ? PdoDirection::transmit : PdoDirection::receive,
          .mapping = offset >= kMaximumPdos,
          .number = static_cast<std::uint16_t>(offset % kMaximumPdos)};
}

void PdoService::install_hooks(const dictionary::Object& object) {
  if (object.index < kFirstPdoObject || object.index >= kEndOfPdoObjects) {
    return;
  }
  const Place place = place_of(object.index);
  if (mapping_of(place.direction, place.number) == nullptr) {
    return;
  }
  using Check = Entry::CheckHook;
  const Check check = place.mapping ? Check::bind<&PdoService::check_mapping>(*this)
                                    : Check::bind<&PdoService::check_communication>(*this);
  const auto written = Entry::WrittenHook::bind<&PdoService::on_written>(*this);
  for (const Entry& entry : object.entries) {
    dictionary_.on_check(object.index, entry.subindex(), check);
    dictionary_.on_written(object.index, entry.subindex(), written);
  }
}

bool PdoService::is_valid(const Place& place) const {
  const auto first = place.direction == PdoDirection::receive ? kReceivePdoCommunication
                                                              : kTransmitPdoCommunication;
  const Entry* cob_id =
      dictionary_.find(static_cast<std::uint16_t>(first + place.number), kCobIdSubindex);
  return (cob_id->value() & kCobIdInvalid) == 0;
}

Verdict PdoService::check_communication(const Entry& entry, std::uint64_t value) {
  const Place place = place_of(entry.index());
  switch (entry.subindex()) {
    case kCobIdSubindex:
      if (rules_.one_pdo && place.number > 0 && (value & kCobIdInvalid) == 0) {
        return dictionary::refuse(AbortCode::value_range_exceeded, rules::kPdoOne, about(entry));
      }
      return check_cob_id(entry,
                          place.direction == PdoDirection::receive ? CobIdKind::receive_pdo
                                                                   : CobIdKind::transmit_pdo,
                          value, rules_.cob_id);
    case kTransmissionTypeSubindex:
      return check_transmission_type(entry, place.direction, value);
    case kInhibitTimeSubindex:
    case kSyncStartSubindex:
      if (value != entry.value() && is_valid(place)) {
        return dictionary::refuse(AbortCode::device_state, rules::kPdoValid,
                                  about(entry, int{entry.index()}));
      }
      return {};
    default:
      return {};
  }
}

Verdict PdoService::check_transmission_type(const Entry& entry, PdoDirection direction,
                                            std::uint64_t value) const {
  const auto types =
      direction == PdoDirection::receive ? rules_.receive_types : rules_.transmit_types;
  const bool supported = std::ranges::any_of(types, [value](const TransmissionTypes& range) {
    return value >= range.first && value <= range.last;
  });
  if (!supported) {
    return dictionary::refuse(AbortCode::value_range_exceeded, rules::kPdoTransmissionType,
                              about(entry, value));
  }
  return {};
}

Verdict PdoService::check_mapping(const Entry& entry, std::uint64_t value) {
  const Place place = place_of(entry.index());
  if (rules_.fixed_mapping) {
    return dictionary::refuse(AbortCode::read_only, rules::kPdoMappingFixed, about(entry));
  }
  if (!rules_.map_valid_pdos && is_valid(place)) {
    const auto communication = static_cast<std::uint16_t>(entry.index() - kMaximumPdos);
    return dictionary::refuse(rules_.mapping_locked, rules::kPdoValid,
                              about(entry, int{communication}));
  }
  const PdoMapping& mapping = *mapping_of(place.direction, place.number);
  if (entry.subindex() == 0) {
    return mapping.check_count(entry, value);
  }
  const Entry* count = dictionary_.find(entry.index(), 0);
  if (count->value() != 0) {
    return dictionary::refuse(rules_.mapping_locked, rules::kPdoMappingActive,
                              about(entry, count->value()));
  }
  return mapping.check_entry(entry, value);
}

void PdoService::on_written(const Entry& entry) {
  const Place place = place_of(entry.index());
  mark_changed(place.direction, place.number);
}

}  // namespace stator::canopen
