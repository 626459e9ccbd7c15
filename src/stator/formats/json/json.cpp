#include "stator/formats/json/json.hpp"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/formats/nesting.hpp"

namespace stator::formats {

namespace {

using settings::List;
using settings::Place;
using settings::Table;
using settings::Value;

/// Goes with the lexer through the text, which tells no places, and notes where values begin.
class Position {
 public:
  explicit Position(std::string_view text) : rest_(text) {}

  [[nodiscard]] char next() const { return rest_.front(); }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }
  void advance() {
    const char character = rest_.front();
    rest_.remove_prefix(1);
    last_ = here_;
    constexpr std::string_view kBetween = " \t\r\n,:]}";
    const bool opens = character == '[' || character == '{';
    if (in_text_) {
      in_text_ = character != '"' || escaped_;
      escaped_ = character == '\\' && !escaped_;
    } else if (kBetween.find(character) != std::string_view::npos) {
      in_word_ = false;
    } else if (opens || character == '"' || !in_word_) {
      value_ = here_;
      in_text_ = character == '"';
      in_word_ = !opens;
    }
    constexpr unsigned kContinuation = 0x80;
    constexpr unsigned kMask = 0xC0;
    if (character == '\n') {
      ++here_.line;
      here_.column = 1;
    } else if (rest_.empty() ||
               (static_cast<unsigned char>(rest_.front()) & kMask) != kContinuation) {
      ++here_.column;
    }
  }
  /// Of the value that the lexer has read last; behind a number it has read one character more,
  /// with which none begins.
  [[nodiscard]] const Place& value() const { return value_; }
  /// Of the character that was read last; behind the end: of the end.
  [[nodiscard]] const Place& last(bool end) const { return end ? here_ : last_; }

 private:
  std::string_view rest_;
  Place here_{1, 1};
  Place last_{1, 1};
  Place value_{1, 1};
  bool in_text_ = false;
  bool escaped_ = false;
  bool in_word_ = false;
};

/// The text as the lexer reads it.
class Characters {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = char;

  Characters() = default;
  explicit Characters(Position& position) : position_(&position) {}

  char operator*() const { return position_->next(); }
  Characters& operator++() {
    position_->advance();
    return *this;
  }
  Characters operator++(int) {
    position_->advance();
    return *this;
  }
  friend bool operator==(const Characters& a, const Characters& b) { return a.left() == b.left(); }

 private:
  [[nodiscard]] std::size_t left() const { return position_ != nullptr ? position_->left() : 0; }

  Position* position_ = nullptr;
};

/// Makes the tree of what the parser comes upon.
class TreeBuilder {
 public:
  TreeBuilder(const Position& position, const std::string& name)
      : position_(&position), name_(&name) {}

  // NOLINTBEGIN(readability-identifier-naming): names of nlohmann::json_sax
  bool null() { return add({}); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(std::int64_t value) { return add(value); }
  bool number_unsigned(std::uint64_t value) {
    return value <= std::uint64_t{std::numeric_limits<std::int64_t>::max()}
               ? add(static_cast<std::int64_t>(value))
               : add(static_cast<double>(value));
  }
  bool number_float(double value, const std::string& /*text*/) { return add(value); }
  bool string(std::string& value) { return add(std::move(value)); }
  bool binary(nlohmann::json::binary_t& /*value*/) { return false; }
  bool start_object(std::size_t /*elements*/) { return open(Table{}); }
  bool start_array(std::size_t /*elements*/) { return open(List{}); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& name) {
    auto* const table = open_.back()->find<Table>();
    const auto [place, is_new] = table->try_emplace(name);
    if (!is_new) {
      return refuse(position_->value(),
                    fmt::format("the name \"{}\" stands twice in its object; leave one out", name));
    }
    next_ = &place->second;
    return true;
  }
  bool parse_error(std::size_t /*position*/, const std::string& /*token*/,
                   const nlohmann::json::exception& error) {
    constexpr int kNumberOverflow = 406;
    if (error.id == kNumberOverflow) {
      return refuse(position_->value(), "the number is too large; write one up to 1.7e308");
    }
    // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while ..."
    constexpr std::string_view kPlaceEnd = ": ";
    constexpr std::string_view kTextEnd = "; last read: ";
    std::string_view reason(error.what());
    reason.remove_prefix(reason.find(kPlaceEnd) + kPlaceEnd.size());
    reason = reason.substr(0, reason.find(kTextEnd));
    const std::string_view found = reason.substr(0, reason.find("; expected "));
    if (found.ends_with("unexpected end of input")) {
      return refuse(position_->last(true), std::string(reason));
    }
    return refuse(found.ends_with(" literal") ? position_->value() : position_->last(false),
                  std::string(reason));
  }
  // NOLINTEND(readability-identifier-naming)

  [[nodiscard]] Value& tree() { return tree_; }
  /// What is wrong with the text.
  [[nodiscard]] const settings::Problem& problem() const { return *problem_; }

 private:
  bool refuse(const Place& place, std::string reason) {
    problem_.emplace(*name_, place.line, place.column, "", std::move(reason));
    return false;
  }
  Value& put(Value::Content content) {
    Value value(std::move(content), position_->value());
    if (open_.empty()) {
      return tree_ = std::move(value);
    }
    if (auto* const list = open_.back()->find<List>()) {
      return list->emplace_back(std::move(value));
    }
    return *next_ = std::move(value);
  }
  bool add(Value::Content content) {
    put(std::move(content));
    return true;
  }
  bool open(Value::Content content) {
    if (open_.size() == kDeepestNesting) {
      return refuse(position_->value(), std::string(kNestedTooDeep));
    }
    // It stays where it is: its list grows only when it is closed.
    open_.push_back(&put(std::move(content)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  const Position* position_;
  const std::string* name_;
  Value tree_;
  std::vector<Value*> open_;  ///< those around what comes next, the innermost last
  Value* next_ = nullptr;     ///< of the innermost table: the value whose name was read
  std::optional<settings::Problem> problem_;
};

}  // namespace

base::Expected<Value, settings::Problem> parse_json(std::string_view text,
                                                    const std::string& name) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) {
    text.remove_prefix(kByteOrderMark.size());
  }
  Position position(text);
  TreeBuilder builder(position, name);
  if (!nlohmann::json::sax_parse(Characters(position), Characters(), &builder)) {
    return base::Unexpected{builder.problem()};
  }
  return std::move(builder.tree());
}

}  // namespace stator::formats
