// Declarations of objects that no source of the program has: read from a file, or made by a program
// of a user.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stator/dictionary/declaration.hpp"

namespace stator::dictionary {

/// Declarations with the texts that they refer to. Moves leave the texts where they are; a copy
/// would refer to the original's.
class OwnedDeclarations {
 public:
  OwnedDeclarations() = default;
  OwnedDeclarations(OwnedDeclarations&&) = default;
  OwnedDeclarations& operator=(OwnedDeclarations&&) = default;
  OwnedDeclarations(const OwnedDeclarations&) = delete;
  OwnedDeclarations& operator=(const OwnedDeclarations&) = delete;
  ~OwnedDeclarations() = default;

  /// Keeps a text as long as this lives. A zero byte stands behind it.
  std::string_view keep(std::string text) { return texts_.emplace_back(std::move(text)); }

  /// In the order in which a dictionary takes them: by index, then by subindex.
  [[nodiscard]] std::vector<EntryDeclaration>& rows() { return rows_; }
  /// The same.
  [[nodiscard]] const std::vector<EntryDeclaration>& rows() const { return rows_; }

 private:
  std::deque<std::string> texts_;
  std::vector<EntryDeclaration> rows_;
};

}  // namespace stator::dictionary
