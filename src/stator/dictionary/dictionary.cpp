#include "stator/dictionary/dictionary.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "stator/base/byte_order.hpp"

namespace stator::dictionary {

namespace {

using base::EventArgument;

std::string address_text(std::uint16_t index, std::uint8_t subindex) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (int shift = 12; shift >= 0; shift -= 4) {
    text += kDigits[(index >> shift) & 0xF];
  }
  text += "h:";
  text += kDigits[subindex >> 4];
  text += kDigits[subindex & 0xF];
  return text;
}

[[noreturn]] void reject_declaration(std::uint16_t index, std::uint8_t subindex,
                                     std::string_view reason) {
  throw std::logic_error("dictionary entry " + address_text(index, subindex) + ": " +
                         std::string(reason));
}

/// Extends `bits` of the type's length to 64 bits, by sign or by zero.
std::uint64_t extend(DataType type, std::uint64_t bits) {
  const std::size_t length = bit_length(type);
  if (length == 0 || length == 64) {
    return bits;
  }
  const std::uint64_t mask = (std::uint64_t{1} << length) - 1;
  bits &= mask;
  if (is_signed(type) && (bits >> (length - 1)) != 0) {
    bits |= ~mask;
  }
  return bits;
}

bool below(DataType type, std::uint64_t a, std::uint64_t b) {
  return is_signed(type) ? static_cast<std::int64_t>(a) < static_cast<std::int64_t>(b) : a < b;
}

/// Throws if the default or the range of a number is no value of its type.
void check_declaration(const Entry& entry) {
  if (is_string(entry.type())) {
    return;
  }
  const auto check_value = [&entry](Number number, std::string_view what) {
    if (extend(entry.type(), number.bits) != number.bits) {
      reject_declaration(
          entry.index(), entry.subindex(),
          std::string(what) + " is no value of its type " + std::string(to_text(entry.type())));
    }
  };
  const EntryDeclaration& declaration = entry.declaration();
  check_value(declaration.default_value.number, "default");
  if (const std::optional<Range>& range = declaration.range) {
    check_value(range->minimum, "minimum");
    check_value(range->maximum, "maximum");
    if (below(entry.type(), range->maximum.bits, range->minimum.bits)) {
      reject_declaration(entry.index(), entry.subindex(), "maximum is below minimum");
    }
  }
}

base::StaticText write_states_text(std::uint8_t states) {
  // By the bits of NetworkState: 1 Pre-Operational, 2 Safe-Operational, 4 Operational.
  constexpr std::array<base::StaticText, kAllNetworkStates + 1> kTexts{
      "no state",
      "Pre-Operational",
      "Safe-Operational",
      "Pre-Operational and Safe-Operational",
      "Operational",
      "Pre-Operational and Operational",
      "Safe-Operational and Operational",
      "every state"};
  return kTexts[states & kAllNetworkStates];
}

base::StaticText network_state_text(NetworkState state) {
  switch (state) {
    case NetworkState::pre_operational:
      return "Pre-Operational";
    case NetworkState::safe_operational:
      return "Safe-Operational";
    case NetworkState::operational:
      return "Operational";
  }
  return "?";
}

/// {0} index, {1} subindex, {2} name, then what the rule adds.
std::array<EventArgument, 6> about(const Entry& entry, const EventArgument& third = {},
                                   const EventArgument& fourth = {}) {
  return {EventArgument(int{entry.index()}), EventArgument(int{entry.subindex()}),
          entry.shared_name(), third, fourth};
}

}  // namespace

const Entry* Object::find(std::uint8_t subindex) const {
  const auto found = std::lower_bound(
      entries.begin(), entries.end(), subindex,
      [](const Entry& entry, std::uint8_t wanted) { return entry.subindex() < wanted; });
  return found != entries.end() && found->subindex() == subindex ? &*found : nullptr;
}

void Dictionary::add(std::span<const EntryDeclaration> declarations, const Placement& placement) {
  if (!values_.empty()) {
    throw std::logic_error("dictionary: entries added after finish()");
  }
  for (const EntryDeclaration& declaration : declarations) {
    Entry entry;
    entry.declaration_ = &declaration;
    entry.index_ = static_cast<std::uint16_t>(declaration.index + placement.index_offset);
    entry.axis_ = placement.axis;
    entry.name_ =
        base::SharedText(std::string(placement.name_prefix) + std::string(declaration.name));
    entries_.push_back(std::move(entry));
  }
}

void Dictionary::finish() {
  std::ranges::stable_sort(entries_, [](const Entry& a, const Entry& b) {
    return a.index() != b.index() ? a.index() < b.index() : a.subindex() < b.subindex();
  });
  for (const Entry& entry : entries_) {
    check_declaration(entry);
  }
  link_values();
  link_objects();
  reset_values();
}

void Dictionary::link_values() {
  values_.assign(entries_.size(), 0);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Entry& entry = entries_[i];
    entry.value_ = &values_[i];
    entry.default_ = entry.declaration().default_value.number.bits;
    if (i > 0 && entries_[i - 1].index() == entry.index() &&
        entries_[i - 1].subindex() == entry.subindex()) {
      reject_declaration(entry.index(), entry.subindex(), "declared twice");
    }
  }
}

void Dictionary::link_objects() {
  objects_.clear();
  for (std::size_t first = 0; first < entries_.size();) {
    std::size_t last = first + 1;
    while (last < entries_.size() && entries_[last].index() == entries_[first].index()) {
      ++last;
    }
    const Entry& head = entries_[first];
    if (head.subindex() != 0) {
      reject_declaration(head.index(), head.subindex(), "subindex 0 is missing");
    }
    Object object;
    object.index = head.index();
    object.code = head.declaration().object_code;
    object.axis = head.axis();
    const std::string_view own_name = head.declaration().object_name;
    if (own_name.empty()) {
      object.name = head.shared_name();
    } else {
      const std::string_view prefix(head.name().data(),
                                    head.name().size() - head.declaration().name.size());
      object.name = base::SharedText(std::string(prefix) + std::string(own_name));
    }
    object.entries = std::span(entries_).subspan(first, last - first);
    objects_.push_back(std::move(object));
    first = last;
  }
}

void Dictionary::reset_values() {
  reset_values(0x0000, 0xFFFF);
}

void Dictionary::reset_values(std::uint16_t first, std::uint16_t last) {
  for (Entry& entry : entries_) {
    if (entry.index() < first || entry.index() > last) {
      continue;
    }
    entry.set_value(entry.default_bits());
    if (is_string(entry.type())) {
      entry.set_text(entry.declaration().default_value.text);
    }
  }
}

void Dictionary::set_default(std::uint16_t index, std::uint8_t subindex, std::uint64_t bits) {
  Entry& entry = existing(index, subindex);
  if (extend(entry.type(), bits) != bits) {
    reject_declaration(index, subindex, "new default is no value of its type");
  }
  entry.default_ = bits;
}

void Dictionary::set_node_id(std::uint8_t node_id) {
  for (Entry& entry : entries_) {
    if (entry.declaration().node_id_relative) {
      entry.default_ = entry.declaration().default_value.number.bits + node_id;
    }
  }
}

const Object* Dictionary::find(std::uint16_t index) const {
  const auto found = std::ranges::lower_bound(objects_, index, {}, &Object::index);
  return found != objects_.end() && found->index == index ? &*found : nullptr;
}

std::span<Entry> Dictionary::entries_of(const Object& object) {
  return std::span(entries_).subspan(position(object.entries.front()), object.entries.size());
}

const Entry* Dictionary::find(std::uint16_t index, std::uint8_t subindex) const {
  const Object* object = find(index);
  return object == nullptr ? nullptr : object->find(subindex);
}

Entry* Dictionary::find(std::uint16_t index, std::uint8_t subindex) {
  const Entry* entry = std::as_const(*this).find(index, subindex);
  return entry == nullptr ? nullptr : &own(*entry);
}

base::Expected<const Entry*, Refusal> Dictionary::require(std::uint16_t index,
                                                          std::uint8_t subindex) const {
  const Object* object = find(index);
  if (object == nullptr) {
    return refuse(AbortCode::object_does_not_exist, rules::kObjectMissing,
                  {EventArgument(int{index}), EventArgument(int{subindex})});
  }
  const Entry* entry = object->find(subindex);
  if (entry == nullptr) {
    return refuse(AbortCode::subindex_does_not_exist, rules::kSubindexMissing,
                  {EventArgument(int{index}), EventArgument(int{subindex}),
                   EventArgument(int{object->max_subindex()})});
  }
  return entry;
}

base::Expected<Entry*, Refusal> Dictionary::require(std::uint16_t index, std::uint8_t subindex) {
  const auto entry = std::as_const(*this).require(index, subindex);
  if (!entry) {
    return base::Unexpected<Refusal>{entry.error()};
  }
  return &own(**entry);
}

const Entry& Dictionary::existing(std::uint16_t index, std::uint8_t subindex) const {
  const Entry* entry = find(index, subindex);
  if (entry == nullptr) {
    reject_declaration(index, subindex, "does not exist");
  }
  return *entry;
}

Entry& Dictionary::existing(std::uint16_t index, std::uint8_t subindex) {
  return own(std::as_const(*this).existing(index, subindex));
}

const Entry& Dictionary::existing(std::uint16_t index, std::uint8_t subindex, std::size_t size,
                                  bool wants_signed) const {
  const Entry& entry = existing(index, subindex);
  if (byte_length(entry.type()) != size || is_signed(entry.type()) != wants_signed) {
    reject_declaration(index, subindex,
                       "is " + std::string(to_text(entry.type())) + ", not what the code takes");
  }
  return entry;
}

void Dictionary::on_check(std::uint16_t index, std::uint8_t subindex, Entry::CheckHook hook) {
  existing(index, subindex).check_ = hook;
}

void Dictionary::on_written(std::uint16_t index, std::uint8_t subindex, Entry::WrittenHook hook) {
  existing(index, subindex).written_ = hook;
}

void Dictionary::on_read(std::uint16_t index, std::uint8_t subindex, Entry::ReadHook hook) {
  existing(index, subindex).read_ = hook;
}

void Dictionary::on_read_check(std::uint16_t index, std::uint8_t subindex,
                               Entry::ReadCheckHook hook) {
  existing(index, subindex).read_check_ = hook;
}

Verdict Dictionary::prepare_read(const Entry& entry) const {
  if (!entry.readable()) {
    return refuse(AbortCode::write_only, rules::kWriteOnly, about(entry));
  }
  if (entry.read_) {
    entry.read_(own(entry));
  }
  return entry.read_check_ ? entry.read_check_(entry) : Verdict{};
}

Verdict Dictionary::read(const Entry& entry, std::span<std::byte> out) const {
  if (Verdict verdict = prepare_read(entry); !verdict) {
    return verdict;
  }
  if (is_string(entry.type())) {
    std::ranges::copy(std::as_bytes(std::span(entry.text())), out.begin());
    return {};
  }
  std::array<std::byte, 8> bytes{};
  base::store_le(bytes, 0, entry.value());
  std::copy_n(bytes.begin(), entry.size(), out.begin());
  return {};
}

Verdict Dictionary::check_value(const Entry& entry, std::uint64_t bits) const {
  const EntryDeclaration& declaration = entry.declaration();
  const EventArgument came(static_cast<std::int64_t>(bits));
  if (!declaration.legal_values.empty()) {
    if (std::ranges::find(declaration.legal_values, static_cast<std::int64_t>(bits)) ==
        declaration.legal_values.end()) {
      return refuse(AbortCode::value_range_exceeded, rules::kIllegalValue,
                    about(entry, came, EventArgument(declaration.legal_values)));
    }
  } else if (declaration.range) {
    const Range& range = *declaration.range;
    if (below(entry.type(), range.maximum.bits, bits)) {
      return refuse(AbortCode::value_too_high, rules::kTooHigh,
                    about(entry, came, EventArgument(range.maximum.as_signed())));
    }
    if (below(entry.type(), bits, range.minimum.bits)) {
      return refuse(AbortCode::value_too_low, rules::kTooLow,
                    about(entry, came, EventArgument(range.minimum.as_signed())));
    }
  }
  if (declaration.drive_condition == DriveCondition::switch_on_disabled && drive_state_) {
    if (const base::StaticText state = drive_state_(entry.axis()); !state.empty()) {
      return refuse(AbortCode::device_state, rules::kDriveState,
                    about(entry, EventArgument(state)));
    }
  }
  return entry.check_ ? entry.check_(entry, bits) : Verdict{};
}

Verdict Dictionary::prepare_write(const Entry& entry, std::optional<std::size_t> size,
                                  const AccessContext& context) const {
  const EntryDeclaration& declaration = entry.declaration();
  if (!entry.writable()) {
    return refuse(AbortCode::read_only, rules::kReadOnly, about(entry));
  }
  if ((declaration.write_states & static_cast<std::uint8_t>(context.network_state)) == 0) {
    return refuse(AbortCode::device_state, rules::kNetworkState,
                  about(entry, EventArgument(network_state_text(context.network_state)),
                        EventArgument(write_states_text(declaration.write_states))));
  }
  if (size && !is_string(entry.type()) && *size != entry.size()) {
    return refuse(*size > entry.size() ? AbortCode::length_too_high : AbortCode::length_too_low,
                  rules::kLength, about(entry, EventArgument(*size), EventArgument(entry.size())));
  }
  return {};
}

Verdict Dictionary::write(Entry& entry, std::span<const std::byte> data,
                          const AccessContext& context) {
  if (Verdict verdict = prepare_write(entry, data.size(), context); !verdict) {
    return verdict;
  }
  if (is_string(entry.type())) {
    entry.set_text({reinterpret_cast<const char*>(data.data()), data.size()});
  } else {
    std::array<std::byte, 8> bytes{};
    std::ranges::copy(data, bytes.begin());
    const auto raw = base::load_le<std::uint64_t>(bytes);
    if (entry.type() == DataType::boolean && raw > 1) {
      return refuse(AbortCode::value_too_high, rules::kTooHigh,
                    about(entry, EventArgument(static_cast<std::int64_t>(raw)), EventArgument(1)));
    }
    const std::uint64_t bits = extend(entry.type(), raw);
    if (Verdict verdict = check_value(entry, bits); !verdict) {
      return verdict;
    }
    entry.set_value(bits);
  }
  if (entry.written_) {
    entry.written_(entry);
  }
  return {};
}

Verdict Dictionary::write_from_pdo(Entry& entry, std::uint64_t raw) {
  const std::uint64_t bits = extend(entry.type(), raw);
  if (bits == entry.value()) {
    return {};
  }
  if (Verdict verdict = check_value(entry, bits); !verdict) {
    return verdict;
  }
  entry.set_value(bits);
  if (entry.written_) {
    entry.written_(entry);
  }
  return {};
}

}  // namespace stator::dictionary
