#include "stator/formats/esi/esi_encoding.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace stator::formats {

namespace {

constexpr char32_t kReplacement = 0xFFFD;

std::uint8_t byte_at(std::string_view text, std::size_t at) {
  return static_cast<std::uint8_t>(text[at]);
}

void append(std::string& text, char32_t character) {
  const auto put = [&text](char32_t bits) { text.push_back(static_cast<char>(bits)); };
  if (character < 0x80) {
    put(character);
  } else if (character < 0x800) {
    put(0xC0 | (character >> 6));
    put(0x80 | (character & 0x3F));
  } else if (character < 0x10000) {
    put(0xE0 | (character >> 12));
    put(0x80 | ((character >> 6) & 0x3F));
    put(0x80 | (character & 0x3F));
  } else {
    put(0xF0 | (character >> 18));
    put(0x80 | ((character >> 12) & 0x3F));
    put(0x80 | ((character >> 6) & 0x3F));
    put(0x80 | (character & 0x3F));
  }
}

/// Length of the sequence at `at`, 0 if it is none (RFC 3629).
std::size_t sequence_length(std::string_view text, std::size_t at) {
  const std::uint8_t first = byte_at(text, at);
  if (first < 0x80) {
    return 1;
  }
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() - at < length) {
    return 0;
  }
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte_at(text, at + i) & 0xC0) != 0x80) {
      return 0;
    }
  }
  const std::uint8_t second = byte_at(text, at + 1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool no_character = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);
  return overlong || no_character ? 0 : length;
}

/// Where ASCII ends. Eight bytes at a time, since files are large and nearly all of it.
std::size_t ascii_end(std::string_view text, std::size_t at) {
  constexpr std::uint64_t kHighBits = 0x8080808080808080;
  for (std::uint64_t word = 0; at + sizeof word <= text.size(); at += sizeof word) {
    std::memcpy(&word, text.data() + at, sizeof word);
    if ((word & kHighBits) != 0) {
      break;
    }
  }
  while (at < text.size() && byte_at(text, at) < 0x80) {
    ++at;
  }
  return at;
}

enum class Content { ascii, utf8, other };

Content content_of(std::string_view text) {
  std::size_t at = ascii_end(text, 0);
  if (at == text.size()) {
    return Content::ascii;
  }
  while (at < text.size()) {
    const std::size_t length = sequence_length(text, at);
    if (length == 0) {
      return Content::other;
    }
    at = ascii_end(text, at + length);
  }
  return Content::utf8;
}

/// The encoding that the XML declaration names, letters and digits only; empty if it names none.
std::string declared_encoding(std::string_view text) {
  constexpr std::size_t kLongestDeclaration = 256;
  text = text.substr(0, kLongestDeclaration);
  const std::size_t begin = text.find("<?xml");
  if (begin == std::string_view::npos) {
    return "";
  }
  text = text.substr(begin, text.find("?>", begin) - begin);
  const std::size_t name = text.find("encoding");
  const std::size_t open = name == std::string_view::npos ? name : text.find_first_of("\"'", name);
  if (open == std::string_view::npos) {
    return "";
  }
  std::string_view value = text.substr(open + 1);
  value = value.substr(0, value.find(text[open]));
  std::string plain;
  for (const char c : value) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      plain.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
    }
  }
  return plain;
}

/// Windows-1252 in 80h to 9Fh; Latin-1 has no characters there, so that it serves for both.
constexpr std::array<char16_t, 32> kWindows1252{
    0x20AC, 0xFFFD, 0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
    0x2039, 0x0152, 0xFFFD, 0x017D, 0xFFFD, 0xFFFD, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0xFFFD, 0x017E, 0x0178};

/// Where ISO 8859-15 differs from Latin-1.
char32_t latin_9(std::uint8_t byte) {
  switch (byte) {
    case 0xA4:
      return 0x20AC;
    case 0xA6:
      return 0x0160;
    case 0xA8:
      return 0x0161;
    case 0xB4:
      return 0x017D;
    case 0xB8:
      return 0x017E;
    case 0xBC:
      return 0x0152;
    case 0xBD:
      return 0x0153;
    case 0xBE:
      return 0x0178;
    default:
      return byte;
  }
}

std::string from_latin(std::string_view file, bool latin_9_named) {
  std::string text;
  text.reserve(file.size() + file.size() / 16);
  for (std::size_t at = 0; at < file.size();) {
    const std::size_t end = ascii_end(file, at);
    text += file.substr(at, end - at);
    if (end < file.size()) {
      const std::uint8_t byte = byte_at(file, end);
      append(text, byte < 0xA0     ? char32_t{kWindows1252[byte - 0x80U]}
                   : latin_9_named ? latin_9(byte)
                                   : char32_t{byte});
    }
    at = end + 1;
  }
  return text;
}

std::string from_utf16(std::string_view file, bool big_endian) {
  const auto unit = [file, big_endian](std::size_t at) {
    const std::uint32_t first = byte_at(file, at);
    const std::uint32_t second = byte_at(file, at + 1);
    return big_endian ? first << 8 | second : second << 8 | first;
  };
  std::string text;
  text.reserve(file.size() / 2);
  for (std::size_t at = 0; at + 1 < file.size(); at += 2) {
    char32_t character = unit(at);
    const bool high = character >= 0xD800 && character < 0xDC00;
    if (high && at + 3 < file.size() && unit(at + 2) >= 0xDC00 && unit(at + 2) < 0xE000) {
      at += 2;
      character = 0x10000 + ((character - 0xD800) << 10) + (unit(at) - 0xDC00);
    } else if (character >= 0xD800 && character < 0xE000) {
      character = kReplacement;
    }
    append(text, character);
  }
  return text;
}

bool is_latin(const std::string& encoding) {
  constexpr std::array<std::string_view, 10> kNames{"iso88591",    "iso885915", "latin1", "latin9",
                                                    "windows1252", "cp1252",    "ansi",   "usascii",
                                                    "ascii",       "iso8859"};
  return std::ranges::find(kNames, encoding) != kNames.end();
}

}  // namespace

EsiDecoded decode_esi(std::string_view file) {
  if (file.starts_with("\xFF\xFE") || file.starts_with("\xFE\xFF")) {
    return {.text = from_utf16(file.substr(2), file[0] == '\xFE'), .repaired = {}, .assumed = {}};
  }
  if (file.size() > 1 && (file[0] == '\0') != (file[1] == '\0')) {
    return {.text = from_utf16(file, file[0] == '\0'), .repaired = {}, .assumed = {}};
  }
  if (file.starts_with("\xEF\xBB\xBF")) {
    file.remove_prefix(3);
  }
  EsiDecoded decoded;
  const std::string encoding = declared_encoding(file);
  const bool says_utf8 = encoding.empty() || encoding == "utf8";
  const Content content = content_of(file);
  if (content != Content::other) {
    decoded.text = file;
    if (content == Content::utf8 && !says_utf8) {
      decoded.repaired =
          "the file names another encoding than UTF-8, but its bytes are UTF-8; "
          "they are read as such";
    }
    return decoded;
  }
  decoded.text = from_latin(file, encoding == "iso885915" || encoding == "latin9");
  if (says_utf8) {
    decoded.repaired =
        "the file is said to be UTF-8, but has bytes that are not; it is read as "
        "Windows-1252";
  } else if (!is_latin(encoding)) {
    decoded.assumed = "the file's encoding \"" + encoding +
                      "\" is not known here; it is read as Windows-1252, so that names may look "
                      "odd";
  }
  return decoded;
}

std::string valid_utf8(std::string_view text) {
  std::string valid;
  valid.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = sequence_length(text, at);
    if (length == 0) {
      append(valid, kReplacement);
      ++at;
    } else {
      valid += text.substr(at, length);
      at += length;
    }
  }
  return valid;
}

}  // namespace stator::formats
