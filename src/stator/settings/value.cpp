#include "stator/settings/value.hpp"

#include <algorithm>

namespace stator::settings {

const Value* Value::at(std::string_view name) const {
  const Table* const table = find<Table>();
  if (table == nullptr) {
    return nullptr;
  }
  const auto found = table->find(name);
  return found != table->end() ? &found->second : nullptr;
}

bool Value::is_list_of_tables() const {
  const List* const list = find<List>();
  return list != nullptr && !list->empty() &&
         std::ranges::all_of(*list, [](const Value& element) { return element.is<Table>(); });
}

}  // namespace stator::settings
