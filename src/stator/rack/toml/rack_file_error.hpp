#pragma once

#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace stator::rack {

/// What is wrong with a rack file or a file it names: "FILE:LINE:COLUMN: reason; remedy".
class RackFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// `line` and `column` count from 1; `key` is empty for a table or a whole file. `reason` ends in
  /// the remedy.
  RackFileError(const std::string& file, std::uint32_t line, std::uint32_t column, std::string key,
                const std::string& reason)
      : std::runtime_error(file + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " +
                           reason),
        file_(file),
        line_(line),
        column_(column),
        key_(std::move(key)),
        reason_(reason) {}

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::uint32_t line() const { return line_; }  ///< 0: no place in a file
  [[nodiscard]] std::uint32_t column() const { return column_; }
  [[nodiscard]] const std::string& key() const { return key_; }
  /// The message without its place.
  [[nodiscard]] std::string reason() const { return line_ == 0 ? std::string(what()) : reason_; }

 private:
  std::string file_;
  std::uint32_t line_ = 0;
  std::uint32_t column_ = 0;
  std::string key_;
  std::string reason_;
};

/// All that is wrong, for those who want to know everything at once.
struct RackFileErrors {
  std::vector<RackFileError> list;
  /// A device's table does not say what it is: what refers to a device that is not there may refer
  /// to this one, and is no error of its own.
  bool devices_missing = false;
  std::set<std::string> servers;  ///< paths and ports that something in the rack listens at
};

}  // namespace stator::rack
