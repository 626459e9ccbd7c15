#include "stator/cli/terminal.hpp"

#include <algorithm>
#include <clocale>
#include <cstdio>

#include <poll.h>
#include <unistd.h>
// ncurses defines macros with the names of common functions; it comes last.
#define NCURSES_NOMACROS
#include <curses.h>

#include "stator/cli/colours.hpp"
#include "stator/cli/failure.hpp"

namespace stator::cli {

namespace {

constexpr int kEscapeDelay = 25;  // ms in which the rest of a key's sequence comes

constexpr short kRed = 1;
constexpr short kYellow = 2;
constexpr short kGreen = 3;

attr_t attributes_of(TextStyle style) {
  const auto colour = [](short pair) {
    return ::has_colors() && wants_colours(stdout) ? static_cast<attr_t>(COLOR_PAIR(pair))
                                                   : attr_t{A_NORMAL};
  };
  switch (style) {
    case TextStyle::bold:
      return A_BOLD;
    case TextStyle::dim:
      return A_DIM;
    case TextStyle::reverse:
      return A_REVERSE;
    case TextStyle::red:
      return colour(kRed);
    case TextStyle::yellow:
      return colour(kYellow);
    case TextStyle::green:
      return colour(kGreen);
    case TextStyle::plain:
      break;
  }
  return A_NORMAL;
}

}  // namespace

Terminal::Terminal(ControlC control_c) {
  if (::isatty(STDIN_FILENO) != 1 || ::isatty(STDOUT_FILENO) != 1) {
    throw Failure("this is no terminal; start it where you can type");
  }
  static_cast<void>(std::setlocale(LC_CTYPE, ""));  // NOLINT(concurrency-mt-unsafe)
  screen_ = ::newterm(nullptr, stdout, stdin);
  if (screen_ == nullptr) {
    throw Failure("this terminal is not known; set TERM to what it is, e.g. TERM=xterm");
  }
  if (control_c == ControlC::key) {
    ::raw();
  } else {
    ::cbreak();
  }
  ::noecho();
  ::keypad(stdscr, TRUE);
  ::set_escdelay(kEscapeDelay);
  if (::has_colors()) {
    ::start_color();
    ::use_default_colors();
    ::init_pair(kRed, COLOR_RED, -1);
    ::init_pair(kYellow, COLOR_YELLOW, -1);
    ::init_pair(kGreen, COLOR_GREEN, -1);
  }
}

Terminal::~Terminal() {
  ::endwin();
  ::delscreen(static_cast<SCREEN*>(screen_));
}

std::size_t Terminal::rows() {
  return static_cast<std::size_t>(std::max(LINES, 0));
}

std::size_t Terminal::columns() {
  return static_cast<std::size_t>(std::max(COLS, 0));
}

void Terminal::show(const std::vector<StyledLine>& lines) {
  ::curs_set(0);
  ::erase();
  for (std::size_t row = 0; row < std::min(lines.size(), rows()); ++row) {
    const attr_t attributes = attributes_of(lines[row].style);
    ::attr_on(attributes, nullptr);
    ::mvaddstr(static_cast<int>(row), 0, lines[row].text.c_str());
    ::attr_off(attributes, nullptr);
  }
  ::refresh();
}

void Terminal::print(int row, int column, int width, std::string_view text, TextStyle style) {
  if (row < 0 || row >= LINES || width <= 0) {
    return;
  }
  std::string cut(text.substr(0, static_cast<std::size_t>(width)));
  std::ranges::replace(cut, '\t', ' ');
  cut.resize(static_cast<std::size_t>(width), ' ');
  const attr_t attributes = attributes_of(style);
  ::attr_on(attributes, nullptr);
  ::mvaddnstr(row, column, cut.c_str(), width);
  ::attr_off(attributes, nullptr);
}

std::optional<Terminal::Typed> Terminal::typed(std::chrono::milliseconds patience) {
  ::timeout(static_cast<int>(std::max<std::int64_t>(patience.count(), 0)));
  const int key = ::getch();
  switch (key) {
    case ERR:
    case KEY_RESIZE:
      return std::nullopt;
    case KEY_UP:
      return Typed{.character = {}, .key = Key::up};
    case KEY_DOWN:
      return Typed{.character = {}, .key = Key::down};
    case KEY_PPAGE:
      return Typed{.character = {}, .key = Key::page_up};
    case KEY_NPAGE:
      return Typed{.character = {}, .key = Key::page_down};
    case KEY_HOME:
      return Typed{.character = {}, .key = Key::home};
    case KEY_END:
      return Typed{.character = {}, .key = Key::end};
    case KEY_ENTER:
      return Typed{.character = '\n'};
    case KEY_BACKSPACE:
      return Typed{.character = '\b'};
    default:
      return key < 256 ? Typed{.character = static_cast<char>(key)} : Typed{};
  }
}

bool Terminal::gone() {
  pollfd input{STDIN_FILENO, 0, 0};
  return ::poll(&input, 1, 0) > 0 && (input.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

}  // namespace stator::cli
