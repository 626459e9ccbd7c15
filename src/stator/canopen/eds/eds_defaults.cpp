#include "stator/canopen/eds/eds_defaults.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "stator/canopen/eds/eds_values.hpp"

namespace stator::canopen {

namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::Default;
using dictionary::EntryDeclaration;
using dictionary::ImportKind;
using dictionary::Number;
using dictionary::Range;

/// Highest node-ID, which is the most that "$NODEID" adds.
constexpr std::uint64_t kMostNodeId = 127;

bool is_real(DataType type) {
  return type == DataType::real32 || type == DataType::real64;
}

bool below(DataType type, std::uint64_t a, std::uint64_t b) {
  return is_signed(type) ? static_cast<std::int64_t>(a) < static_cast<std::int64_t>(b) : a < b;
}

Range whole_range(DataType type) {
  const std::size_t length = bit_length(type);
  constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();
  if (!is_signed(type)) {
    return {0, length >= 64 ? kAll : (std::uint64_t{1} << length) - 1};
  }
  const std::uint64_t top = std::uint64_t{1} << (length - 1);
  return {std::uint64_t{0} - top, top - 1};
}

Number as_number(std::uint64_t bits, bool hexadecimal) {
  return hexadecimal ? dictionary::hex(bits) : Number(bits);
}

/// Reads the texts of one entry.
class ValueReader {
 public:
  ValueReader(EntryDeclaration& declaration, const WrittenEntry& entry,
              dictionary::OwnedDeclarations& texts, ImportNotes& notes)
      : declaration_(declaration), entry_(entry), texts_(texts), notes_(notes) {}

  void read() {
    const WrittenText& start = written_start(entry_);
    const DataType type = declaration_.type;
    if (is_string(type)) {
      declaration_.default_value.documented = !start.text.empty();
      declaration_.default_value.text = texts_.keep(text_value(start));
      return;
    }
    if (start.text.empty()) {
      declaration_.default_value = dictionary::undocumented(0);
    } else if (is_real(type)) {
      declaration_.default_value = Default(Number(real_value(start)));
    } else {
      declaration_.default_value = number_value(start);
    }
    if (!entry_.low_limit.text.empty() || !entry_.high_limit.text.empty()) {
      declaration_.range = is_real(type) ? real_range() : number_range();
    }
  }

 private:
  [[nodiscard]] std::string place() const {
    return entry_text(declaration_.index, declaration_.subindex);
  }
  [[nodiscard]] std::string type_text() const {
    return std::string(std::string_view(to_text(declaration_.type)));
  }
  void note(ImportKind kind, const WrittenText& written, std::string_view rule,
            const std::string& text) {
    notes_.add(kind, written.line, rule, place() + ": " + text);
  }

  void note_spelling(const EdsNumber& number, const WrittenText& written) {
    const std::string text = quoted(written.text);
    switch (number.spelling) {
      case NumberSpelling::standard:
        break;
      case NumberSpelling::octal:
        note(ImportKind::assumed, written, "octal-number",
             text +
                 " is octal by CiA 306-1, since it begins with 0: " + std::to_string(number.bits));
        break;
      case NumberSpelling::bare_hexadecimal:
        note(ImportKind::repaired, written, "bare-hexadecimal",
             text + " is read as hexadecimal, which 0x should say");
        break;
      case NumberSpelling::leading_zero:
        note(ImportKind::repaired, written, "leading-zero",
             text + " begins with 0 but is no octal number; it is read as a decimal one");
        break;
    }
  }

  /// An octet string, a text or a domain, as its bytes.
  std::string text_value(const WrittenText& written) {
    if (written.text.empty()) {
      return {};
    }
    if (declaration_.type == DataType::visible_string) {
      return std::string(written.text);
    }
    if (std::optional<std::string> octets = parse_octets(written.text)) {
      return *std::move(octets);
    }
    if (declaration_.type == DataType::unicode_string) {
      // 16 bits for each character, the low ones first (CiA 301 §7.1.6.5).
      std::string wide;
      for (const char c : written.text) {
        wide += c;
        wide += '\0';
      }
      return wide;
    }
    note(ImportKind::assumed, written, "octets-as-text",
         quoted(written.text) + " is not in hexadecimal; its characters are taken as the bytes");
    return std::string(written.text);
  }

  std::uint64_t unreadable(const WrittenText& written) {
    note(ImportKind::repaired, written, "value-unreadable",
         quoted(written.text) + " is no value of " + type_text() + "; 0 is taken");
    return 0;
  }

  std::uint64_t real_value(const WrittenText& written) {
    if (const std::optional<double> value = parse_eds_real(written.text)) {
      return real_bits(declaration_.type, *value);
    }
    const std::optional<EdsNumber> number = parse_eds_number(written.text);
    if (!number || number->node_id_relative) {
      return unreadable(written);
    }
    const std::size_t length = bit_length(declaration_.type);
    const std::uint64_t mask =
        length >= 64 ? std::numeric_limits<std::uint64_t>::max() : (std::uint64_t{1} << length) - 1;
    if (number->bits != 0) {
      note(ImportKind::assumed, written, "real-in-hexadecimal",
           quoted(written.text) + " is taken as the bits of a " + type_text());
    }
    return number->bits & mask;
  }

  /// A number; what is no integer is cut to one, a word for yes or no is 1 or 0.
  std::optional<EdsNumber> integer(const WrittenText& written) {
    if (const std::optional<EdsNumber> number = parse_eds_number(written.text)) {
      return number;
    }
    EdsNumber number;
    if (const std::optional<bool> flag = parse_flag(written.text)) {
      number.bits = *flag ? 1 : 0;
      return number;
    }
    const std::optional<double> real = parse_eds_real(written.text);
    if (!real || !(std::abs(*real) < 9e18)) {
      return std::nullopt;
    }
    const auto whole = static_cast<std::int64_t>(*real);
    number.bits = static_cast<std::uint64_t>(whole);
    number.negative = whole < 0;
    if (static_cast<double>(whole) != *real) {
      note(ImportKind::repaired, written, "value-cut",
           quoted(written.text) + " is cut to " + std::to_string(whole) + ", a value of " +
               type_text());
    }
    return number;
  }

  Default number_value(const WrittenText& written) {
    const std::optional<EdsNumber> number = integer(written);
    if (!number) {
      return dictionary::undocumented(unreadable(written));
    }
    note_spelling(*number, written);
    const FittedNumber fitted = fit_number(declaration_.type, *number);
    if (!fitted.fits) {
      note(
          ImportKind::repaired, written, "value-cut",
          quoted(written.text) + " does not fit " + type_text() + "; it is cut to " +
              (is_signed(declaration_.type) ? std::to_string(static_cast<std::int64_t>(fitted.bits))
                                            : std::to_string(fitted.bits)));
    }
    if (number->node_id_relative) {
      const Range whole = whole_range(declaration_.type);
      declaration_.node_id_relative =
          !below(declaration_.type, whole.maximum.bits - kMostNodeId, fitted.bits) &&
          !below(declaration_.type, whole.maximum.bits, kMostNodeId);
      if (!declaration_.node_id_relative) {
        note(ImportKind::repaired, written, "node-id-beyond-type",
             quoted(written.text) + " with a node-ID does not fit " + type_text() +
                 "; it is taken without");
      }
    }
    return {as_number(fitted.bits, number->hexadecimal)};
  }

  /// A limit of a number; nothing if there is none that holds.
  std::optional<Number> number_limit(const WrittenText& written) {
    if (written.text.empty()) {
      return std::nullopt;
    }
    const std::optional<EdsNumber> number = integer(written);
    if (!number || number->node_id_relative) {
      note(ImportKind::left_out, written, "limit-unreadable",
           "the limit " + quoted(written.text) +
               (number ? " counts from the node-ID, as no limit here can" : " is no number") +
               "; there is none");
      return std::nullopt;
    }
    note_spelling(*number, written);
    const FittedNumber fitted = fit_number(declaration_.type, *number);
    if (!fitted.fits) {
      note(ImportKind::repaired, written, "limit-beyond-type",
           "the limit " + quoted(written.text) + " does not fit " + type_text() +
               ", whose own takes its place");
      return std::nullopt;
    }
    return as_number(fitted.bits, number->hexadecimal);
  }

  [[nodiscard]] const WrittenText& any_limit() const {
    return entry_.low_limit.text.empty() ? entry_.high_limit : entry_.low_limit;
  }
  std::optional<Range> contradiction(std::string_view rule, const std::string& text) {
    note(ImportKind::repaired, any_limit(), rule,
         "the limits " + quoted(entry_.low_limit.text) + " and " + quoted(entry_.high_limit.text) +
             " " + text + "; there are none");
    return std::nullopt;
  }

  std::optional<Range> number_range() {
    const DataType type = declaration_.type;
    const Range whole = whole_range(type);
    const Range range{number_limit(entry_.low_limit).value_or(whole.minimum),
                      number_limit(entry_.high_limit).value_or(whole.maximum)};
    const std::uint64_t low = range.minimum.bits;
    const std::uint64_t high = range.maximum.bits;
    if (low == whole.minimum.bits && high == whole.maximum.bits) {
      return std::nullopt;
    }
    if (below(type, high, low)) {
      return contradiction("limits-contradict", "exclude every value");
    }
    const bool writable =
        declaration_.access == Access::read_write || declaration_.access == Access::write_only;
    if (writable && low == 0 && high == 0) {
      // Tools fill in zeros where nobody gave limits.
      return contradiction("limits-empty", "leave nothing to write but 0");
    }
    std::uint64_t& start = declaration_.default_value.number.bits;
    if (declaration_.node_id_relative || (!below(type, start, low) && !below(type, high, start))) {
      return range;
    }
    if (declaration_.default_value.documented) {
      return contradiction("limits-exclude-default", "exclude the entry's own value");
    }
    start = low;
    note(ImportKind::assumed, any_limit(), "default-assumed",
         "the file has no value; since 0 is beyond the limits, the lowest is taken");
    return range;
  }

  /// Ranges of reals are compared by their bits, which are in the order of the numbers as long as
  /// none is negative.
  std::optional<Range> real_range() {
    const std::optional<double> low = parse_eds_real(entry_.low_limit.text);
    const std::optional<double> high = entry_.high_limit.text.empty()
                                           ? std::optional(std::numeric_limits<double>::infinity())
                                           : parse_eds_real(entry_.high_limit.text);
    if (!low || !high || !(*low >= 0.0) || !(*high >= 0.0) || std::signbit(*low) ||
        std::signbit(*high)) {
      note(ImportKind::left_out, any_limit(), "limits-of-real",
           "limits of a " + type_text() + " are checked where both are numbers from 0 on");
      return std::nullopt;
    }
    const Range range{real_bits(declaration_.type, *low), real_bits(declaration_.type, *high)};
    if (range.maximum.bits < range.minimum.bits) {
      return contradiction("limits-contradict", "exclude every value");
    }
    std::uint64_t& start = declaration_.default_value.number.bits;
    if (start >= range.minimum.bits && start <= range.maximum.bits) {
      return range;
    }
    if (declaration_.default_value.documented) {
      return contradiction("limits-exclude-default", "exclude the entry's own value");
    }
    start = range.minimum.bits;
    return range;
  }

  EntryDeclaration& declaration_;
  const WrittenEntry& entry_;
  dictionary::OwnedDeclarations& texts_;
  ImportNotes& notes_;
};

}  // namespace

const WrittenText& written_start(const WrittenEntry& entry) {
  return entry.value.text.empty() ? entry.default_value : entry.value;
}

void declare_values(EntryDeclaration& declaration, const WrittenEntry& entry,
                    dictionary::OwnedDeclarations& texts, ImportNotes& notes) {
  ValueReader(declaration, entry, texts, notes).read();
}

}  // namespace stator::canopen
