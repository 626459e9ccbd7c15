#include "stator/ethercat/stack/pdo_configuration.hpp"

#include <algorithm>
#include <utility>

namespace stator::ethercat {

namespace {

using base::EventArgument;
using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::Object;
using dictionary::PdoMapping;
using dictionary::Refusal;
using dictionary::Verdict;

/// Indices below this are data types; as a mapped object they are padding (CiA 301 §7.4.7.1), as is
/// index 0 (ETG.1000.6).
constexpr std::uint16_t kFirstRealIndex = 0x0020;

bool mappable(const Entry& entry, PdoDirection direction) {
  const PdoMapping mapping = entry.declaration().mapping;
  return mapping == PdoMapping::both ||
         mapping ==
             (direction == PdoDirection::receive ? PdoMapping::receive : PdoMapping::transmit);
}

base::StaticText pdo_name(PdoDirection direction) {
  return direction == PdoDirection::receive ? base::StaticText("RxPDO") : base::StaticText("TxPDO");
}

std::array<EventArgument, 6> about(const Entry& entry, const EventArgument& a = {},
                                   const EventArgument& b = {}, const EventArgument& c = {}) {
  return {EventArgument(int{entry.index()}),
          EventArgument(int{entry.subindex()}),
          entry.shared_name(),
          a,
          b,
          c};
}

PdoDirection assignment_direction(std::uint16_t index) {
  return index == kOutputAssignment ? PdoDirection::receive : PdoDirection::transmit;
}

bool is_assignment(std::uint16_t index) {
  return index == kOutputAssignment || index == kInputAssignment;
}

/// Length of a PDO with the first `count` entries of `mapping`.
std::size_t mapped_bits(const Object& mapping, std::uint64_t count) {
  std::size_t bits = 0;
  for (const Entry& entry : mapping.entries) {
    if (entry.subindex() >= 1 && entry.subindex() <= count) {
      bits += MappingEntry::decode(entry.value()).bits;
    }
  }
  return bits;
}

}  // namespace

std::optional<PdoDirection> pdo_direction(std::uint16_t index) {
  if (index >= 0x1600 && index < 0x1800) {
    return PdoDirection::receive;
  }
  if (index >= 0x1A00 && index < 0x1C00) {
    return PdoDirection::transmit;
  }
  return std::nullopt;
}

PdoConfiguration::PdoConfiguration(dictionary::Dictionary& dictionary, const PdoLimits& limits,
                                   dictionary::Quirks quirks)
    : dictionary_(dictionary), limits_(limits), quirks_(std::move(quirks)) {
  for (const Object& object : dictionary_.objects()) {
    install(object);
  }
  if (quirks_.one_pdo) {
    assign_one_pdo();
  }
}

/// Reduces the default assignments to one PDO for each direction.
void PdoConfiguration::assign_one_pdo() {
  for (const std::uint16_t assignment : {kOutputAssignment, kInputAssignment}) {
    Entry* count = dictionary_.find(assignment, 0);
    if (count != nullptr && count->value() > 1) {
      dictionary_.set_default(assignment, 0, 1);
      count->set_value(1);
    }
  }
}

void PdoConfiguration::install(const Object& object) {
  using Hook = Entry::CheckHook;
  const auto install_on = [&](Hook count, Hook entry) {
    for (const Entry& target : object.entries) {
      dictionary_.on_check(object.index, target.subindex(), target.subindex() == 0 ? count : entry);
    }
  };
  if (object.index == kSyncManagerTypeObject) {
    const Hook hook = Hook::bind<&PdoConfiguration::check_sync_manager_type>(*this);
    install_on(hook, hook);
  } else if (is_assignment(object.index)) {
    install_on(Hook::bind<&PdoConfiguration::check_assignment_count>(*this),
               Hook::bind<&PdoConfiguration::check_assignment_entry>(*this));
  } else if (pdo_direction(object.index)) {
    install_on(Hook::bind<&PdoConfiguration::check_mapping_count>(*this),
               Hook::bind<&PdoConfiguration::check_mapping_entry>(*this));
  }
}

bool PdoConfiguration::is_configuration(std::uint16_t index) {
  return is_assignment(index) || pdo_direction(index).has_value();
}

AbortCode PdoConfiguration::refine(const Entry& entry, AbortCode code) {
  if (code != AbortCode::value_too_high || entry.subindex() != 0) {
    return code;
  }
  if (is_assignment(entry.index())) {
    return AbortCode::value_range_exceeded;
  }
  return pdo_direction(entry.index()) ? AbortCode::pdo_length_exceeded : code;
}

base::Expected<const Entry*, Refusal> PdoConfiguration::resolve(const Entry& source,
                                                                MappingEntry mapping,
                                                                PdoDirection direction) const {
  const EventArgument index(int{mapping.index});
  const EventArgument subindex(int{mapping.subindex});
  if (mapping.index < kFirstRealIndex) {
    const auto type = static_cast<dictionary::DataType>(mapping.index);
    const std::size_t bits = dictionary::bit_length(type);
    if (mapping.index != 0 && bits != mapping.bits) {
      return dictionary::refuse(AbortCode::length_mismatch, rules::kPdoEntryLength,
                                about(source, index, int{mapping.bits}, bits));
    }
    if (mapping.index == 0 && mapping.bits == 0) {
      return dictionary::refuse(AbortCode::object_does_not_exist, rules::kPdoObjectMissing,
                                about(source, index, subindex));
    }
    return nullptr;
  }
  const Object* object = dictionary_.find(mapping.index);
  const Entry* entry = object == nullptr ? nullptr : object->find(mapping.subindex);
  if (entry == nullptr) {
    return dictionary::refuse(
        object == nullptr ? AbortCode::object_does_not_exist : AbortCode::subindex_does_not_exist,
        rules::kPdoObjectMissing, about(source, index, subindex));
  }
  if (!mappable(*entry, direction) || dictionary::is_string(entry->type())) {
    return dictionary::refuse(AbortCode::not_mappable, rules::kPdoNotMappable,
                              about(source, index, subindex, pdo_name(direction)));
  }
  if (entry->bits() != mapping.bits) {
    return dictionary::refuse(AbortCode::length_mismatch, rules::kPdoEntryLength,
                              about(source, index, int{mapping.bits}, entry->bits()));
  }
  return entry;
}

Verdict PdoConfiguration::check_sync_manager_type(const Entry& entry, std::uint64_t value) {
  if (value == entry.value()) {
    return {};
  }
  return dictionary::refuse(AbortCode::read_only, rules::kPdoFixed,
                            about(entry, entry.signed_value()));
}

Verdict PdoConfiguration::check_changeable(const Entry& entry) const {
  if (!changes_allowed_) {
    return dictionary::refuse(AbortCode::device_state, rules::kPdoState, about(entry));
  }
  if (entry.subindex() != 0) {
    const Entry* count = dictionary_.find(entry.index(), 0);
    if (count->value() != 0) {
      return dictionary::refuse(AbortCode::subindex_zero_must_be_zero, rules::kPdoActive,
                                about(entry, count->signed_value()));
    }
  }
  return {};
}

Verdict PdoConfiguration::check_mapping_entry(const Entry& entry, std::uint64_t value) {
  if (quirks_.fixed_mapping) {
    return dictionary::refuse(AbortCode::read_only, rules::kPdoMappingFixed, about(entry));
  }
  if (Verdict verdict = check_changeable(entry); !verdict) {
    return verdict;
  }
  if (value == 0) {
    return {};  // erases the entry; it cannot be activated
  }
  const auto mapped = resolve(entry, MappingEntry::decode(value), *pdo_direction(entry.index()));
  return mapped ? Verdict{} : Verdict(base::Unexpected<Refusal>{mapped.error()});
}

Verdict PdoConfiguration::check_mapping_count(const Entry& entry, std::uint64_t count) {
  if (quirks_.fixed_mapping) {
    return dictionary::refuse(AbortCode::read_only, rules::kPdoMappingFixed, about(entry));
  }
  if (Verdict verdict = check_changeable(entry); !verdict) {
    return verdict;
  }
  const Object& object = *dictionary_.find(entry.index());
  const PdoDirection direction = *pdo_direction(entry.index());
  if (count > object.max_subindex()) {
    return dictionary::refuse(
        AbortCode::pdo_length_exceeded, dictionary::rules::kTooHigh,
        about(entry, static_cast<std::int64_t>(count), int{object.max_subindex()}));
  }
  for (unsigned subindex = 1; subindex <= count; ++subindex) {
    const Entry* mapping = object.find(static_cast<std::uint8_t>(subindex));
    if (mapping == nullptr) {
      return dictionary::refuse(AbortCode::subindex_does_not_exist,
                                dictionary::rules::kSubindexMissing,
                                about(entry, int{object.max_subindex()}));
    }
    const auto mapped = resolve(entry, MappingEntry::decode(mapping->value()), direction);
    if (!mapped) {
      return base::Unexpected<Refusal>{mapped.error()};
    }
  }
  return check_length(entry, mapped_bits(object, count), direction);
}

Verdict PdoConfiguration::check_assignment_entry(const Entry& entry, std::uint64_t value) {
  if (Verdict verdict = check_changeable(entry); !verdict) {
    return verdict;
  }
  const PdoDirection direction = assignment_direction(entry.index());
  const auto index = static_cast<std::uint16_t>(value);
  if (index == 0 || (pdo_direction(index) == direction && dictionary_.find(index) != nullptr)) {
    return {};
  }
  return dictionary::refuse(AbortCode::value_range_exceeded, rules::kPdoMissing,
                            about(entry, int{index}, pdo_name(direction)));
}

Verdict PdoConfiguration::check_assignment_count(const Entry& entry, std::uint64_t count) {
  if (Verdict verdict = check_changeable(entry); !verdict) {
    return verdict;
  }
  const Object& object = *dictionary_.find(entry.index());
  const PdoDirection direction = assignment_direction(entry.index());
  if (quirks_.one_pdo && count > 1) {
    return dictionary::refuse(AbortCode::pdo_length_exceeded, rules::kPdoOne,
                              about(entry, static_cast<std::int64_t>(count)));
  }
  if (count > object.max_subindex()) {
    return dictionary::refuse(
        AbortCode::value_range_exceeded, dictionary::rules::kTooHigh,
        about(entry, static_cast<std::int64_t>(count), int{object.max_subindex()}));
  }
  std::size_t bits = 0;
  for (unsigned subindex = 1; subindex <= count; ++subindex) {
    const Entry* assigned = object.find(static_cast<std::uint8_t>(subindex));
    const auto index = static_cast<std::uint16_t>(assigned == nullptr ? 0 : assigned->value());
    const Object* mapping = dictionary_.find(index);
    if (mapping == nullptr || pdo_direction(index) != direction) {
      return dictionary::refuse(AbortCode::value_range_exceeded, rules::kPdoMissing,
                                about(entry, int{index}, pdo_name(direction)));
    }
    bits += mapped_bits(*mapping, mapping->entries.front().value());
  }
  return check_length(entry, bits, direction);
}

Verdict PdoConfiguration::check_length(const Entry& entry, std::size_t bits,
                                       PdoDirection direction) const {
  const std::size_t bytes = (bits + 7) / 8;
  const std::size_t limit =
      direction == PdoDirection::receive ? limits_.receive_bytes : limits_.transmit_bytes;
  if (bytes > limit) {
    return dictionary::refuse(AbortCode::pdo_length_exceeded, rules::kPdoTooLong,
                              about(entry, bytes, limit));
  }
  return {};
}

}  // namespace stator::ethercat
