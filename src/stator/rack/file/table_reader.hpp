#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stator/rack/file/rack_file_error.hpp"
#include "stator/settings/reader.hpp"

namespace stator::rack {

/// Reads a table whose keys depend on other tables of the rack. If what the table refers to does
/// not exist, reading of the table ends.
class TableReader : public settings::Reader {
 public:
  using Reader::Reader;
  explicit TableReader(Reader reader) : Reader(std::move(reader)) {}

  std::optional<TableReader> section(const settings::KeyWords& key) {
    auto below = Reader::section(key);
    return below ? std::optional(TableReader(std::move(*below))) : std::nullopt;
  }
  std::vector<TableReader> sections(const settings::KeyWords& key) {
    std::vector<TableReader> all;
    for (Reader& each : Reader::sections(key)) {
      all.emplace_back(std::move(each));
    }
    return all;
  }

  /// Something is wrong with `key`, without which reading cannot go on: to the end of attempt().
  [[noreturn]] void fail(const std::string& key, const std::string& reason) {
    refuse(key, reason);
    throw Abandoned();
  }
  /// As fail(), for a required key that is missing.
  [[noreturn]] void missing(const std::string& key, const std::string& explanation) {
    refuse_missing(key, explanation);
    throw Abandoned();
  }
  /// As fail(), for a `key` that names a device that does not exist.
  [[noreturn]] void fail_for_reference(const std::string& key, const std::string& reason) {
    if (!problems().devices_missing) {
      refuse(key, reason);
    }
    throw Abandoned();
  }
  /// Ends reading; what is wrong has been told.
  [[noreturn]] static void abandon() { throw Abandoned(); }

  /// Calls `read`; fail() and the like inside it end only this call. Returns whether `read` came to
  /// its end.
  template <typename Function>
  bool attempt(const Function& read) {
    try {
      read();
      return true;
    } catch (const Abandoned&) {
      return false;
    } catch (const RackFileError& error) {  // of another rack file, which this one names
      problems().list.push_back(error.problem());
      return false;
    }
  }

 private:
  struct Abandoned {};
};

}  // namespace stator::rack
