#include "stator/ethercat/stack/complete_access.hpp"

#include <algorithm>
#include <array>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/stack/pdo_configuration.hpp"

namespace stator::ethercat {

namespace {

using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::Object;
using dictionary::Refusal;
using dictionary::Verdict;

constexpr std::size_t kCountSize = 2;  ///< subindex 0 as 16 bit

/// Walks the transfer bit by bit: where the next entry lies.
class Cursor {
 public:
  /// Place of an entry of `bits`; single bits share bytes, everything else begins at a byte.
  std::size_t take(std::size_t bits) {
    if (bits % 8 == 0) {
      bit_ = (bit_ + 7) / 8 * 8;
    }
    const std::size_t place = bit_;
    bit_ += bits;
    return place;
  }
  [[nodiscard]] std::size_t bytes() const { return (bit_ + 7) / 8; }

 private:
  std::size_t bit_ = 0;
};

Refusal length_refusal(const Object& object, AbortCode code, std::size_t came,
                       std::size_t expected) {
  return {code, &dictionary::rules::kLength, {int{object.index}, 0, object.name, came, expected}};
}

class CompleteWriter {
 public:
  CompleteWriter(dictionary::Dictionary& dictionary, const Object& object,
                 std::span<const std::byte> data, const dictionary::AccessContext& context)
      : dictionary_(dictionary),
        object_(object),
        entries_(dictionary.entries_of(object)),
        data_(data),
        context_(context) {}

  Verdict write(CompleteAccessStart start) {
    std::span<const std::byte> count;
    if (start == CompleteAccessStart::with_count) {
      if (data_.size() < kCountSize) {
        return too_short(kCountSize);
      }
      count = data_.first(1);
      cursor_.take(kCountSize * 8);
    }
    const bool activate_last = PdoConfiguration::is_configuration(object_.index) && !count.empty();
    if (!count.empty()) {
      const std::array<std::byte, 1> zero{};
      if (Verdict verdict = write_entry(entries_.front(),
                                        activate_last ? std::span<const std::byte>(zero) : count);
          !verdict) {
        return verdict;
      }
    }
    if (Verdict verdict = write_entries(); !verdict) {
      return verdict;
    }
    return activate_last ? write_entry(entries_.front(), count) : Verdict{};
  }

 private:
  Verdict write_entries() {
    for (Entry& entry : entries_.subspan(1)) {
      if (cursor_.bytes() >= data_.size() && (entry.bits() % 8 == 0 || last_bits_used())) {
        return {};
      }
      const std::size_t place = cursor_.take(entry.bits());
      if (cursor_.bytes() > data_.size()) {
        return too_short(cursor_.bytes());
      }
      Verdict verdict;
      if (entry.bits() % 8 == 0) {
        verdict = write_entry(entry, data_.subspan(place / 8, entry.bits() / 8));
      } else {
        const std::array<std::byte, 1> bit{(data_[place / 8] >> (place % 8)) & std::byte{1}};
        verdict = write_entry(entry, bit);
      }
      if (!verdict) {
        return verdict;
      }
    }
    if (cursor_.bytes() < data_.size()) {
      return base::Unexpected<Refusal>{
          length_refusal(object_, AbortCode::length_too_high, data_.size(), cursor_.bytes())};
    }
    return {};
  }

  /// True if the next single bit would begin a new byte.
  [[nodiscard]] bool last_bits_used() const {
    Cursor next = cursor_;
    next.take(1);
    return next.bytes() > cursor_.bytes();
  }

  Verdict write_entry(Entry& entry, std::span<const std::byte> data) {
    return entry.writable() ? dictionary_.write(entry, data, context_) : Verdict{};
  }

  Verdict too_short(std::size_t expected) const {
    return base::Unexpected<Refusal>{
        length_refusal(object_, AbortCode::length_too_low, data_.size(), expected)};
  }

  dictionary::Dictionary& dictionary_;
  const Object& object_;
  std::span<Entry> entries_;
  std::span<const std::byte> data_;
  dictionary::AccessContext context_;
  Cursor cursor_;
};

}  // namespace

base::Expected<std::size_t, Refusal> read_complete(const dictionary::Dictionary& dictionary,
                                                   const Object& object, CompleteAccessStart start,
                                                   std::span<std::byte> out) {
  const auto outgrown = [&] {
    return base::Unexpected<Refusal>{
        Refusal{AbortCode::out_of_memory,
                &dictionary::rules::kLength,
                {int{object.index}, 0, object.name, object.entries.size(), out.size()}}};
  };
  std::ranges::fill(out, std::byte{0});
  Cursor cursor;
  const Entry& count = object.entries.front();
  if (Verdict verdict = dictionary.prepare_read(count); !verdict) {
    return base::Unexpected<Refusal>{verdict.error()};
  }
  if (start == CompleteAccessStart::with_count) {
    const std::size_t place = cursor.take(kCountSize * 8);
    out[place] = static_cast<std::byte>(count.value());
  }
  for (const Entry& entry : object.entries.subspan(1)) {
    if (entry.subindex() > count.value()) {
      break;
    }
    const bool readable = dictionary.prepare_read(entry).has_value();
    const std::size_t place = cursor.take(entry.bits());
    if (cursor.bytes() > out.size()) {
      return outgrown();
    }
    if (!readable) {
      continue;
    }
    if (entry.bits() % 8 != 0) {
      out[place / 8] |= static_cast<std::byte>((entry.value() & 1) << (place % 8));
    } else if (is_string(entry.type())) {
      std::ranges::copy(std::as_bytes(std::span(entry.text())),
                        out.begin() + static_cast<std::ptrdiff_t>(place / 8));
    } else {
      std::array<std::byte, 8> value{};
      base::store_le(value, 0, entry.value());
      std::ranges::copy(std::span(value).first(entry.size()),
                        out.begin() + static_cast<std::ptrdiff_t>(place / 8));
    }
  }
  return cursor.bytes();
}

Verdict write_complete(dictionary::Dictionary& dictionary, const Object& object,
                       CompleteAccessStart start, std::span<const std::byte> data,
                       const dictionary::AccessContext& context) {
  return CompleteWriter(dictionary, object, data, context).write(start);
}

}  // namespace stator::ethercat
