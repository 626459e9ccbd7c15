// stator top: a rack that runs elsewhere on a screen of the terminal, renewed several times a
// second.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "stator/cli/client/http_client.hpp"
#include "stator/cli/client/rack_overview.hpp"
#include "stator/cli/client/top_screen.hpp"
#include "stator/cli/colours.hpp"
#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/terminal.hpp"

namespace stator::cli {

namespace {

using std::chrono::steady_clock;

struct TopOptions {
  std::string http = "127.0.0.1:8080";
  std::string token_file;
  double rate = 4.0;
  bool once = false;
};

volatile std::sig_atomic_t g_ended = 0;  // NOLINT(*-avoid-non-const-global-variables): of a signal

void end(int /*signal*/) {
  g_ended = 1;
}

constexpr char kEscape = '\x1b';
constexpr char kControlC = '\x03';
constexpr char kBackspace = '\x7f';

/// What the keys do to the view; returns false to end.
class Keys {
 public:
  explicit Keys(TopView& view) : view_(view) {}

  [[nodiscard]] bool take(const Terminal::Typed& typed, std::size_t table_lines) {
    if (view_.help) {
      view_.help = false;
      const char key = typed.character.value_or('\0');
      return key != 'q' && key != kControlC;
    }
    if (!typed.character) {
      scroll(typed.key, std::max<std::size_t>(view_.rows / 2, 1), table_lines);
      return true;
    }
    return view_.typing ? type(*typed.character) : press(*typed.character, table_lines);
  }

 private:
  void scroll(Terminal::Key key, std::size_t page, std::size_t table_lines) {
    switch (key) {
      case Terminal::Key::up:
        up(1);
        break;
      case Terminal::Key::down:
        down(1, table_lines);
        break;
      case Terminal::Key::page_up:
        up(page);
        break;
      case Terminal::Key::page_down:
        down(page, table_lines);
        break;
      case Terminal::Key::home:
        view_.first = 0;
        break;
      case Terminal::Key::end:
        down(table_lines, table_lines);
        break;
      case Terminal::Key::other:
        break;
    }
  }
  void up(std::size_t lines) { view_.first -= std::min(view_.first, lines); }
  void down(std::size_t lines, std::size_t table_lines) {
    view_.first = std::min(view_.first + lines, table_lines == 0 ? 0 : table_lines - 1);
  }
  [[nodiscard]] bool press(char key, std::size_t table_lines) {
    switch (key) {
      case 'q':
      case kControlC:
        return false;
      case 'p':
        view_.paused = !view_.paused;
        break;
      case '?':
      case 'h':
        view_.help = true;
        break;
      case '/':
        view_.typing = true;
        view_.filter.clear();
        break;
      case 'k':
        up(1);
        break;
      case 'j':
        down(1, table_lines);
        break;
      case kEscape:
        view_.filter.clear();
        break;
      default:
        break;
    }
    return true;
  }
  [[nodiscard]] bool type(char key) {
    view_.first = 0;
    if (key == kControlC) {
      return false;
    }
    if (key == '\r' || key == '\n') {
      view_.typing = false;
    } else if (key == kEscape) {
      view_.typing = false;
      view_.filter.clear();
    } else if (key == kBackspace || key == '\b') {
      if (!view_.filter.empty()) {
        view_.filter.pop_back();
      }
    } else if (static_cast<unsigned char>(key) >= 0x20U) {
      view_.filter += key;
    }
    return true;
  }

  TopView& view_;
};

/// Ends the program as q does.
void listen_to_signals() {
  struct sigaction action {};
  action.sa_handler = end;
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGHUP, &action, nullptr);
}

void watch(RackObserver& observer, const TopOptions& options) {
  RackOverview overview = observer.look();
  if (::isatty(STDIN_FILENO) != 1 || ::isatty(STDOUT_FILENO) != 1) {
    throw Failure("this is no terminal; --once prints a single frame");
  }
  const Terminal terminal(Terminal::ControlC::key);
  listen_to_signals();
  TopView view;
  Keys keys(view);
  const auto period = std::chrono::duration_cast<steady_clock::duration>(
      std::chrono::duration<double>(1 / options.rate));
  steady_clock::time_point next = steady_clock::now();
  while (g_ended == 0 && !Terminal::gone()) {
    if (steady_clock::now() >= next) {
      if (!view.paused) {
        overview = observer.look();
      }
      next = steady_clock::now() + period;
    }
    view.columns = Terminal::columns();
    view.rows = Terminal::rows();
    Terminal::show(top_frame(overview, view));
    const auto typed = Terminal::typed(
        std::chrono::duration_cast<std::chrono::milliseconds>(next - steady_clock::now()));
    if (typed && !keys.take(*typed, top_table_lines(overview, view))) {
      return;
    }
  }
}

void print_once(RackObserver& observer) {
  static_cast<void>(observer.look());
  // A rate needs two looks.
  constexpr timespec kBetween{0, 200'000'000};
  ::nanosleep(&kBetween, nullptr);
  TopView view;
  view.columns = std::string::npos;
  const Colours colours(stdout);
  for (const StyledLine& line : top_frame(observer.look(), view)) {
    fmt::print("{}\n", colours.styled(line.text, line.style));
  }
}

void top(const TopOptions& options) {
  HttpClient client(parse_http_address(options.http), read_http_token(options.token_file));
  RackObserver observer(client);
  if (options.once) {
    print_once(observer);
  } else {
    watch(observer, options);
  }
}

}  // namespace

void add_top_command(CLI::App& app) {
  auto options = std::make_shared<TopOptions>();
  CLI::App* command = app.add_subcommand(
      "top", "Watch a running rack in the terminal: networks, devices, axes, events");
  command->add_option("--http", options->http, "Where \"stator run --http\" serves it")
      ->capture_default_str();
  command
      ->add_option("--http-token", options->token_file,
                   "File with the token, for a rack on another machine")
      ->check(names(Names::file));
  command->add_option("--rate", options->rate, "Frames per second, 0.1 to 10")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  command->add_flag("--once", options->once, "Print a single frame and end, for scripts");
  command->footer(
      "Keys: q quits, p pauses, arrows and page keys scroll, / filters rows by a text, ? helps.\n"
      "Examples:\n"
      "  stator run racks/gantry.toml --link ethercat:eth1 --http 8080\n"
      "  stator top\n"
      "  stator top --http http://192.168.1.20:8080 --http-token token --once");
  command->callback([options] { top(*options); });
}

}  // namespace stator::cli
