// What became of a file that describes a device: what is known from it, what was assumed, repaired,
// left out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace stator::dictionary {

/// How a fact about an imported device came about.
enum class ImportKind : std::uint8_t {
  known,     ///< the file says it
  assumed,   ///< the file does not say it, so that something had to be chosen
  repaired,  ///< the file says what cannot be so; it was read in another way
  left_out,  ///< the file says it, and the device does not have it
};

/// One line of the table that an import prints.
struct ImportNote {
  ImportKind kind = ImportKind::known;
  std::size_t line = 0;  ///< of the file, from 1; 0: it is about the whole file
  std::string rule;      ///< which names it for programs, e.g. "pdo-maps-itself"
  std::string text;      ///< a sentence for people: what, and why
};

/// All of them, in the order of the file.
struct ImportReport {
  std::vector<ImportNote> notes;

  /// Adds one.
  void add(ImportKind kind, std::size_t line, std::string rule, std::string text) {
    notes.push_back({kind, line, std::move(rule), std::move(text)});
  }
};

/// Why a file gives no device.
struct ImportError {
  std::size_t line = 0;  ///< from 1; 0: it is about the whole file
  std::string rule;      ///< which names it for programs, e.g. "not-xml"
  std::string text;      ///< what is wrong, and what to do about it
};

}  // namespace stator::dictionary
