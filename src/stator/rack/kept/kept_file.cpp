#include "stator/rack/kept/kept_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/base/crc32.hpp"
#include "stator/rack/kept/kept_file_reading.hpp"

namespace stator::rack {

namespace {

constexpr std::string_view kMagic = "stator 1 ";
constexpr std::size_t kLongestHeader = 200;

constexpr std::string_view kRecordMagic = "Srec";
constexpr std::size_t kRecordHeader = 32;
constexpr std::byte kRecordEnd{'\n'};

/// Places of the numbers in a record.
constexpr std::size_t kNumber = 4;
constexpr std::size_t kBase = 8;
constexpr std::size_t kSize = 12;
constexpr std::size_t kOffset = 16;
constexpr std::size_t kCount = 20;
constexpr std::size_t kDataCheck = 24;
constexpr std::size_t kCheck = 28;
/// What is known of a record before it is read: magic, number and base.
constexpr std::size_t kForetold = 12;

using Bytes = std::span<const std::byte>;

/// The text up to the next space, which is taken off `line` with it.
std::string_view next_word(std::string_view& line) {
  const std::size_t end = std::min(line.find(' '), line.size());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  return word;
}

template <typename T>
std::optional<T> number(std::string_view word, int base) {
  T value{};
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value, base);
  return error == std::errc() && rest == end ? std::optional(value) : std::nullopt;
}

/// A record's header as far as it follows from where the records end.
std::array<std::byte, kRecordHeader> begin_record(const LogEnd& end) {
  std::array<std::byte, kRecordHeader> header{};
  std::ranges::copy(std::as_bytes(std::span(kRecordMagic)), header.begin());
  base::store_le(header.data() + kNumber, end.changes + 1);
  base::store_le(header.data() + kBase, end.check);
  return header;
}

using Damage = base::Unexpected<std::string>;

Damage damaged_record(const LogEnd& end, std::string_view reason) {
  return {fmt::format("it is damaged: change {} of its content, at byte {}, {}", end.changes + 1,
                      end.length, reason)};
}

/// `bytes` without zeros at their end.
Bytes without_end_of_zeros(Bytes bytes) {
  const auto last = std::find_if(bytes.rbegin(), bytes.rend(),
                                 [](std::byte byte) { return byte != std::byte{}; });
  return bytes.first(bytes.size() - static_cast<std::size_t>(last - bytes.rbegin()));
}

/// Makes the change that `log` begins with and returns its length. 0: the file ended while it was
/// written; then its end is missing, or was never filled and is zeros.
base::Expected<std::size_t, std::string> apply_record(Bytes log, std::vector<std::byte>& content,
                                                      LogEnd& end) {
  const Bytes filled = without_end_of_zeros(log);
  const auto foretold = begin_record(end);
  const std::size_t comparable = std::min(filled.size(), kForetold);
  if (!std::ranges::equal(filled.first(comparable), Bytes(foretold).first(comparable))) {
    return damaged_record(end, "is no record that goes on from what is before it");
  }
  if (filled.size() < kRecordHeader) {
    return 0;
  }
  const auto field = [log](std::size_t place) {
    return base::load_le<std::uint32_t>(log.data() + place);
  };
  if (base::crc32(log.first(kCheck)) != field(kCheck)) {
    return damaged_record(end, "has a header that does not agree with its checksum");
  }
  const std::size_t size = field(kSize);
  const std::size_t offset = field(kOffset);
  const std::size_t count = field(kCount);
  const bool grows = size > content.size();
  if (size > kLargestContent || offset + count > size ||
      (grows && (offset > content.size() || offset + count != size))) {
    return damaged_record(end, fmt::format("puts {} bytes at {} of {}, which had {}", count, offset,
                                           size, content.size()));
  }
  const std::size_t length = kRecordHeader + count + 1;
  if (filled.size() < length) {
    return 0;
  }
  const Bytes data = log.subspan(kRecordHeader, count);
  if (base::crc32(data) != field(kDataCheck) || log[length - 1] != kRecordEnd) {
    return damaged_record(end, "does not agree with its checksum");
  }
  content.resize(size);
  std::ranges::copy(data, content.begin() + static_cast<std::ptrdiff_t>(offset));
  end = {end.log + length, end.length + length, end.changes + 1, field(kCheck)};
  return length;
}

/// The bytes of `after` that have to be written over `before`, as place and end.
std::pair<std::size_t, std::size_t> difference(Bytes before, Bytes after) {
  const std::size_t common = std::min(before.size(), after.size());
  const auto [first, other] = std::ranges::mismatch(before.first(common), after.first(common));
  const auto begin = static_cast<std::size_t>(std::distance(before.begin(), first));
  std::size_t end = after.size();
  if (after.size() <= before.size()) {
    while (end > begin && before[end - 1] == after[end - 1]) {
      --end;
    }
  }
  return {begin, end};
}

}  // namespace

std::vector<std::byte> encode(std::string_view kind, std::string_view product,
                              std::span<const std::byte> content) {
  const std::string header = fmt::format("{}{} {} {:08X} {}\n", kMagic, kind, content.size(),
                                         base::crc32(content), product);
  std::vector<std::byte> file;
  file.reserve(header.size() + content.size());
  std::ranges::copy(std::as_bytes(std::span(header)), std::back_inserter(file));
  file.insert(file.end(), content.begin(), content.end());
  return file;
}

base::Expected<KeptFile, std::string> read_kept_file(std::span<const std::byte> file, LogEnd& end) {
  const std::string_view text(reinterpret_cast<const char*>(file.data()),
                              std::min(file.size(), kLongestHeader));
  const std::size_t line_end = text.find('\n');
  if (!text.starts_with(kMagic) || line_end == std::string_view::npos) {
    return Damage{
        "it is no file that Stator has kept: its first line does not begin with \"stator 1\""};
  }
  std::string_view line = text.substr(kMagic.size(), line_end - kMagic.size());
  // What is printed of a file is text of one line, whatever is in it.
  if (!std::ranges::all_of(line, [](char c) { return c >= ' ' && c <= '~'; })) {
    return Damage{"it is damaged: its first line has bytes that are no text"};
  }
  KeptFile kept;
  kept.kind = next_word(line);
  const auto length = number<std::size_t>(next_word(line), 10);
  const auto checksum = number<std::uint32_t>(next_word(line), 16);
  kept.product = line;
  const auto rest = file.subspan(line_end + 1);
  if (!length || !checksum) {
    return Damage{"it is damaged: length or checksum in its first line is no number"};
  }
  if (rest.size() < *length) {
    return Damage{fmt::format("it is damaged: its first line promises {} bytes, {} follow", *length,
                              rest.size())};
  }
  const auto content = rest.first(*length);
  if (const std::uint32_t found = base::crc32(content); found != *checksum) {
    return Damage{
        fmt::format("it is damaged: its first line promises CRC-32 {:08X}, its content has {:08X}",
                    *checksum, found)};
  }
  kept.content.assign(content.begin(), content.end());
  const std::size_t base = line_end + 1 + *length;
  end = {0, base, 0, base::crc32(file.first(base))};
  while (end.length < file.size()) {
    const auto applied = apply_record(file.subspan(end.length), kept.content, end);
    if (!applied) {
      return Damage{applied.error()};
    }
    if (*applied == 0) {
      break;
    }
  }
  return kept;
}

KeptFile decode(std::span<const std::byte> file, LogEnd& end) {
  auto kept = read_kept_file(file, end);
  if (!kept) {
    throw std::runtime_error(kept.error());
  }
  return *std::move(kept);
}

KeptFile decode(std::span<const std::byte> file) {
  LogEnd end;
  return decode(file, end);
}

std::vector<std::byte> encode_change(std::span<const std::byte> before,
                                     std::span<const std::byte> after, LogEnd& end) {
  const auto [first, last] = difference(before, after);
  const Bytes data = after.subspan(first, last - first);
  auto header = begin_record(end);
  base::store_le(header.data() + kSize, static_cast<std::uint32_t>(after.size()));
  base::store_le(header.data() + kOffset, static_cast<std::uint32_t>(first));
  base::store_le(header.data() + kCount, static_cast<std::uint32_t>(data.size()));
  base::store_le(header.data() + kDataCheck, base::crc32(data));
  const std::uint32_t check = base::crc32(Bytes(header).first(kCheck));
  base::store_le(header.data() + kCheck, check);
  std::vector<std::byte> record(header.size() + data.size() + 1, kRecordEnd);
  std::ranges::copy(header, record.begin());
  std::ranges::copy(data, record.begin() + kRecordHeader);
  end = {end.log + record.size(), end.length + record.size(), end.changes + 1, check};
  return record;
}

std::string file_name_for(std::string_view device_name) {
  std::string name;
  for (const char c : device_name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       c == '.' || c == '_' || c == '-';
    name += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return name;
}

}  // namespace stator::rack
