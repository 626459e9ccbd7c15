// Defaults and limits of entries, from the texts that a file has for them.
#pragma once

#include <optional>
#include <string_view>

#include "stator/canopen/eds/eds_objects.hpp"
#include "stator/canopen/eds/import_notes.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/dictionary/owned_declarations.hpp"

namespace stator::canopen {

/// The text that says with which value an entry starts: that of the one device before the default
/// of all of them. Empty: none does.
[[nodiscard]] const WrittenText& written_start(const WrittenEntry& entry);

/// Gives the declaration, whose address, type and access are known, the default and the range that
/// the file has for the entry. What cannot be so is repaired, and `notes` say how.
void declare_values(dictionary::EntryDeclaration& declaration, const WrittenEntry& entry,
                    dictionary::OwnedDeclarations& texts, ImportNotes& notes);

}  // namespace stator::canopen
