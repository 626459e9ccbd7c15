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
/// file; of a section that collects errors, only fail() does, and the others go on as if the key
/// were not there.
class TomlSection {
 public:
  /// `path` is how people name the table, e.g. "[[segment.device]] number 2". With `errors` they
  /// are collected there, also those of the tables below; it must outlive the section.
  TomlSection(std::string file, std::string path, const toml::table& table,
              RackFileErrors* errors = nullptr)
      : file_(std::move(file)), path_(std::move(path)), table_(&table), errors_(errors) {}

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

  /// The name of a file to be written; empty if it is not there. Where errors are collected, its
  /// directory is looked at.
  std::string output(const std::string& key);
  /// Where errors are collected: a server at `address`, which `key` names, must be the only one
  /// there.
  void claim(const std::string& key, const std::string& address);

  /// All keys of the table, for tables whose keys are no fixed names.
  [[nodiscard]] std::vector<std::string> keys() const;

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
  /// The same for a device that `key` names and that is not there.
  [[noreturn]] void fail_for_reference(const std::string& key, const std::string& reason);
  /// Something is wrong with `key`, but reading can go on: collected if errors are collected, else
  /// thrown. A second error of the same key is dropped, since it follows from the first.
  void refuse(const std::string& key, const std::string& reason);
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
  const toml::node* find(const std::string& key);
  [[nodiscard]] RackFileError error_at(const std::string& key, const std::string& reason) const;
  void collect(const RackFileError& error);

  std::string file_;
  std::string path_;
  const toml::table* table_;
  RackFileErrors* errors_;
  std::set<std::string> asked_;
  std::set<std::string> refused_;
};

}  // namespace stator::rack
