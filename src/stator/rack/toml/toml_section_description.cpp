// What a section that describes does.

#include <algorithm>
#include <memory>

#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

KeyDescription& TomlSection::describe(const std::string& key) const {
  return (common_->find(key) != nullptr ? common_ : description_)->key(key);
}

void TomlSection::note_default(const TomlKey& key, const std::string& written) {
  if (description_ == nullptr || table_->contains(key.name)) {
    return;
  }
  if (KeyDescription& entry = describe(key.name); entry.default_value.empty()) {
    entry.default_value = written;
  }
}

/// Describing, a key that is not there has one form in one reading and the other in the next.
bool TomlSection::answer(const std::string& key, bool otherwise) const {
  if (description_ == nullptr || table_->contains(key)) {
    return otherwise;
  }
  const bool answer = description_->forms_tried.contains({key, false});
  description_->forms_tried.insert({key, answer});
  return answer;
}

std::optional<std::string> TomlSection::selector(const TomlKey& key,
                                                 const std::set<std::string>& choices) {
  std::optional<std::string> value = choice(key, choices);
  if (description_ != nullptr && common_ == description_) {
    describe(key.name).required = true;
    common_->selector = key.name;
    common_->selector_choices.assign(choices.begin(), choices.end());
    if (!value) {
      value = common_->unknown_variant();
    }
    description_ = &common_->variant(*value);
  }
  return value;
}

TableDescription* TomlSection::description_below(const TomlKey& key) const {
  if (description_ == nullptr) {
    return nullptr;
  }
  KeyDescription& entry = describe(key.name);
  if (entry.table == nullptr) {
    entry.table = std::make_unique<TableDescription>();
  }
  return entry.table.get();
}

}  // namespace stator::rack
