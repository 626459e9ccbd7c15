// What a reader that describes does.

#include <algorithm>
#include <memory>

#include "stator/settings/reader.hpp"

namespace stator::settings {

KeyDescription& Reader::describe(const std::string& key) const {
  return (common_->find(key) != nullptr ? common_ : description_)->key(key);
}

void Reader::note_required(const std::string& key) {
  if (description_ != nullptr) {
    describe(key).required = true;
  }
}

void Reader::note_kind_of_file(std::string_view kind) {
  if (description_ != nullptr) {
    description_->kind_of_file = kind;
  }
}

void Reader::note_default(const KeyWords& key, const std::string& written) {
  if (description_ == nullptr || contains(key.name)) {
    return;
  }
  if (KeyDescription& entry = describe(key.name); entry.default_value.empty()) {
    entry.default_value = written;
  }
}

void Reader::begin_variant(const KeyWords& key, const std::set<std::string>& choices,
                           const std::string& word) {
  if (common_->selector.empty()) {
    note_required(key.name);
    common_->selector = key.name;
    common_->selector_choices.assign(choices.begin(), choices.end());
  }
  description_ = &common_->variant(word);
}

void Reader::end_variants() {
  description_ = common_;
}

TableDescription* Reader::description_below(const KeyWords& key) const {
  if (description_ == nullptr) {
    return nullptr;
  }
  KeyDescription& entry = describe(key.name);
  if (entry.table == nullptr) {
    entry.table = std::make_unique<TableDescription>();
  }
  return entry.table.get();
}

}  // namespace stator::settings
