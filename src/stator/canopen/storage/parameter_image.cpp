#include "stator/canopen/storage/parameter_image.hpp"

#include <algorithm>
#include <array>

#include "stator/base/byte_order.hpp"
#include "stator/base/crc32.hpp"

namespace stator::canopen {

namespace {

using dictionary::Entry;

constexpr std::uint32_t kMark = 0x41505453;  // "STPA"
constexpr std::uint16_t kVersion = 1;
constexpr std::size_t kHeader = 8;
constexpr std::size_t kCheckSum = 4;
/// Before each value: index, subindex, length.
constexpr std::size_t kValueHeader = 5;

template <typename T>
void append(std::vector<std::byte>& image, T value) {
  const std::size_t at = image.size();
  image.resize(at + sizeof value);
  base::store_le(image.data() + at, value);
}

void append_value(std::vector<std::byte>& image, const Entry& entry) {
  append(image, entry.index());
  append(image, entry.subindex());
  append(image, static_cast<std::uint16_t>(entry.size()));
  if (dictionary::is_string(entry.type())) {
    image.insert(image.end(), entry.bytes().begin(), entry.bytes().end());
    return;
  }
  const std::size_t at = image.size();
  append(image, entry.value());
  image.resize(at + entry.size());
}

/// A number of `bytes.size()` bytes, extended to 64 bits as the type says.
std::uint64_t load_number(dictionary::DataType type, std::span<const std::byte> bytes) {
  std::array<std::byte, 8> wide{};
  const bool negative =
      dictionary::is_signed(type) && (bytes.back() & std::byte{0x80}) != std::byte{0};
  wide.fill(negative ? std::byte{0xFF} : std::byte{0});
  std::ranges::copy(bytes, wide.begin());
  return base::load_le<std::uint64_t>(wide);
}

bool load_value(Entry& entry, std::span<const std::byte> bytes) {
  if (dictionary::is_string(entry.type())) {
    entry.set_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return true;
  }
  if (bytes.size() != entry.size() || bytes.empty()) {
    return false;
  }
  entry.set_value(load_number(entry.type(), bytes));
  return true;
}

bool is_intact(std::span<const std::byte> image) {
  if (image.size() < kHeader + kCheckSum || base::load_le<std::uint32_t>(image) != kMark ||
      base::load_le<std::uint16_t>(image, 4) != kVersion) {
    return false;
  }
  const std::size_t end = image.size() - kCheckSum;
  return base::load_le<std::uint32_t>(image, end) == base::crc32(image.first(end));
}

}  // namespace

bool is_parameter(const Entry& entry, std::span<const ParameterRange> ranges) {
  const bool named = std::ranges::any_of(ranges, [&entry](const ParameterRange& range) {
    return entry.index() >= range.first && entry.index() <= range.last &&
           (range.subindex == ParameterRange::kAllSubindices || range.subindex == entry.subindex());
  });
  return named && entry.declaration().access == dictionary::Access::read_write;
}

void encode_parameters(const dictionary::Dictionary& dictionary,
                       std::span<const ParameterRange> ranges, std::vector<std::byte>& image) {
  image.clear();
  append(image, kMark);
  append(image, kVersion);
  append(image, std::uint16_t{0});
  std::uint16_t count = 0;
  for (const Entry& entry : dictionary.entries()) {
    if (is_parameter(entry, ranges)) {
      append_value(image, entry);
      ++count;
    }
  }
  base::store_le(image.data() + 6, count);
  append(image, base::crc32(image));
}

ImageVerdict load_parameters(dictionary::Dictionary& dictionary,
                             std::span<const ParameterRange> ranges,
                             std::span<const std::byte> image) {
  if (!is_intact(image)) {
    return ImageVerdict::damaged;
  }
  auto rest = image.subspan(kHeader, image.size() - kHeader - kCheckSum);
  bool all_known = true;
  for (auto count = base::load_le<std::uint16_t>(image, 6); count > 0; --count) {
    if (rest.size() < kValueHeader) {
      return ImageVerdict::foreign;
    }
    const auto index = base::load_le<std::uint16_t>(rest);
    const auto subindex = std::to_integer<std::uint8_t>(rest[2]);
    const std::size_t length = base::load_le<std::uint16_t>(rest, 3);
    rest = rest.subspan(kValueHeader);
    if (rest.size() < length) {
      return ImageVerdict::foreign;
    }
    Entry* entry = dictionary.find(index, subindex);
    all_known &=
        entry != nullptr && is_parameter(*entry, ranges) && load_value(*entry, rest.first(length));
    rest = rest.subspan(length);
  }
  return all_known ? ImageVerdict::loaded : ImageVerdict::foreign;
}

}  // namespace stator::canopen
