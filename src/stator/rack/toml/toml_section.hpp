#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#define TOML_HEADER_ONLY 0
#include <toml++/toml.h>

#include "stator/base/sim_time.hpp"
#include "stator/rack/toml/rack_file_description.hpp"
#include "stator/rack/toml/rack_file_error.hpp"

namespace stator::rack {

/// A key of a rack file, with what the reference (docs/rack-file-keys.md) and editors say about it.
struct TomlKey {
  // Plain names are keys without a summary, so that a reader may ask for one it has declared.
  TomlKey(const char* key) : name(key) {}             // NOLINT(google-explicit-constructor)
  TomlKey(std::string key) : name(std::move(key)) {}  // NOLINT(google-explicit-constructor)
  TomlKey(std::string key, std::string text, std::string unit_of_value = "")
      : name(std::move(key)), summary(std::move(text)), unit(std::move(unit_of_value)) {}

  std::string name;
  std::string summary;  ///< a sentence without its full stop
  std::string unit;     ///< of numbers
};

/// Reads one table of a rack file key by key and remembers which keys exist, so that finish() can
/// reject those nobody asked for. All functions throw RackFileError with the key's place in the
/// file; of a section that collects errors, only fail() does, and the others go on as if the key
/// were not there.
///
/// A call that reads a key is its declaration: name, summary, unit, type and range, and where a
/// target is given also the default, which is what the target has. A section that describes notes
/// all that and reads on as if each table were there.
class TomlSection {
 public:
  /// `path` is how people name the table, e.g. "[[segment.device]] number 2". With `errors` they
  /// are collected there, also those of the tables below; it must outlive the section.
  /// With `description` the section describes; it must collect errors, too.
  TomlSection(std::string file, std::string path, const toml::table& table,
              RackFileErrors* errors = nullptr, TableDescription* description = nullptr)
      : file_(std::move(file)),
        path_(std::move(path)),
        table_(&table),
        errors_(errors),
        common_(description),
        description_(description) {}

  [[nodiscard]] const std::string& path() const { return path_; }
  /// The rack file, as it was named.
  [[nodiscard]] const std::string& file() const { return file_; }
  /// Where the table begins in it, from 1.
  [[nodiscard]] std::uint32_t line() const { return table_->source().begin.line; }

  std::optional<std::string> text(const TomlKey& key);
  /// Whether `key` is there and is a text, for keys that take a text or something else.
  [[nodiscard]] bool is_text(const std::string& key) const;
  /// The same for keys that take a truth value or something else.
  [[nodiscard]] bool is_boolean(const std::string& key) const;
  /// The same for keys that take a table or something else.
  [[nodiscard]] bool is_table(const std::string& key) const;
  /// Whether `key` is there; it does not become one of the table's keys by that.
  [[nodiscard]] bool contains(const std::string& key) const { return table_->contains(key); }
  /// A text that must be one of `choices`.
  std::optional<std::string> choice(const TomlKey& key, const std::set<std::string>& choices);
  /// The same for a key that must be there and decides which other keys the table has; those that
  /// are there in any case are asked for before it.
  std::optional<std::string> selector(const TomlKey& key, const std::set<std::string>& choices);
  std::optional<bool> boolean(const TomlKey& key);
  std::optional<std::int64_t> integer(const TomlKey& key, std::int64_t minimum,
                                      std::int64_t maximum);
  /// A finite number in [minimum, maximum]; whole numbers are taken too.
  std::optional<double> number(const TomlKey& key, double minimum, double maximum);
  /// A duration text in [minimum, maximum].
  std::optional<base::SimDuration> duration(const TomlKey& key, base::SimDuration minimum,
                                            base::SimDuration maximum);
  std::optional<std::vector<std::string>> texts(const TomlKey& key);
  /// A list of texts, each one of `choices`.
  std::optional<std::vector<std::string>> choices(const TomlKey& key,
                                                  const std::set<std::string>& choices);
  /// A list of `count` whole numbers in [minimum, maximum].
  std::optional<std::vector<std::int64_t>> integers(const TomlKey& key, std::size_t count,
                                                    std::int64_t minimum, std::int64_t maximum);
  /// The table below `key`.
  std::optional<TomlSection> section(const TomlKey& key);
  /// The tables of the array of tables below `key`; empty if there is none.
  std::vector<TomlSection> sections(const TomlKey& key);

  // The same with a target that keeps its value, the default, if the key is not there.
  void text(const TomlKey& key, std::string& target);
  void boolean(const TomlKey& key, bool& target);
  void number(const TomlKey& key, double minimum, double maximum, double& target);
  void duration(const TomlKey& key, base::SimDuration minimum, base::SimDuration maximum,
                base::SimDuration& target);
  void texts(const TomlKey& key, std::vector<std::string>& target);
  template <typename Integer>
  void integer(const TomlKey& key, std::int64_t minimum, std::int64_t maximum, Integer& target) {
    static_assert(std::is_integral_v<Integer>);
    if (const auto value = integer(key, minimum, maximum)) {
      target = static_cast<Integer>(*value);
    }
    note_default(key, std::to_string(target));
  }
  /// Words and what they stand for.
  template <typename Value>
  void choice(const TomlKey& key, const std::map<std::string, Value>& words, Value& target) {
    std::set<std::string> names;
    for (const auto& [name, value] : words) {
      names.insert(name);
      if (value == target) {
        note_default(key, '"' + name + '"');
      }
    }
    if (const auto name = choice(key, names)) {
      target = words.at(*name);
    }
  }
  /// Says what stands for a key that is not there, where no target shows it.
  void note_default(const TomlKey& key, const std::string& written);

  /// The name of a file to be written; empty if it is not there. Where errors are collected, its
  /// directory is looked at.
  std::string output(const TomlKey& key);
  /// Where errors are collected: a server at `address`, which `key` names, must be the only one
  /// there.
  void claim(const std::string& key, const std::string& address);

  /// All keys of the table, for tables whose keys are no fixed names.
  [[nodiscard]] std::vector<std::string> names();

  /// Refuses the keys that no call above asked for, and says which exist.
  void finish();

  /// Errors are collected: somebody wants to know all that is wrong, and nothing is to be run.
  [[nodiscard]] bool collects_errors() const { return errors_ != nullptr; }
  /// Where they are collected; null if they are thrown.
  [[nodiscard]] RackFileErrors* errors() const { return errors_; }

  /// Something is wrong with `key`, or with the table itself when it has no such key, without which
  /// reading cannot go on: throws. Of a table that comes from no file the error is the reason
  /// alone.
  [[noreturn]] void fail(const std::string& key, const std::string& reason);
  /// The same for a key without which the table says nothing and that is not there.
  [[noreturn]] void missing(const std::string& key, const std::string& explanation);
  /// The same for a device that `key` names and that is not there.
  [[noreturn]] void fail_for_reference(const std::string& key, const std::string& reason);
  /// Something is wrong with `key`, but reading can go on: collected if errors are collected, else
  /// thrown. A second error of the same key is dropped, since it follows from the first.
  void refuse(const std::string& key, const std::string& reason);
  /// The same for a key without which the table says little and that is not there.
  void refuse_missing(const std::string& key, const std::string& explanation);
  /// The same for an error in another file, which `key` names.
  void refuse(const std::string& key, const RackFileError& error);

  /// Calls `read`. Where errors are collected, one that is thrown ends no more than this call.
  /// Returns whether `read` came to its end.
  template <typename Function>
  bool attempt(const Function& read) {
    if (errors_ == nullptr) {
      read();
      return true;
    }
    try {
      read();
      return true;
    } catch (const RackFileError& error) {
      collect(error);
      return false;
    }
  }

 private:
  /// `value`, unless it is none of `choices`, which is refused.
  std::optional<std::string> one_of(const TomlKey& key, std::string value,
                                    const std::set<std::string>& choices);
  std::optional<std::vector<std::string>> texts_of(const TomlKey& key, const toml::node* node);
  const toml::node* find(const TomlKey& key, ValueForm form);
  const toml::node* find(const TomlKey& key, ValueKind kind) { return find(key, ValueForm{kind}); }
  [[nodiscard]] bool answer(const std::string& key, bool otherwise) const;
  std::optional<std::string> text_of(const TomlKey& key, const toml::node* node);
  [[nodiscard]] TableDescription* description_below(const TomlKey& key) const;
  [[nodiscard]] KeyDescription& describe(const std::string& key) const;
  [[nodiscard]] RackFileError error_at(const std::string& key, const std::string& reason) const;
  void collect(const RackFileError& error);

  std::string file_;
  std::string path_;
  const toml::table* table_;
  RackFileErrors* errors_;
  TableDescription* common_;       ///< keys that do not depend on the selector; null: none
  TableDescription* description_;  ///< where further keys are noted
  std::set<std::string> asked_;
  std::set<std::string> refused_;
};

}  // namespace stator::rack
