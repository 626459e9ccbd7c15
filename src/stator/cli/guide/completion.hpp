#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace stator::cli {

/// What a shell can put in place of the word that is being typed.
struct Completion {
  struct Word {
    std::string text;
    std::string meaning{};  ///< a few words for the user, or nothing
  };
  /// What fits beside `words`, which the shell looks up by itself.
  enum class Files : std::uint8_t { none, files, directories };

  std::vector<Word> words{};
  Files files = Files::none;
  std::vector<std::string> endings{};  ///< of the files; empty: any
};

/// What can stand for the last word of `words`, which may be empty; the words before it begin
/// behind the name of the program. It follows from the declarations of the commands below `app`.
[[nodiscard]] Completion complete(CLI::App& app, std::span<const std::string> words);

/// The words of a line as a shell of the Bourne family divides it, quotes and backslashes taken
/// off; the last one is empty behind a blank. Variables and the like stay as they are.
[[nodiscard]] std::vector<std::string> words_of_line(std::string_view line);

}  // namespace stator::cli
