#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stator::cli {

/// Lines a person types, with history, editing and completion by the tab key; or those of a pipe or
/// file on standard input, without prompt. One at a time exists.
class LineReader {
 public:
  /// The words that may stand in place of `word`, which stands behind `before`.
  using Completer =
      std::function<std::vector<std::string>(std::string_view before, std::string_view word)>;

  explicit LineReader(std::string prompt, Completer completer = {});
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;
  ~LineReader();

  /// Standard input and output are a terminal.
  [[nodiscard]] bool interactive() const { return interactive_; }
  /// The next line; none at the end of the input.
  [[nodiscard]] std::optional<std::string> read();

 private:
  std::string prompt_;
  Completer completer_;
  bool interactive_;
};

}  // namespace stator::cli
