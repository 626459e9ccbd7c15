#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/settings/description.hpp"
#include "stator/settings/files.hpp"
#include "stator/settings/problem.hpp"
#include "stator/settings/value.hpp"

namespace stator::settings {

/// A key, with what the reference (docs/rack-file-keys.md) and editors say about it.
struct KeyWords {
  // Plain names are keys without a summary, so that a reader may ask for one it has declared.
  KeyWords(const char* key) : name(key) {}             // NOLINT(google-explicit-constructor)
  KeyWords(std::string key) : name(std::move(key)) {}  // NOLINT(google-explicit-constructor)
  KeyWords(std::string_view key) : name(key) {}        // NOLINT(google-explicit-constructor)
  KeyWords(std::string_view key, std::string_view text, std::string_view unit_of_value = "")
      : name(key), summary(text), unit(unit_of_value) {}

  std::string name;
  std::string summary;  ///< a sentence without its full stop
  std::string unit;     ///< of numbers
};

/// A file that a key names, as it was read.
struct FileContent {
  std::string path;
  std::string content;
};

/// One reading of one tree.
struct Reading {
  Problems& problems;
  /// Those the tree names; null: none are read or looked at.
  const Files* files = nullptr;
  std::string file{};  ///< that the tree comes from; empty: none, problems tell no place
  /// Gets the files that keys of the tree name to be read, as they name them; null: nobody asks.
  std::vector<std::string>* named_files = nullptr;
};

/// Reads one table key by key and remembers which keys exist, so that finish() can refuse those
/// nobody asked for. Nothing is thrown and nothing stops: what is wrong is noted with its place,
/// and reading goes on as if the key were not there. Keys that are declared as data are read by
/// this class, too (Key, Section).
///
/// A call that reads a key says all there is to say of it: name, summary, unit, type and range, and
/// where a target is given also the default, which is what the target has. A reader that describes
/// notes all that and reads on as if each table were there.
class Reader {
 public:
  /// `path` is how people name the table, e.g. "[[segment.device]] number 2"; `table` must be one.
  /// `reading` and `table` must outlive the reader and those of the tables below. With
  /// `description` the reader describes.
  Reader(const Reading& reading, std::string path, const Value& table,
         TableDescription* description = nullptr)
      : reading_(&reading),
        path_(std::move(path)),
        table_(&table),
        common_(description),
        description_(description) {}

  [[nodiscard]] const std::string& path() const { return path_; }
  /// The file, as it was named.
  [[nodiscard]] const std::string& file() const { return reading_->file; }
  /// Where the table begins in it, from 1.
  [[nodiscard]] std::uint32_t line() const { return table_->place().line; }
  [[nodiscard]] const Reading& reading() const { return *reading_; }
  /// Keys are noted, not read; targets are defaults.
  [[nodiscard]] bool describes() const { return description_ != nullptr; }

  std::optional<std::string> text(const KeyWords& key);
  /// Whether `key` is there and is a text, for keys that take a text or something else: either().
  [[nodiscard]] bool is_text(const std::string& key) const { return is<std::string>(key); }
  /// The same for keys that take a truth value or something else.
  [[nodiscard]] bool is_boolean(const std::string& key) const { return is<bool>(key); }
  /// The same for keys that take a table or something else.
  [[nodiscard]] bool is_table(const std::string& key) const { return is<Table>(key); }
  /// Of a key that has two forms `first` reads the one, `second` the other, which is there if
  /// `is_second`. A reader that describes does both.
  template <typename First, typename Second>
  void either(bool is_second, const First& first, const Second& second) {
    if (describes() || !is_second) {
      first();
    }
    if (describes() || is_second) {
      second();
    }
  }
  /// Whether `key` is there; it does not become one of the table's keys by that.
  [[nodiscard]] bool contains(const std::string& key) const { return table_->at(key) != nullptr; }
  /// A text that must be one of `choices`.
  std::optional<std::string> choice(const KeyWords& key, const std::set<std::string>& choices);
  /// A key that must be there, one of `choices`, and decides which other keys the table has: `read`
  /// reads those, called with the word. Keys that are there in any case are asked for before. A
  /// reader that describes calls it with each of `choices`, in their order. Returns false, and has
  /// refused the key with `if_missing` where there is none, if `read` was not called.
  template <typename Choices, typename Read>
  bool select(const KeyWords& key, const Choices& choices, const std::string& if_missing,
              const Read& read) {
    const std::set<std::string> names(choices.begin(), choices.end());
    const std::optional<std::string> word = choice(key, names);
    if (describes()) {
      for (const std::string& each : choices) {
        begin_variant(key, names, each);
        read(each);
      }
      end_variants();
      return true;
    }
    if (!word) {
      refuse_missing(key.name, if_missing);
      return false;
    }
    read(*word);
    return true;
  }
  std::optional<bool> boolean(const KeyWords& key);
  std::optional<std::int64_t> integer(const KeyWords& key, std::int64_t minimum,
                                      std::int64_t maximum);
  /// A finite number in [minimum, maximum]; whole numbers are taken too.
  std::optional<double> number(const KeyWords& key, double minimum, double maximum);
  /// A duration text in [minimum, maximum].
  std::optional<base::SimDuration> duration(const KeyWords& key, base::SimDuration minimum,
                                            base::SimDuration maximum);
  std::optional<std::vector<std::string>> texts(const KeyWords& key);
  /// A list of texts, each one of `choices`.
  std::optional<std::vector<std::string>> choices(const KeyWords& key,
                                                  const std::set<std::string>& choices);
  /// A list of `count` whole numbers in [minimum, maximum].
  std::optional<std::vector<std::int64_t>> integers(const KeyWords& key, std::size_t count,
                                                    std::int64_t minimum, std::int64_t maximum);
  /// The table below `key`.
  std::optional<Reader> section(const KeyWords& key);
  /// The tables of the array of tables below `key`; empty if there is none.
  std::vector<Reader> sections(const KeyWords& key);

  // The same with a target that keeps its value, the default, if the key is not there.
  void text(const KeyWords& key, std::string& target);
  void boolean(const KeyWords& key, bool& target);
  void number(const KeyWords& key, double minimum, double maximum, double& target);
  /// An angle: degrees are written, `target` is in radians.
  void degrees(const KeyWords& key, double minimum, double maximum, double& target);
  void duration(const KeyWords& key, base::SimDuration minimum, base::SimDuration maximum,
                base::SimDuration& target);
  void texts(const KeyWords& key, std::vector<std::string>& target);
  template <typename Integer>
  void integer(const KeyWords& key, std::int64_t minimum, std::int64_t maximum, Integer& target) {
    static_assert(std::is_integral_v<Integer>);
    if (const auto value = integer(key, minimum, maximum)) {
      target = static_cast<Integer>(*value);
    }
    note_default(key, std::to_string(target));
  }
  /// Words and what they stand for.
  template <typename Meaning>
  void choice(const KeyWords& key, const std::map<std::string, Meaning>& words, Meaning& target) {
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
  /// Says that the table needs a key.
  void note_required(const std::string& key);
  /// Says that the table has the keys of another file: TableDescription::kind_of_file.
  void note_kind_of_file(std::string_view kind);
  /// Says what stands for a key that is not there, where no target shows it.
  void note_default(const KeyWords& key, const std::string& written);

  /// The name of a file to be written; empty if it is not there. Where everything is to be known,
  /// it is looked at whether it can be.
  std::string output(const KeyWords& key);
  /// The name, as it is written, of a file to be read, for keys whose files file() cannot read.
  std::optional<std::string> file_name(const KeyWords& key);
  /// What is in the file that `key` names relative to the file this table comes from. `what` is
  /// what people call it, e.g. "EEPROM image".
  std::optional<FileContent> file(const KeyWords& key, std::string_view what);
  /// Where everything is to be known: a server at `address`, which `key` names, must be the only
  /// one there.
  void claim(const std::string& key, const std::string& address);

  /// All keys of the table, for tables whose keys are no fixed names.
  [[nodiscard]] std::vector<std::string> names();

  /// Refuses the keys that no call above asked for, and says which exist.
  void finish();

  /// Something is wrong with `key`, or with the table itself when it has no such key. A second
  /// problem of the same key is dropped, since it follows from the first. Of a table that comes
  /// from no file the problem is the reason alone.
  void refuse(const std::string& key, const std::string& reason);
  /// The same for a key without which the table says little and that is not there.
  void refuse_missing(const std::string& key, const std::string& explanation);
  /// The same for a problem in another file, which `key` names.
  void refuse(const std::string& key, Problem problem);

  [[nodiscard]] bool is_refused(const std::string& key) const { return refused_.contains(key); }
  [[nodiscard]] Problems& problems() const { return reading_->problems; }

 private:
  /// `value`, unless it is none of `choices`, which is refused.
  std::optional<std::string> one_of(const KeyWords& key, std::string value,
                                    const std::set<std::string>& choices);
  std::optional<std::vector<std::string>> texts_of(const KeyWords& key, const Value* node);
  const Value* find(const KeyWords& key, ValueForm form);
  const Value* find(const KeyWords& key, ValueKind kind) { return find(key, ValueForm{kind}); }
  template <typename T>
  [[nodiscard]] bool is(const std::string& key) const {
    const Value* const value = table_->at(key);
    return value != nullptr && value->is<T>();
  }
  void begin_variant(const KeyWords& key, const std::set<std::string>& choices,
                     const std::string& word);
  void end_variants();
  std::optional<std::string> text_of(const KeyWords& key, const Value* node);
  [[nodiscard]] TableDescription* description_below(const KeyWords& key) const;
  [[nodiscard]] KeyDescription& describe(const std::string& key) const;
  [[nodiscard]] Problem problem_at(const std::string& key, const std::string& reason) const;

  const Reading* reading_;
  std::string path_;
  const Value* table_;
  TableDescription* common_;       ///< keys that do not depend on the selector; null: none
  TableDescription* description_;  ///< where further keys are noted
  std::set<std::string> asked_;
  std::set<std::string> refused_;
};

}  // namespace stator::settings
