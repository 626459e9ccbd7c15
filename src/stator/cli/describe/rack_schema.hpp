#pragma once

#include <string>

#include "stator/rack/toml/rack_file_description.hpp"

namespace stator::cli {

/// The keys of a rack file as a JSON schema (draft 07), docs/rack-file.schema.json: what editors
/// check and complete with. Conditions between keys are `stator check`'s alone.
[[nodiscard]] std::string rack_schema(const rack::TableDescription& rack_file);

/// The same as tables in Markdown, docs/rack-file-keys.md.
[[nodiscard]] std::string rack_reference(const rack::TableDescription& rack_file);

}  // namespace stator::cli
