#pragma once

#include <string>
#include <string_view>

#include "stator/settings/description.hpp"

namespace stator::formats {

/// The keys of a table as a JSON schema (draft 07): what editors check and complete with, and forms
/// are made from. Conditions between keys are not in it. `title` is told to people, `name` is the
/// name of the whole in references.
[[nodiscard]] std::string json_schema(const settings::TableDescription& table,
                                      std::string_view title, const std::string& name);

}  // namespace stator::formats
