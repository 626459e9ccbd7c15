#include "stator/settings/description.hpp"

#include <algorithm>

namespace stator::settings {

KeyDescription& TableDescription::key(const std::string& name) {
  const auto found = std::ranges::find(keys, name, &KeyDescription::name);
  if (found != keys.end()) {
    return *found;
  }
  keys.emplace_back();
  keys.back().name = name;
  return keys.back();
}

const KeyDescription* TableDescription::find(const std::string& name) const {
  const auto found = std::ranges::find(keys, name, &KeyDescription::name);
  return found != keys.end() ? &*found : nullptr;
}

TableDescription& TableDescription::variant(const std::string& value) {
  const auto found = std::ranges::find(variants, value, &TableVariant::value);
  if (found != variants.end()) {
    return *found->table;
  }
  variants.push_back({value, std::make_unique<TableDescription>()});
  return *variants.back().table;
}

}  // namespace stator::settings
