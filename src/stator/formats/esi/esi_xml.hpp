// The XML of an ESI file: the tree of its elements, whatever the file is encoded in, and the lines
// on which they stand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pugixml.hpp>

#include "stator/base/expected.hpp"
#include "stator/dictionary/import_report.hpp"

namespace stator::formats {

/// Why a file gives nothing, as a reader returns it.
[[nodiscard]] inline base::Unexpected<dictionary::ImportError> refusal(std::size_t line,
                                                                       std::string rule,
                                                                       std::string text) {
  return base::Unexpected{dictionary::ImportError{line, std::move(rule), std::move(text)}};
}

/// "parameter" of <q1:parameter>.
[[nodiscard]] std::string_view local_name(pugi::xml_node node);

/// The tree of a file. Texts of nodes stay where they are as long as this lives, also if it moves.
class EsiXml {
 public:
  /// Reads UTF-8, UTF-16 and what Western Europe's computers wrote before. Refuses what is no XML,
  /// what declares entities, what is nested deeper than any description, and what is too large.
  [[nodiscard]] static base::Expected<EsiXml, dictionary::ImportError> read(std::string_view file);

  /// The outermost element.
  [[nodiscard]] pugi::xml_node root() const { return document_->document_element(); }
  /// Where a node begins, from 1; 0 for none.
  [[nodiscard]] std::size_t line_of(pugi::xml_node node) const;
  /// What had to be assumed about the encoding.
  [[nodiscard]] const std::vector<dictionary::ImportNote>& notes() const { return notes_; }

 private:
  EsiXml() = default;

  // Parsed in place: names and texts of the tree are parts of it.
  std::unique_ptr<std::string> text_ = std::make_unique<std::string>();
  std::unique_ptr<pugi::xml_document> document_ = std::make_unique<pugi::xml_document>();
  std::vector<std::uint32_t> line_ends_;  // offsets of line feeds
  std::vector<dictionary::ImportNote> notes_;
};

/// Collects notes with the lines of their elements. Files have thousands of objects, all of which
/// may have the same fault, so the first of each rule are told and the others counted.
class EsiNotes {
 public:
  /// Both must outlive this.
  EsiNotes(const EsiXml& xml, dictionary::ImportReport& report)
      : xml_(xml), report_(report), first_(report.notes.size()) {}

  /// Adds one about an element; a null node is the whole file.
  void add(dictionary::ImportKind kind, pugi::xml_node at, std::string_view rule, std::string text);
  /// Brings them into the file's order and tells how many were only counted. To be called once.
  void finish();

 private:
  struct Rule {
    std::string name;
    dictionary::ImportKind kind;
    std::size_t count;
  };

  const EsiXml& xml_;
  dictionary::ImportReport& report_;
  std::size_t first_;
  std::vector<Rule> rules_;  // a few dozen
};

}  // namespace stator::formats
