#include "stator/canopen/pdo/pdo_mapping.hpp"

#include <algorithm>

namespace stator::canopen {

namespace {

using base::EventArgument;
using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::Refusal;
using dictionary::Verdict;

/// Indices below this are data types; as a mapped object they are gaps (CiA 301 §7.4.7.1).
constexpr std::uint16_t kFirstObject = 0x0020;
constexpr std::uint16_t kLastDummyType = 0x0007;

/// A mapping entry (CiA 301 figure 70): index, subindex, length in bits.
struct MappedObject {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t bits = 0;
};

MappedObject decode(std::uint64_t value) {
  return {static_cast<std::uint16_t>(value >> 16), static_cast<std::uint8_t>(value >> 8),
          static_cast<std::uint8_t>(value)};
}

constexpr std::uint64_t mask_of(unsigned bits) {
  return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

bool mappable(const Entry& entry, PdoDirection direction) {
  const dictionary::PdoMapping mapping = entry.declaration().mapping;
  const auto wanted = direction == PdoDirection::receive ? dictionary::PdoMapping::receive
                                                         : dictionary::PdoMapping::transmit;
  return (mapping == dictionary::PdoMapping::both || mapping == wanted) &&
         !dictionary::is_string(entry.type());
}

std::array<EventArgument, 6> about(const Entry& entry, const EventArgument& a = {},
                                   const EventArgument& b = {}, const EventArgument& c = {}) {
  return {int{entry.index()}, int{entry.subindex()}, entry.shared_name(), a, b, c};
}

base::StaticText direction_text(PdoDirection direction) {
  return direction == PdoDirection::receive ? base::StaticText("receive PDO")
                                            : base::StaticText("transmit PDO");
}

}  // namespace

PdoMapping::PdoMapping(dictionary::Dictionary& dictionary, const dictionary::Object& object,
                       PdoDirection direction, const PdoRules& limits)
    : dictionary_(&dictionary), object_(&object), direction_(direction), rules_(&limits) {
  items_.reserve(std::min<std::size_t>(object.entries.size(), kMaximumPdoBits));
}

base::Expected<Entry*, Refusal> PdoMapping::resolve_gap(const Entry& source,
                                                        std::uint64_t value) const {
  const MappedObject mapped = decode(value);
  const bool is_type = mapped.index >= 1 && mapped.index <= kLastDummyType;
  if (!is_type) {
    return dictionary::refuse(AbortCode::object_does_not_exist, rules::kPdoObjectMissing,
                              about(source, int{mapped.index}, int{mapped.subindex}));
  }
  const bool allowed = (rules_->dummy_usage >> mapped.index & 1U) != 0;
  if (!allowed || direction_ == PdoDirection::transmit || mapped.subindex != 0) {
    return dictionary::refuse(
        AbortCode::not_mappable, rules::kPdoNotMappable,
        about(source, int{mapped.index}, int{mapped.subindex}, direction_text(direction_)));
  }
  const std::size_t bits = dictionary::bit_length(static_cast<dictionary::DataType>(mapped.index));
  if (mapped.bits != bits) {
    return dictionary::refuse(rules_->wrong_entry_length, rules::kPdoEntryLength,
                              about(source, int{mapped.index}, int{mapped.subindex}, bits));
  }
  return nullptr;
}

base::Expected<Entry*, Refusal> PdoMapping::resolve(const Entry& source,
                                                    std::uint64_t value) const {
  const MappedObject mapped = decode(value);
  if (mapped.index < kFirstObject) {
    return resolve_gap(source, value);
  }
  Entry* entry = dictionary_->find(mapped.index, mapped.subindex);
  if (entry == nullptr) {
    return dictionary::refuse(
        dictionary_->find(mapped.index) == nullptr ? AbortCode::object_does_not_exist
                                                   : AbortCode::subindex_does_not_exist,
        rules::kPdoObjectMissing, about(source, int{mapped.index}, int{mapped.subindex}));
  }
  if (!mappable(*entry, direction_)) {
    return dictionary::refuse(
        AbortCode::not_mappable, rules::kPdoNotMappable,
        about(source, int{mapped.index}, int{mapped.subindex}, direction_text(direction_)));
  }
  if (entry->bits() != mapped.bits) {
    return dictionary::refuse(
        rules_->wrong_entry_length, rules::kPdoEntryLength,
        about(source, int{mapped.index}, int{mapped.subindex}, entry->bits()));
  }
  return entry;
}

Verdict PdoMapping::check_entry(const Entry& entry, std::uint64_t value) const {
  if (value == 0) {
    return {};
  }
  const auto resolved = resolve(entry, value);
  return resolved ? Verdict{} : Verdict(base::Unexpected<Refusal>{resolved.error()});
}

Verdict PdoMapping::check_count(const Entry& entry, std::uint64_t count) const {
  const std::size_t room = object_->entries.size() - 1;
  std::uint64_t bits = 0;
  for (std::uint64_t subindex = 1; subindex <= std::min<std::uint64_t>(count, room); ++subindex) {
    const Entry& source = object_->entries[subindex];
    const auto resolved = resolve(source, source.value());
    if (!resolved) {
      return base::Unexpected<Refusal>{resolved.error()};
    }
    bits += decode(source.value()).bits;
  }
  if (count > room || bits > kMaximumPdoBits) {
    return dictionary::refuse(AbortCode::pdo_length_exceeded, rules::kPdoTooLong,
                              about(entry, count, bits, room));
  }
  return {};
}

/// Calls `visit` for each item the mapping object asks for; returns their bits, gaps included.
template <typename Visitor>
unsigned PdoMapping::walk(Visitor visit) const {
  unsigned bits = 0;
  const std::size_t room = object_->entries.size() - 1;
  const std::uint64_t count = std::min<std::uint64_t>(object_->entries.front().value(), room);
  for (std::uint64_t subindex = 1; subindex <= count; ++subindex) {
    const Entry& source = object_->entries[subindex];
    const auto resolved = resolve(source, source.value());
    const std::uint8_t length = decode(source.value()).bits;
    if (!resolved || bits + length > kMaximumPdoBits) {
      break;
    }
    if (*resolved != nullptr) {
      visit(Item{
          .entry = *resolved, .bit_offset = static_cast<std::uint8_t>(bits), .bit_length = length});
    }
    bits += length;
  }
  return bits;
}

void PdoMapping::compile() {
  items_.clear();
  bits_ = walk([this](const Item& item) { items_.push_back(item); });
}

bool PdoMapping::up_to_date() const {
  std::size_t found = 0;
  bool same = true;
  const unsigned bits = walk([&](const Item& item) {
    same = same && found < items_.size() && items_[found].entry == item.entry &&
           items_[found].bit_offset == item.bit_offset &&
           items_[found].bit_length == item.bit_length;
    ++found;
  });
  return same && found == items_.size() && bits == bits_;
}

std::uint64_t PdoMapping::pack() const {
  std::uint64_t data = 0;
  for (const Item& item : items_) {
    static_cast<void>(dictionary_->prepare_read(*item.entry));
    data |= (item.entry->value() & mask_of(item.bit_length)) << item.bit_offset;
  }
  return data;
}

void PdoMapping::unpack(std::uint64_t data, RefusedHook on_refused) {
  for (Item& item : items_) {
    const std::uint64_t raw = data >> item.bit_offset & mask_of(item.bit_length);
    const Verdict verdict = dictionary_->write_from_pdo(*item.entry, raw);
    const bool was_refused = item.refused;
    item.refused = !verdict;
    if (item.refused != was_refused && on_refused) {
      on_refused(item, verdict ? nullptr : &verdict.error(), raw);
    }
  }
}

void PdoMapping::forget_refusals() {
  for (Item& item : items_) {
    item.refused = false;
  }
}

}  // namespace stator::canopen
