#include "stator/settings/value.hpp"

#include <algorithm>
#include <utility>

namespace stator::settings {

Value::Value() = default;
Value::Value(Content content, Place place)
    : content_(std::move(content)), place_(std::move(place)) {}
Value::Value(Table table, Place place)
    : content_(std::in_place_type<Table>, std::move(table)), place_(std::move(place)) {}
Value::Value(List list, Place place)
    : content_(std::in_place_type<List>, std::move(list)), place_(std::move(place)) {}
Value::Value(const char* text) : content_(std::string(text)) {}
Value::Value(std::string text) : content_(std::move(text)) {}
Value::Value(const Value& other) = default;
Value::Value(Value&& other) noexcept = default;
Value& Value::operator=(const Value& other) = default;
Value& Value::operator=(Value&& other) noexcept = default;
Value::~Value() = default;

const Value* Value::at(std::string_view name) const {
  const auto* const table = find<Table>();
  if (table == nullptr) {
    return nullptr;
  }
  const auto found = table->find(name);
  return found != table->end() ? &found->second : nullptr;
}

bool Value::is_list_of_tables() const {
  const auto* const list = find<List>();
  return list != nullptr && !list->empty() &&
         std::ranges::all_of(*list, [](const Value& element) { return element.is<Table>(); });
}

}  // namespace stator::settings
