#include "stator/tmcl/assembler/name_table.hpp"

#include <algorithm>

namespace stator::tmcl {

bool NameTable::LessWithoutCase::operator()(std::string_view a, std::string_view b) const {
  return std::ranges::lexicographical_compare(a, b, {}, base::capital, base::capital);
}

const NameTable::Entry* NameTable::add(const Entry& entry) {
  const auto [place, added] = entries_.emplace(entry.name, entry);
  return added ? nullptr : &place->second;
}

const NameTable::Entry* NameTable::find(std::string_view name) const {
  const auto found = entries_.find(name);
  return found != entries_.end() ? &found->second : nullptr;
}

std::vector<std::string_view> NameTable::names(bool labels_too) const {
  std::vector<std::string_view> names;
  for (const auto& [name, entry] : entries_) {
    if (labels_too || entry.kind == Kind::constant) {
      names.push_back(name);
    }
  }
  return names;
}

base::Expected<std::int64_t, std::string> OperandScope::value_of(std::string_view name) const {
  const NameTable::Entry* entry = table_.find(name);
  const std::string word = '"' + std::string(name) + '"';
  if (entry == nullptr) {
    std::vector<std::string_view> known = table_.names(labels_);
    known.insert(known.end(), further_names_.begin(), further_names_.end());
    return base::Unexpected{word +
                            (labels_ ? " is neither label nor constant" : " is no constant") +
                            suggestion(name, known)};
  }
  if (entry->kind == NameTable::Kind::label && !labels_) {
    return base::Unexpected{word + " is a label; expected a number or a constant"};
  }
  if (!entry->value) {
    return base::Unexpected{std::string()};
  }
  return *entry->value;
}

std::string suggestion(std::string_view word, const std::vector<std::string_view>& known) {
  const std::string_view closest = base::closest_match(word, known);
  return closest.empty() ? "" : "; did you mean \"" + std::string(closest) + "\"?";
}

}  // namespace stator::tmcl
