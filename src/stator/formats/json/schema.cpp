#include "stator/formats/json/schema.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace stator::formats {

namespace {

using Json = nlohmann::ordered_json;
using settings::TableDescription;

/// A value as a rack file has it; all that stand for a default or a limit are JSON as well.
Json value_of(const std::string& written) {
  return Json::parse(written, nullptr, false);
}

Json table_schema(const settings::TableDescription& table);

/// Of the schema of "rack-file", or "rack-file#fault", beside this one.
std::string address_of(const std::string& kind_of_file) {
  const std::size_t end = std::min(kind_of_file.find('#'), kind_of_file.size());
  const std::string array = kind_of_file.substr(std::min(end + 1, kind_of_file.size()));
  return kind_of_file.substr(0, end) + ".schema.json" +
         (array.empty() ? "" : "#/properties/" + array + "/items");
}

void add_limits(Json& schema, const settings::ValueForm& form) {
  if (form.minimum == std::to_string(std::numeric_limits<std::int64_t>::min())) {
    return;
  }
  schema["minimum"] = value_of(form.minimum);
  schema["maximum"] = value_of(form.maximum);
}

Json form_schema(const settings::KeyDescription& key, const settings::ValueForm& form) {
  Json schema = Json::object();
  switch (form.kind) {
    case settings::ValueKind::text:
      if (form.choices.empty()) {
        schema["type"] = "string";
      } else {
        schema["enum"] = form.choices;
      }
      break;
    case settings::ValueKind::boolean:
      schema["type"] = "boolean";
      break;
    case settings::ValueKind::integer:
      schema["type"] = "integer";
      add_limits(schema, form);
      break;
    case settings::ValueKind::number:
      schema["type"] = "number";
      add_limits(schema, form);
      break;
    case settings::ValueKind::duration:
      schema["type"] = "string";
      schema["pattern"] = "^-?[0-9.]+([eE][-+]?[0-9]+)? *(ns|us|ms|s)$";
      break;
    case settings::ValueKind::texts:
      schema["type"] = "array";
      if (form.choices.empty()) {
        schema["items"] = {{"type", "string"}};
      } else {
        schema["items"] = {{"enum", form.choices}};
      }
      break;
    case settings::ValueKind::integers:
      schema["type"] = "array";
      schema["items"] = {{"type", "integer"}};
      add_limits(schema["items"], form);
      schema["minItems"] = form.count;
      schema["maxItems"] = form.count;
      break;
    case settings::ValueKind::table:
      if (!key.table->kind_of_file.empty()) {
        return {{"$ref", address_of(key.table->kind_of_file)}};
      }
      return table_schema(*key.table);
    case settings::ValueKind::tables:
      schema["type"] = "array";
      schema["items"] = table_schema(*key.table);
      break;
  }
  return schema;
}

/// "Of a phase. 0.001 to 1000 Ω."
std::string description_of(const settings::KeyDescription& key) {
  std::string text = key.summary.empty() ? "" : key.summary + ".";
  for (const settings::ValueForm& form : key.forms) {
    if (!form.minimum.empty()) {
      text += fmt::format("{}{} to {}{}{}.", text.empty() ? "" : " ", form.minimum, form.maximum,
                          key.unit.empty() ? "" : " ", key.unit);
    }
  }
  return text;
}

Json key_schema(const settings::KeyDescription& key) {
  Json schema;
  if (key.forms.size() == 1) {
    schema = form_schema(key, key.forms.front());
  } else {
    for (const settings::ValueForm& form : key.forms) {
      schema["anyOf"].push_back(form_schema(key, form));
    }
  }
  if (std::string description = description_of(key); !description.empty()) {
    schema["description"] = std::move(description);
  }
  if (!key.default_value.empty()) {
    schema["default"] = value_of(key.default_value);
  }
  return schema;
}

void require(Json& schema, const settings::TableDescription& table) {
  for (const settings::KeyDescription& key : table.keys) {
    if (key.required) {
      schema["required"].push_back(key.name);
    }
  }
}

/// Editors complete with `properties`, so these have what any variant has; a condition for each
/// value of the selector then says what belongs to it.
void add_variants(Json& schema, const settings::TableDescription& table) {
  std::map<std::string, std::vector<Json>> alternatives;
  std::vector<std::string> names;  // in the order in which they are read
  for (const settings::TableVariant& variant : table.variants) {
    for (const settings::KeyDescription& key : variant.table->keys) {
      std::vector<Json>& schemas = alternatives[key.name];
      if (schemas.empty()) {
        names.push_back(key.name);
      }
      Json alternative = key_schema(key);
      if (std::ranges::find(schemas, alternative) == schemas.end()) {
        schemas.push_back(std::move(alternative));
      }
    }
  }
  for (const std::string& name : names) {
    const std::vector<Json>& schemas = alternatives[name];
    schema["properties"][name] = schemas.size() == 1 ? schemas.front() : Json{{"anyOf", schemas}};
  }
  for (const settings::TableVariant& variant : table.variants) {
    Json then;
    for (const settings::KeyDescription& key : table.keys) {
      then["propertyNames"]["enum"].push_back(key.name);
    }
    for (const settings::KeyDescription& key : variant.table->keys) {
      then["propertyNames"]["enum"].push_back(key.name);
      if (alternatives[key.name].size() > 1) {
        then["properties"][key.name] = key_schema(key);
      }
    }
    require(then, *variant.table);
    Json condition;
    condition["if"] = {{"properties", {{table.selector, {{"const", variant.value}}}}},
                       {"required", {table.selector}}};
    condition["then"] = std::move(then);
    schema["allOf"].push_back(std::move(condition));
  }
}

Json table_schema(const settings::TableDescription& table) {
  Json schema;
  schema["type"] = "object";
  if (table.free_names) {
    schema["additionalProperties"] = key_schema(table.keys.front());
    return schema;
  }
  schema["properties"] = Json::object();
  for (const settings::KeyDescription& key : table.keys) {
    schema["properties"][key.name] = key_schema(key);
  }
  require(schema, table);
  add_variants(schema, table);
  schema["additionalProperties"] = false;
  return schema;
}

/// Tables that stand at several places are written once, under "definitions".
class Definitions {
 public:
  /// Shorter ones stay where they are.
  static constexpr std::size_t kShortest = 250;

  explicit Definitions(const Json& schema) { count(schema); }

  /// `schema`, which `name` stands for, with its repeated parts replaced by references.
  [[nodiscard]] Json without_repetitions(const Json& schema, const std::string& name) {
    const bool repeated = is_long_object(schema) && counts_[schema.dump()] > 1;
    if (repeated) {
      const auto known = references_.find(schema.dump());
      if (known != references_.end()) {
        return {{"$ref", known->second}};
      }
    }
    Json result = schema;
    if (result.is_structured()) {
      for (auto& [key, part] : result.items()) {
        part = without_repetitions(part, is_name(key) ? key : name);
      }
    }
    if (!repeated) {
      return result;
    }
    std::string unique = name;
    for (int number = 2; list_.contains(unique); ++number) {
      unique = fmt::format("{}_{}", name, number);
    }
    list_[unique] = std::move(result);
    const std::string reference = "#/definitions/" + unique;
    references_.emplace(schema.dump(), reference);
    return {{"$ref", reference}};
  }
  [[nodiscard]] const Json& list() const { return list_; }

 private:
  /// Of a property, not a word of the schema language or a place in a list.
  [[nodiscard]] static bool is_name(const std::string& key) {
    static const std::set<std::string> words{
        "properties",           "items",    "anyOf", "allOf", "then", "if",
        "additionalProperties", "required", "enum"};
    return !words.contains(key) && key.find_first_not_of("0123456789") != std::string::npos;
  }
  [[nodiscard]] static bool is_long_object(const Json& schema) {
    const auto has = [&schema](const char* word) {
      return schema.contains(word) && !schema[word].is_object();  // else: a property of that name
    };
    return schema.is_object() && schema.dump().size() > kShortest &&
           (has("type") || has("anyOf") || has("enum"));
  }
  void count(const Json& schema) {
    if (is_long_object(schema)) {
      ++counts_[schema.dump()];
    }
    if (schema.is_structured()) {
      for (const Json& part : schema) {
        count(part);
      }
    }
  }

  std::map<std::string, unsigned> counts_;
  std::map<std::string, std::string> references_;
  Json list_ = Json::object();
};

}  // namespace

std::string json_schema(const TableDescription& table, std::string_view title,
                        const std::string& name) {
  Json schema;
  schema["$schema"] = "http://json-schema.org/draft-07/schema#";
  schema["title"] = title;
  const Json root = table_schema(table);
  Definitions definitions(root);
  schema.update(definitions.without_repetitions(root, name));
  schema["definitions"] = definitions.list();
  return schema.dump(1) + "\n";
}

}  // namespace stator::formats
