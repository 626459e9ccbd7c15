#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#define TOML_HEADER_ONLY 0
#include <toml++/toml.h>

#include "base/sim_time.hpp"
#include "rack/rack_file_error.hpp"

namespace stator::rack {

/// Reads one table of a rack file key by key and remembers which keys exist, so that finish() can
/// reject those nobody asked for. All functions throw RackFileError with the key's place in the
/// file.
class TomlSection {
 public:
  /// `path` is how people name the table, e.g. "[[segment.device]] number 2".
  TomlSection(std::string file, std::string path, const toml::table& table)
      : file_(std::move(file)), path_(std::move(path)), table_(&table) {}

  [[nodiscard]] const std::string& path() const { return path_; }
  /// The rack file, as it was named.
  [[nodiscard]] const std::string& file() const { return file_; }

  std::optional<std::string> text(const std::string& key);
  /// Whether `key` is there and is a text, for keys that take a text or something else.
  [[nodiscard]] bool is_text(const std::string& key) const;
  /// The same for keys that take a truth value or something else.
  [[nodiscard]] bool is_boolean(const std::string& key) const;
  /// A text that must be one of `choices`.
  std::optional<std::string> choice(const std::string& key, const std::set<std::string>& choices);
  std::optional<bool> boolean(const std::string& key);
  std::optional<std::int64_t> integer(const std::string& key, std::int64_t minimum,
                                      std::int64_t maximum);
  /// A finite number in [minimum, maximum]; whole numbers are taken too.
  std::optional<double> number(const std::string& key, double minimum, double maximum);
  /// A duration text in [minimum, maximum].
  std::optional<base::SimDuration> duration(const std::string& key, base::SimDuration minimum,
                                            base::SimDuration maximum);
  std::optional<std::vector<std::string>> texts(const std::string& key);
  /// A list of `count` whole numbers in [minimum, maximum].
  std::optional<std::vector<std::int64_t>> integers(const std::string& key, std::size_t count,
                                                    std::int64_t minimum, std::int64_t maximum);
  /// The table below `key`.
  std::optional<TomlSection> section(const std::string& key);
  /// The tables of the array of tables below `key`; empty if there is none.
  std::vector<TomlSection> sections(const std::string& key);

  /// All keys of the table, for tables whose keys are no fixed names.
  [[nodiscard]] std::vector<std::string> keys() const;

  /// Throws for the first key that no call above asked for, and says which exist.
  void finish() const;

  /// Throws an error at `key`, or at the table itself when it has no such key. Of a table that comes
  /// from no file the error is the reason alone.
  [[noreturn]] void fail(const std::string& key, const std::string& reason) const;

 private:
  const toml::node* find(const std::string& key);

  std::string file_;
  std::string path_;
  const toml::table* table_;
  std::set<std::string> asked_;
};

}  // namespace stator::rack
