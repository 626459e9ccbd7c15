#include "stator/cli/tmcl/line_reader.hpp"

#include <cstdlib>
#include <cstring>
#include <iostream>
#include <memory>
#include <utility>

#include <editline/readline.h>
#include <unistd.h>

namespace stator::cli {

namespace {

/// What separates words for completion.
constexpr const char* kWordBreaks = " \t\n,=()+*/<>!";

/// The library calls back without an argument for the completer, hence this global.
const LineReader::Completer* active_completer = nullptr;  // NOLINT: the library's interface

/// All candidates, the first of the list being what they have in common; the library frees them.
char** complete(const char* word, int start, int /*end*/) {
  rl_attempted_completion_over = 1;
  if (active_completer == nullptr || !*active_completer) {
    return nullptr;
  }
  const std::vector<std::string> words =
      (*active_completer)(std::string_view(rl_line_buffer, static_cast<std::size_t>(start)), word);
  if (words.empty()) {
    return nullptr;
  }
  std::size_t common = words.front().size();
  for (const std::string& each : words) {
    std::size_t same = 0;
    while (same < common && same < each.size() && each[same] == words.front()[same]) {
      ++same;
    }
    common = same;
  }
  // malloc and strdup: the library frees what it gets.
  auto** list = static_cast<char**>(std::calloc(words.size() + 2, sizeof(char*)));  // NOLINT
  list[0] = ::strdup(words.front().substr(0, common).c_str());
  for (std::size_t i = 0; i < words.size(); ++i) {
    list[i + 1] = ::strdup(words[i].c_str());
  }
  if (words.size() == 1) {
    std::free(list[1]);  // NOLINT
    list[1] = nullptr;
  }
  return list;
}

}  // namespace

LineReader::LineReader(std::string prompt, Completer completer)
    : prompt_(std::move(prompt)),
      completer_(std::move(completer)),
      interactive_(::isatty(STDIN_FILENO) != 0 && ::isatty(STDOUT_FILENO) != 0) {
  if (interactive_) {
    ::using_history();
    active_completer = &completer_;
    rl_attempted_completion_function = complete;
    rl_completer_word_break_characters = const_cast<char*>(kWordBreaks);  // NOLINT
    rl_basic_word_break_characters = kWordBreaks;
  }
}

LineReader::~LineReader() {
  if (interactive_) {
    active_completer = nullptr;
  }
}

std::optional<std::string> LineReader::read() {
  if (!interactive_) {
    std::string line;
    return std::getline(std::cin, line) ? std::optional(line) : std::nullopt;
  }
  struct Free {
    void operator()(char* text) const { std::free(text); }  // NOLINT: the library's malloc
  };
  const std::unique_ptr<char, Free> line(::readline(prompt_.c_str()));
  if (line == nullptr) {
    std::cout << '\n';
    return std::nullopt;
  }
  if (*line != '\0') {
    ::add_history(line.get());
  }
  return std::string(line.get());
}

}  // namespace stator::cli
