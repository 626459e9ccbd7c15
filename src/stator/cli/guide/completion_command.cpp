// stator completion: the script by which a shell completes command lines of this program, and the
// hidden command "complete" that such a script asks at every press of the tab key.
#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/guide/completion.hpp"
#include "stator/cli/option_words.hpp"

namespace stator::cli {

namespace {

// Each asks the program that is being typed, so that one in a build folder completes by what it can
// itself. The first line of an answer says what the shell looks up: "words", "words nospace",
// "directories" or "files" with the endings of their names; the others are candidates, with a tab
// before what they mean.

constexpr std::string_view kBash =
    R"script(# Completion of stator for bash. Made by "stator completion bash".
_stator() {
  local current=${COMP_WORDS[COMP_CWORD]} kind ending
  local -a answer
  # The program gets the line as typed: bash divides words at "=" and ":" as well.
  mapfile -t answer < <("${1/#\~/$HOME}" complete --breaks "$COMP_WORDBREAKS" \
    --line "${COMP_LINE:0:COMP_POINT}" 2>/dev/null)
  COMPREPLY=()
  [[ $current == [=:] ]] && current=
  read -r -a kind <<<"${answer[0]}"
  case ${kind[0]} in
    files)
      compopt -o filenames
      mapfile -t COMPREPLY < <(
        if ((${#kind[@]} == 1)); then
          compgen -f -- "$current"
        else
          for ending in "${kind[@]:1}"; do compgen -f -X "!*.$ending" -- "$current"; done
          compgen -d -- "$current"
        fi
      )
      ;;
    directories)
      compopt -o filenames
      mapfile -t COMPREPLY < <(compgen -d -- "$current")
      ;;
    words)
      [[ ${kind[1]} == nospace ]] && compopt -o nospace
      COMPREPLY=("${answer[@]:1}")
      COMPREPLY=("${COMPREPLY[@]%%$'\t'*}")
      ;;
  esac
}
complete -F _stator stator
)script";

constexpr std::string_view kZsh = R"script(#compdef stator
# Completion of stator for zsh. Made by "stator completion zsh".
_stator() {
  local -a answer kind candidates
  local line
  answer=("${(@f)$(${~words[1]} complete \
    --line "${(j: :)words[1,CURRENT-1]} $PREFIX" 2>/dev/null)}")
  kind=(${(s: :)answer[1]})
  case $kind[1] in
    files)
      if (( $#kind > 1 )); then
        _files -g "*.(${(j:|:)kind[2,-1]})"
      else
        _files
      fi
      ;;
    directories) _files -/ ;;
    words)
      for line in "${(@)answer[2,-1]}"; do
        if [[ $line == *$'\t'* ]]; then
          candidates+=("${${line%%$'\t'*}//:/\\:}:${line#*$'\t'}")
        else
          candidates+=("${line//:/\\:}")
        fi
      done
      if [[ $kind[2] == nospace ]]; then
        _describe stator candidates -S ''
      else
        _describe stator candidates
      fi
      ;;
  esac
}
if [[ $funcstack[1] == _stator ]]; then
  _stator "$@"
else
  compdef _stator stator
fi
)script";

constexpr std::string_view kFish =
    R"script(# Completion of stator for fish. Made by "stator completion fish".
function __stator_complete
    set -l program (string replace -r '^~' $HOME -- (commandline -opc)[1])
    set -l answer ($program complete --line (commandline -cp | string collect) 2>/dev/null)
    set -l kind (string split ' ' -- $answer[1])
    switch "$kind[1]"
        case files
            if test (count $kind) -gt 1
                for ending in $kind[2..-1]
                    __fish_complete_suffix .$ending
                end
            else
                __fish_complete_path (commandline -ct)
            end
        case directories
            __fish_complete_directories (commandline -ct)
        case words
            printf '%s\n' $answer[2..-1]
    end
end
complete -c stator -f -a '(__stator_complete)'
)script";

/// bash puts a candidate in place of what is behind the last of `breaks` in the word.
std::size_t replaced_from(std::string_view word, std::string_view breaks) {
  const std::size_t last = word.find_last_of(breaks);
  return last == std::string_view::npos ? 0 : last + 1;
}

/// A word that only begins something: its value comes next.
bool is_beginning(const Completion::Word& word) {
  return word.text.ends_with('=') || word.text.ends_with(':');
}

struct CompleteOptions {
  std::string line;
  std::string breaks;
};

void answer(CLI::App& app, const CompleteOptions& options) {
  const std::vector<std::string> words = words_of_line(options.line);
  const Completion completion = complete(app, std::span(words).subspan(words.empty() ? 0 : 1));
  switch (completion.files) {
    case Completion::Files::files:
      fmt::print("files{}{}\n", completion.endings.empty() ? "" : " ",
                 fmt::join(completion.endings, " "));
      return;
    case Completion::Files::directories:
      fmt::print("directories\n");
      return;
    case Completion::Files::none:
      break;
  }
  const bool open = std::ranges::any_of(completion.words, is_beginning);
  fmt::print("words{}\n", open ? " nospace" : "");
  for (const Completion::Word& word : completion.words) {
    const std::string text = word.text.substr(replaced_from(words.back(), options.breaks));
    fmt::print("{}{}{}\n", text, word.meaning.empty() ? "" : "\t", word.meaning);
  }
}

}  // namespace

void add_completion_command(CLI::App& app) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "completion", "Print the script by which a shell completes command lines of stator");
  command->add_option("shell", *shell, "bash, zsh or fish")
      ->required()
      ->check(one_of({"bash", "zsh", "fish"}));
  command->footer(
      "Once for all of one's shells, unless stator was installed with its completions:\n"
      "  stator completion bash > ~/.local/share/bash-completion/completions/stator\n"
      "  stator completion fish > ~/.config/fish/completions/stator.fish\n"
      "  stator completion zsh > \"${fpath[1]}/_stator\"\n"
      "In the bash that is open:\n"
      "  source <(stator completion bash)");
  command->callback([shell] {
    fmt::print("{}", *shell == "bash" ? kBash : *shell == "zsh" ? kZsh : kFish);
  });

  auto options = std::make_shared<CompleteOptions>();
  CLI::App* hidden = app.add_subcommand("complete", "What fits at the end of a command line");
  hidden->group("");
  hidden->add_option("--line", options->line, "The line up to the cursor")->required();
  hidden->add_option("--breaks", options->breaks, "Where the shell divides words");
  hidden->callback([&app, options] { answer(app, *options); });
}

}  // namespace stator::cli
