#include "stator/ethercat/stack/process_image.hpp"

#include <algorithm>
#include <cstring>

#include "stator/base/byte_order.hpp"

namespace stator::ethercat {

namespace {

using dictionary::Entry;
using dictionary::Object;
using dictionary::Refusal;
using dictionary::Verdict;

/// Spare bytes behind the image let every value be moved as one 64-bit word and one byte.
constexpr std::size_t kSpareBytes = 9;

constexpr std::uint64_t mask_of(unsigned bits) {
  return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

/// Reads `length` <= 64 bits at `offset`.
std::uint64_t load_bits(const std::byte* data, std::uint32_t offset, unsigned length) {
  const std::byte* from = data + offset / 8;
  const unsigned shift = offset % 8;
  std::uint64_t value = base::load_le<std::uint64_t>(from) >> shift;
  if (shift + length > 64) {
    value |= std::to_integer<std::uint64_t>(from[8]) << (64 - shift);
  }
  return value & mask_of(length);
}

/// Writes `length` <= 64 bits at `offset`, into bits that are 0. Most objects take whole bytes and
/// the length of a machine word: those are stored without reading their neighbours.
void store_bits(std::byte* data, std::uint32_t offset, unsigned length, std::uint64_t value) {
  if (offset % 8 == 0) {
    switch (length) {
      case 8:
        return base::store_le(data + offset / 8, static_cast<std::uint8_t>(value));
      case 16:
        return base::store_le(data + offset / 8, static_cast<std::uint16_t>(value));
      case 32:
        return base::store_le(data + offset / 8, static_cast<std::uint32_t>(value));
      case 64:
        return base::store_le(data + offset / 8, value);
      default:
        break;
    }
  }
  std::byte* to = data + offset / 8;
  const unsigned shift = offset % 8;
  value &= mask_of(length);
  base::store_le(to, base::load_le<std::uint64_t>(to) | value << shift);
  if (shift + length > 64) {
    to[8] |= static_cast<std::byte>(value >> (64 - shift));
  }
}

}  // namespace

ProcessImage::ProcessImage(PdoDirection direction, std::size_t capacity_bytes)
    : direction_(direction), data_(capacity_bytes + kSpareBytes) {
  // Entries of one bit are the shortest, but no product maps more than a few hundred objects.
  items_.reserve(std::min<std::size_t>(capacity_bytes * 8, 512));
}

void ProcessImage::clear() {
  items_.clear();
  bits_ = 0;
}

Verdict ProcessImage::compile(dictionary::Dictionary& dictionary,
                              const PdoConfiguration& configuration) {
  clear();
  std::ranges::fill(data_, std::byte{0});
  const Object* assignment = dictionary.find(assignment_object(direction_));
  if (assignment == nullptr) {
    return {};
  }
  const std::uint64_t count = assignment->entries.front().value();
  for (const Entry& assigned : assignment->entries.subspan(1)) {
    if (assigned.subindex() > count) {
      break;
    }
    if (Verdict verdict = append_pdo(assigned, dictionary, configuration); !verdict) {
      clear();
      return verdict;
    }
  }
  return {};
}

Verdict ProcessImage::append_pdo(const Entry& assigned, dictionary::Dictionary& dictionary,
                                 const PdoConfiguration& configuration) {
  const Object* pdo = dictionary.find(static_cast<std::uint16_t>(assigned.value()));
  if (pdo == nullptr || pdo_direction(pdo->index) != direction_) {
    return dictionary::refuse(dictionary::AbortCode::value_range_exceeded, rules::kPdoMissing,
                              {int{assigned.index()}, int{assigned.subindex()},
                               assigned.shared_name(), assigned.signed_value(),
                               direction_ == PdoDirection::receive ? base::StaticText("RxPDO")
                                                                   : base::StaticText("TxPDO")});
  }
  const std::uint64_t count = pdo->entries.front().value();
  for (const Entry& source : pdo->entries.subspan(1)) {
    if (source.subindex() > count) {
      break;
    }
    if (Verdict verdict = append_entry(source, dictionary, configuration); !verdict) {
      return verdict;
    }
  }
  return {};
}

Verdict ProcessImage::append_entry(const Entry& source, dictionary::Dictionary& dictionary,
                                   const PdoConfiguration& configuration) {
  const MappingEntry mapping = MappingEntry::decode(source.value());
  const auto mapped = configuration.resolve(source, mapping, direction_);
  if (!mapped) {
    return base::Unexpected<Refusal>{mapped.error()};
  }
  if (*mapped != nullptr) {
    items_.push_back({.entry = dictionary.find(mapping.index, mapping.subindex),
                      .bit_offset = static_cast<std::uint32_t>(bits_),
                      .bit_length = mapping.bits});
  }
  bits_ += mapping.bits;
  const std::size_t limit = data_.size() - kSpareBytes;
  if (bytes() > limit) {
    return dictionary::refuse(
        dictionary::AbortCode::pdo_length_exceeded, rules::kPdoTooLong,
        {int{source.index()}, int{source.subindex()}, source.shared_name(), bytes(), limit});
  }
  return {};
}

std::size_t ProcessImage::unpack(dictionary::Dictionary& dictionary, RefusedHook on_refused) {
  std::size_t refused = 0;
  for (Item& item : items_) {
    const std::uint64_t raw = load_bits(data_.data(), item.bit_offset, item.bit_length);
    if (raw == (item.entry->value() & mask_of(item.bit_length))) {
      item.refused = false;
      continue;
    }
    const Verdict verdict = dictionary.write_from_pdo(*item.entry, raw);
    if (verdict) {
      item.refused = false;
      continue;
    }
    ++refused;
    if (!item.refused && on_refused) {
      on_refused(*item.entry, verdict.error());
    }
    item.refused = true;
  }
  return refused;
}

void ProcessImage::pack(const dictionary::Dictionary& dictionary) {
  std::ranges::fill(data(), std::byte{0});
  for (const Item& item : items_) {
    static_cast<void>(dictionary.prepare_read(*item.entry));
    store_bits(data_.data(), item.bit_offset, item.bit_length, item.entry->value());
  }
}

}  // namespace stator::ethercat
