// Bytes of a file in any encoding that ESI files are found in, as UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace stator::formats {

/// A text in UTF-8, and what had to be assumed for it.
struct EsiDecoded {
  std::string text;      ///< without byte order mark
  std::string repaired;  ///< a sentence, if the file says what its bytes contradict
  std::string assumed;   ///< a sentence, if the file names what is not known here
};

/// Decodes a file. Bytes count more than names: what is UTF-8 is read as such, whatever the file
/// says; what is not and has no zeros is of one byte per character.
[[nodiscard]] EsiDecoded decode_esi(std::string_view file);

/// A text with each byte that is no UTF-8 replaced, so that it can be written into JSON.
[[nodiscard]] std::string valid_utf8(std::string_view text);

}  // namespace stator::formats
