#include "stator/canopen/eds/eds_lines.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "stator/base/spelling.hpp"
#include "stator/canopen/eds/eds_values.hpp"

namespace stator::canopen {

namespace {

using dictionary::ImportError;
using dictionary::ImportKind;

// Far more than any device has; what is kept of a text is then less than 150 MB.
constexpr std::size_t kMostSections = 200'000;
constexpr std::size_t kMostLines = 2'000'000;

/// Whether a comes before b, whatever their letters' case.
bool earlier_word(std::string_view a, std::string_view b) {
  return std::ranges::lexicographical_compare(a, b, {}, base::capital, base::capital);
}

/// Takes a text line by line.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// The next line without its end; nothing behind the last.
  std::optional<std::string_view> next() {
    if (rest_.empty()) {
      return std::nullopt;
    }
    ++line_;
    const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    const bool pair = rest_.substr(end).starts_with("\r\n");
    rest_.remove_prefix(std::min(end + (pair ? 2 : 1), rest_.size()));
    return line;
  }
  [[nodiscard]] std::size_t line() const { return line_; }

 private:
  std::string_view rest_;
  std::size_t line_ = 0;
};

/// Makes sections of lines.
class Splitter {
 public:
  explicit Splitter(ImportNotes& notes) : notes_(notes) {}

  base::Expected<EdsSections, ImportError> split(std::string_view text) {
    LineReader reader(text);
    while (const std::optional<std::string_view> whole = reader.next()) {
      const std::string_view line = trimmed(*whole);
      if (line.empty() || line.front() == ';' || line.front() == '#') {
        continue;
      }
      if (line.front() == '[') {
        begin_section(line, reader.line());
      } else {
        take_line(line, reader.line());
      }
      if (sections_.size() > kMostSections || lines_ > kMostLines) {
        return base::Unexpected<ImportError>{
            {reader.line(), "too-large",
             "the file has more sections or lines than any device; take out what no master needs"}};
      }
    }
    drop_repeated_keys();
    drop_repeated_sections();
    return std::move(sections_);
  }

 private:
  void begin_section(std::string_view line, std::size_t number) {
    std::string_view name = line.substr(1);
    const std::size_t end = name.find(']');
    if (end == std::string_view::npos) {
      notes_.add(ImportKind::repaired, number, "section-open",
                 "the name of section " + quoted(trimmed(name)) + " has no ] behind it");
    } else {
      name = name.substr(0, end);
    }
    sections_.push_back({trimmed(name), number, {}});
  }

  void take_line(std::string_view line, std::size_t number) {
    if (sections_.empty()) {
      if (!std::exchange(before_sections_, true)) {
        notes_.add(ImportKind::left_out, number, "text-before-sections",
                   "text before the first section, from " + quoted(line) + " on");
      }
      return;
    }
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) {
      notes_.add(ImportKind::left_out, number, "line-without-value",
                 quoted(line) + " is no \"Key=Value\"");
      return;
    }
    ++lines_;
    sections_.back().lines.push_back(
        {trimmed(line.substr(0, equals)), {trimmed(line.substr(equals + 1)), number}});
  }

  void drop_repeated_keys() {
    for (EdsSection& section : sections_) {
      std::vector<EdsLine>& lines = section.lines;
      std::ranges::stable_sort(lines, earlier_word, &EdsLine::key);
      for (std::size_t i = 1; i < lines.size(); ++i) {
        if (base::same_word(lines[i - 1].key, lines[i].key)) {
          notes_.add(ImportKind::repaired, lines[i].value.line, "key-repeated",
                     "[" + readable_text(section.name) + "] has " + quoted(lines[i].key) +
                         " again; the first counts");
        }
      }
      const auto same_key = [](const EdsLine& one, const EdsLine& other) {
        return base::same_word(one.key, other.key);
      };
      lines.erase(std::unique(lines.begin(), lines.end(), same_key), lines.end());
    }
  }

  void drop_repeated_sections() {
    std::vector<std::size_t> order(sections_.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      order[i] = i;
    }
    const auto name = [this](std::size_t i) { return sections_[i].name; };
    std::ranges::stable_sort(order, earlier_word, name);
    std::vector<bool> repeated(sections_.size());
    for (std::size_t i = 1; i < order.size(); ++i) {
      if (base::same_word(name(order[i - 1]), name(order[i]))) {
        repeated[order[i]] = true;
        notes_.add(ImportKind::repaired, sections_[order[i]].line, "section-repeated",
                   "section " + quoted(name(order[i])) + " stands here again; the first counts");
      }
    }
    EdsSections kept;
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      if (!repeated[i]) {
        kept.push_back(std::move(sections_[i]));
      }
    }
    sections_ = std::move(kept);
  }

  ImportNotes& notes_;
  EdsSections sections_;
  std::size_t lines_ = 0;
  bool before_sections_ = false;
};

ImportError not_eds(const std::string& what) {
  return {0, "not-eds", "the file is no EDS or DCF (CiA 306-1): " + what};
}

/// Bytes that no text has; a file of 16-bit characters has zeros.
bool is_binary(std::string_view text) {
  return text.find('\0') != std::string_view::npos;
}

std::string kind_of_xml(std::string_view text) {
  // The root stands near the beginning, behind comments of a few lines.
  const std::string_view beginning = text.substr(0, 20'000);
  const auto has = [beginning](std::string_view word) {
    return beginning.find(word) != std::string_view::npos;
  };
  if (has("ISO15745ProfileContainer")) {
    return "it is an XML device description; give it the ending .xdd or .xdc";
  }
  if (has("<EtherCATInfo")) {
    return "it is an ESI file of EtherCAT slaves";
  }
  return "it is XML";
}

std::string_view first_word_behind(std::string_view text, char opening) {
  const std::string_view rest = text.substr(text.find(opening) + 1);
  const std::size_t begin = std::min(rest.find_first_not_of(" \t\r\n"), rest.size());
  return rest.substr(begin, 1);
}

}  // namespace

WrittenText EdsSection::find(std::string_view key) const {
  const auto found = std::ranges::lower_bound(lines, key, earlier_word, &EdsLine::key);
  return found != lines.end() && base::same_word(found->key, key) ? found->value : WrittenText{};
}

base::Expected<EdsSections, ImportError> split_eds(std::string_view text, ImportNotes& notes) {
  return Splitter(notes).split(text);
}

const EdsSection* find_section(const EdsSections& sections, std::string_view name) {
  const auto found = std::ranges::find_if(
      sections, [name](const EdsSection& section) { return base::same_word(section.name, name); });
  return found != sections.end() ? &*found : nullptr;
}

std::optional<ImportError> other_format(std::string_view text) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    return not_eds("its characters are of 16 bits (UTF-16); save it as UTF-8");
  }
  text = bare_text(text);
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) {
    return not_eds("it is empty");
  }
  text.remove_prefix(begin);
  constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kBeginnings{{
      {"PK\x03\x04", "it is a ZIP archive; take the file out of it"},
      {"\x1F\x8B", "it is compressed with gzip; unpack it"},
      {"%PDF", "it is a PDF document"},
      {"\x7F"
       "ELF",
       "it is a program"},
  }};
  for (const auto& [beginning, what] : kBeginnings) {
    if (text.starts_with(beginning)) {
      return not_eds(std::string(what));
    }
  }
  if (is_binary(text)) {
    return not_eds("it is no text, but binary");
  }
  if (text.front() == '<') {
    return not_eds(kind_of_xml(text));
  }
  if (text.front() == '{') {
    return not_eds("it looks like JSON");
  }
  if (text.front() == '[') {
    const std::string_view behind = first_word_behind(text, '[');
    if (behind == "{" || behind == "\"" || behind == "[") {
      return not_eds("it looks like JSON");
    }
  }
  if (text.starts_with("VERSION \"")) {
    return not_eds("it looks like a DBC file of CAN messages");
  }
  return std::nullopt;
}

std::string_view bare_text(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) {
    text.remove_prefix(3);
  }
  while (!text.empty() && (text.back() == '\0' || text.back() == '\x1A')) {
    text.remove_suffix(1);
  }
  return text;
}

}  // namespace stator::canopen
