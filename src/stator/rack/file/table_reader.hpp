#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stator/rack/file/rack_file_error.hpp"
#include "stator/settings/reader.hpp"

namespace stator::rack {

/// Reads a table whose keys depend on what is read elsewhere in the rack: where such a thing is not
/// there, the table says nothing, and reading of it ends.
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
  /// The same for a key without which the table says nothing and that is not there.
  [[noreturn]] void missing(const std::string& key, const std::string& explanation) {
    refuse_missing(key, explanation);
    throw Abandoned();
  }
  /// The same for a device that `key` names and that is not there.
  [[noreturn]] void fail_for_reference(const std::string& key, const std::string& reason) {
    if (!problems().devices_missing) {
      refuse(key, reason);
    }
    throw Abandoned();
  }
  /// Ends reading; what is wrong has been told.
  [[noreturn]] static void abandon() { throw Abandoned(); }

  /// Calls `read`, which a failure ends no more of than this call. Returns whether it came to its
  /// end.
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
