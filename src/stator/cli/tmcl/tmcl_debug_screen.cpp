#include "stator/cli/tmcl/tmcl_debug_screen.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <string_view>
#include <utility>

#include <fmt/format.h>
// ncurses defines macros with the names of common functions; it comes last.
#define NCURSES_NOMACROS
#include <curses.h>

#include "stator/cli/terminal.hpp"
#include "stator/tmcl_tools/tmcl_trace.hpp"
#include "stator/tmcl_tools/words.hpp"

namespace stator::cli {

namespace {

constexpr int kPanelWidth = 36;
constexpr std::size_t kKeptLines = 2000;
constexpr std::chrono::milliseconds kRedrawPeriod{100};

constexpr int kControlD = 4;
constexpr int kControlL = 12;
constexpr int kControlN = 14;
constexpr int kControlP = 16;
constexpr int kControlU = 21;
constexpr int kDelete = 127;

/// What is typed, with a cursor and a history.
class InputLine {
 public:
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] std::size_t cursor() const { return cursor_; }

  void insert(std::string_view text) {
    text_.insert(cursor_, text);
    cursor_ += text.size();
  }
  void erase_before() {
    if (cursor_ > 0) {
      text_.erase(--cursor_, 1);
    }
  }
  void erase_here() {
    if (cursor_ < text_.size()) {
      text_.erase(cursor_, 1);
    }
  }
  void move(int columns) {
    const auto place = static_cast<std::ptrdiff_t>(cursor_) + columns;
    cursor_ = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(place, 0, static_cast<std::ptrdiff_t>(text_.size())));
  }
  void move_to_begin() { cursor_ = 0; }
  void move_to_end() { cursor_ = text_.size(); }
  void clear() {
    text_.clear();
    cursor_ = 0;
  }
  /// The line, which goes into the history.
  std::string take() {
    if (!text_.empty()) {
      history_.push_back(text_);
    }
    recalled_ = history_.size();
    cursor_ = 0;
    return std::exchange(text_, {});
  }
  void recall(bool older) {
    if (older && recalled_ > 0) {
      --recalled_;
    } else if (!older && recalled_ < history_.size()) {
      ++recalled_;
    }
    text_ = recalled_ < history_.size() ? history_[recalled_] : std::string();
    cursor_ = text_.size();
  }

 private:
  std::string text_;
  std::size_t cursor_ = 0;
  std::vector<std::string> history_;
  std::size_t recalled_ = 0;
};

class DebugScreen {
 public:
  DebugScreen(tmcl_tools::TmclDebugger& debugger, tmcl_tools::TmclDebugConsole& console,
              const DebugScreenOptions& options)
      : debugger_(debugger), console_(console), options_(options) {
    debugger_.set_interruption([this] { return look_while_running(); });
  }

  void run() {
    show_current_line();
    write(console_.current_line());
    for (const std::string& command : options_.commands) {
      obey(command);
    }
    while (!ended_) {
      draw();
      handle(::getch());
    }
  }

 private:
  void obey(const std::string& line) {
    write("(stator) " + line + "\n");
    running_ = true;
    // Ctrl-C that was pressed before means nothing now.
    static_cast<void>(options_.interruption->taken());
    const tmcl_tools::DebugResponse response = console_.execute(line);
    running_ = false;
    write(options_.take_events());
    write(response.text);
    ended_ = response.quit;
    show_current_line();
  }

  void write(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      output_.emplace_back(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    while (output_.size() > kKeptLines) {
      output_.pop_front();
    }
  }

  [[nodiscard]] bool look_while_running() {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_draw_ >= kRedrawPeriod) {
      last_draw_ = now;
      show_current_line();
      draw();
    }
    return options_.interruption->taken();
  }

  void handle(int key) {
    switch (key) {
      case ERR:  // standard input is at its end
        ended_ = true;
        break;
      case '\n':
      case '\r':
      case KEY_ENTER:
        obey(input_.take());
        break;
      case KEY_BACKSPACE:
      case '\b':
      case kDelete:
        input_.erase_before();
        break;
      case KEY_DC:
        input_.erase_here();
        break;
      case KEY_LEFT:
        input_.move(-1);
        break;
      case KEY_RIGHT:
        input_.move(1);
        break;
      case KEY_HOME:
        input_.move_to_begin();
        break;
      case KEY_END:
        input_.move_to_end();
        break;
      case KEY_UP:
        scroll(-1);
        break;
      case KEY_DOWN:
        scroll(1);
        break;
      case KEY_PPAGE:
        scroll(-(text_rows() - 1));
        break;
      case KEY_NPAGE:
        scroll(text_rows() - 1);
        break;
      case kControlP:
        input_.recall(true);
        break;
      case kControlN:
        input_.recall(false);
        break;
      case kControlU:
        input_.clear();
        break;
      case kControlL:
        ::clearok(stdscr, TRUE);
        break;
      case kControlD:
        ended_ = input_.text().empty();
        break;
      case '\t':
        complete();
        break;
      default:
        if (key >= ' ' && key < kDelete) {
          input_.insert(std::string(1, static_cast<char>(key)));
        }
        break;
    }
  }

  void complete() {
    const std::string before = input_.text().substr(0, input_.cursor());
    const std::size_t space = before.find_last_of(" =,(");
    const std::size_t begin = space == std::string::npos ? 0 : space + 1;
    const std::string word = before.substr(begin);
    const auto words = console_.completions(before.substr(0, begin), word);
    if (words.size() == 1) {
      for (std::size_t i = 0; i < word.size(); ++i) {
        input_.erase_before();
      }
      input_.insert(words.front() + " ");
    } else if (!words.empty()) {
      write(fmt::format("{}\n", fmt::join(words, "  ")));
    }
  }

  [[nodiscard]] static int text_rows() { return std::max(3, LINES * 3 / 5 - 1); }

  void scroll(int lines) {
    const int last = static_cast<int>(debugger_.source().lines().size());
    first_line_ = std::clamp(first_line_ + lines, 1, std::max(1, last));
  }

  void show_current_line() {
    const auto line = debugger_.source().line_of(debugger_.address());
    if (!line) {
      return;
    }
    const int current = static_cast<int>(*line);
    if (current < first_line_ + 1 || current > first_line_ + text_rows() - 2) {
      first_line_ = std::max(1, current - text_rows() / 2);
    }
  }

  void draw() {
    ::erase();
    draw_text();
    draw_panel();
    draw_status();
    draw_console();
    ::refresh();
  }

  void draw_text() {
    const tmcl_tools::TmclSource& source = debugger_.source();
    const int width = COLS - kPanelWidth - 1;
    for (int row = 0; row < text_rows(); ++row) {
      const auto line = static_cast<std::size_t>(first_line_) + static_cast<std::size_t>(row);
      if (line > source.lines().size()) {
        Terminal::print(row, 0, width, "~", TextStyle::dim);
        continue;
      }
      const auto address = source.address_of_line(line);
      const bool code = address && source.line_of(*address) == line;
      const bool current = code && *address == debugger_.address();
      const bool stops = code && debugger_.has_breakpoint(*address);
      Terminal::print(row, 0, width,
                      fmt::format("{}{}{:>4}  {}", stops ? "B" : " ", current ? ">" : " ", line,
                                  source.lines()[line - 1]),
                      current ? TextStyle::reverse
                      : stops ? TextStyle::bold
                              : TextStyle::plain);
    }
  }

  void draw_panel() {
    const int column = COLS - kPanelWidth;
    int row = 0;
    const auto say = [&](std::string_view text, TextStyle style = TextStyle::plain) {
      if (row < text_rows()) {
        ::mvaddch(row, column - 1, ACS_VLINE);
        Terminal::print(row++, column, kPanelWidth, text, style);
      }
    };
    const tmcl::FirmwareState& state = debugger_.bench().firmware().state();
    say(" Registers", TextStyle::bold);
    say(fmt::format("  accu  {:>12}", state.registers.accumulator));
    say(fmt::format("  x     {:>12}", state.registers.x));
    say(fmt::format("  pc    {:>12}  depth {}", state.program_counter, debugger_.depth()));
    say(fmt::format("  flags {}", tmcl_tools::flags_text(state.registers)));
    say(" Motion", TextStyle::bold);
    for (const product::Signal& signal : debugger_.bench().device().signals()) {
      say(fmt::format("  {:18.18} {:>13.7g}", short_name(signal.name), signal.read()));
    }
    while (row < text_rows()) {
      say("");
    }
  }

  /// Without the name of the axis, there being one.
  static std::string_view short_name(std::string_view name) {
    constexpr std::string_view kAxis = "axis0.";
    return name.starts_with(kAxis) ? name.substr(kAxis.size()) : name;
  }

  void draw_status() {
    const tmcl_tools::TmclBench& bench = debugger_.bench();
    const auto line = debugger_.source().line_of(debugger_.address());
    Terminal::print(text_rows(), 0, COLS,
                    fmt::format(" {}  {}  L{}  PC {}  {} s  {}",
                                tmcl_tools::file_name(debugger_.source().file()),
                                debugger_.source().place_of(debugger_.address()),
                                line ? std::to_string(*line) : "??", debugger_.address(),
                                tmcl_tools::seconds_text(bench.now()),
                                running_           ? "running, Ctrl-C holds it"
                                : !bench.running() ? "stopped"
                                : bench.firmware().interpreter().waiting() ? "held, in a WAIT"
                                                                           : "held"),
                    TextStyle::reverse);
  }

  void draw_console() {
    const int top = text_rows() + 1;
    const int rows = LINES - top - 1;
    const std::size_t shown = std::min(output_.size(), static_cast<std::size_t>(std::max(0, rows)));
    for (std::size_t i = 0; i < shown; ++i) {
      Terminal::print(top + static_cast<int>(i), 0, COLS, output_[output_.size() - shown + i]);
    }
    const int row = top + static_cast<int>(shown);
    constexpr std::string_view kPrompt = "(stator) ";
    Terminal::print(row, 0, COLS, running_ ? std::string() : std::string(kPrompt) + input_.text());
    ::move(row, static_cast<int>(kPrompt.size() + input_.cursor()));
  }

  tmcl_tools::TmclDebugger& debugger_;
  tmcl_tools::TmclDebugConsole& console_;
  const DebugScreenOptions& options_;
  InputLine input_;
  std::deque<std::string> output_;
  int first_line_ = 1;
  bool running_ = false;
  bool ended_ = false;
  std::chrono::steady_clock::time_point last_draw_;
};

}  // namespace

void run_debug_screen(tmcl_tools::TmclDebugger& debugger, tmcl_tools::TmclDebugConsole& console,
                      const DebugScreenOptions& options) {
  const Terminal terminal(Terminal::ControlC::signal);
  DebugScreen(debugger, console, options).run();
}

}  // namespace stator::cli
