#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace stator::settings {

/// What is wrong with a configuration: "FILE:LINE:COLUMN: reason; remedy".
class Problem {
 public:
  /// One without a place.
  explicit Problem(std::string text) : text_(std::move(text)) {}
  /// `line` and `column` count from 1, line 0: the whole file; `key` is empty for a table or a
  /// whole file. `reason` ends in the remedy.
  Problem(std::string file, std::uint32_t line, std::uint32_t column, std::string key,
          std::string reason);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::uint32_t line() const { return line_; }  ///< 0: no place in a file
  [[nodiscard]] std::uint32_t column() const { return column_; }
  [[nodiscard]] const std::string& key() const { return key_; }
  /// The message with its place.
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const char* what() const { return text_.c_str(); }
  /// The message without its place.
  [[nodiscard]] const std::string& reason() const { return line_ == 0 ? text_ : reason_; }

 private:
  std::string file_;
  std::uint32_t line_ = 0;
  std::uint32_t column_ = 0;
  std::string key_;
  std::string reason_;
  std::string text_;
};

/// All that is wrong with one configuration, in the order in which it was found.
struct Problems {
  std::vector<Problem> list;
  /// The configuration is only checked, not run: whether files can be written is checked as well,
  /// and all problems of files that it names are listed.
  bool everything = false;
  /// A device's table does not say what it is: what refers to a device that is not there may refer
  /// to this one, and is no problem of its own.
  bool devices_missing = false;
  std::set<std::string> servers;  ///< paths and ports that something in the rack listens at
};

}  // namespace stator::settings
