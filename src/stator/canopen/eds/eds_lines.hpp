// The lines of an electronic data sheet: sections of "Key=Value" (CiA 306-1 §4.2), before anybody
// knows what they say.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/canopen/eds/eds_objects.hpp"
#include "stator/canopen/eds/import_notes.hpp"
#include "stator/dictionary/import_report.hpp"

namespace stator::canopen {

/// "Key=Value", without spaces around either.
struct EdsLine {
  std::string_view key;
  WrittenText value;
};

/// What follows "[Name]". All texts stand in the file.
struct EdsSection {
  std::string_view name;
  std::size_t line = 0;        ///< of the name
  std::vector<EdsLine> lines;  ///< by key, whose letters' case does not count; none twice

  /// The value of a key; without text if there is none. Letters' case does not count.
  [[nodiscard]] WrittenText find(std::string_view key) const;
};

/// Sections in the order of the file, none twice.
using EdsSections = std::vector<EdsSection>;

/// Splits a text, in which lines end with CR LF, LF or CR. Of two sections or keys with the same
/// name the first counts, and `notes` say so. A text of more lines than memory is for is refused.
[[nodiscard]] base::Expected<EdsSections, dictionary::ImportError> split_eds(std::string_view text,
                                                                             ImportNotes& notes);

/// The section of this name, or null. Letters' case does not count.
[[nodiscard]] const EdsSection* find_section(const EdsSections& sections, std::string_view name);

/// Why a text is no electronic data sheet, if that can be seen without reading it: it is empty, of
/// another format, or no text at all.
[[nodiscard]] std::optional<dictionary::ImportError> other_format(std::string_view text);

/// The text without the mark of its encoding at the beginning and without what old programs and
/// blocks of memory leave at the end.
[[nodiscard]] std::string_view bare_text(std::string_view text);

}  // namespace stator::canopen
