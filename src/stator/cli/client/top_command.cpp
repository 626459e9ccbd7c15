#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "stator/cli/client/http_client.hpp"
#include "stator/cli/client/rack_overview.hpp"
#include "stator/cli/client/top_screen.hpp"
#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"

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

bool wants_colours() {
  const char* no_colour = std::getenv("NO_COLOR");  // NOLINT(concurrency-mt-unsafe)
  return ::isatty(STDOUT_FILENO) == 1 && (no_colour == nullptr || *no_colour == '\0');
}

/// The terminal while it belongs to the program: keys come one by one, and what stood there before
/// comes back.
class Terminal {
 public:
  Terminal() {
    if (::isatty(STDIN_FILENO) != 1 || ::isatty(STDOUT_FILENO) != 1) {
      throw Failure("this is no terminal; --once prints a single frame");
    }
    ::tcgetattr(STDIN_FILENO, &before_);
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | ISIG);
    raw.c_iflag &= ~static_cast<tcflag_t>(IXON | ICRNL);
    ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
    struct sigaction action {};
    action.sa_handler = end;
    ::sigaction(SIGTERM, &action, nullptr);
    ::sigaction(SIGHUP, &action, nullptr);
    write("\x1b[?1049h\x1b[?25l");
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal() {
    write("\x1b[?25h\x1b[?1049l");
    ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }

  static void write(std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
  }
  static void measure(TopView& view) {
    winsize size{};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col != 0 && size.ws_row != 0) {
      view.columns = size.ws_col;
      view.rows = size.ws_row;
    } else {
      view.rows = 24;
    }
  }
  /// What has been typed until `deadline`, empty if nothing has.
  [[nodiscard]] static std::string keys(steady_clock::time_point deadline) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - steady_clock::now());
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0))) <= 0) {
      return {};
    }
    std::array<char, 64> bytes{};
    const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (count <= 0) {
      g_ended = 1;  // the terminal is gone
      return {};
    }
    return {bytes.data(), static_cast<std::size_t>(count)};
  }

 private:
  termios before_{};
};

constexpr char kEscape = '\x1b';
constexpr char kControlC = '\x03';
constexpr char kBackspace = '\x7f';

/// What the keys do to the view; returns false to end.
class Keys {
 public:
  explicit Keys(TopView& view) : view_(view) {}

  [[nodiscard]] bool take(std::string_view keys, std::size_t table_lines) {
    const std::size_t page = std::max<std::size_t>(view_.rows / 2, 1);
    while (!keys.empty()) {
      if (keys.starts_with("\x1b[") || keys.starts_with("\x1bO")) {
        const std::size_t last =
            std::min(keys.find_first_not_of("0123456789;", 2), keys.size() - 1);
        scroll(keys.substr(2, last - 1), page, table_lines);
        keys.remove_prefix(last + 1);
      } else if (!(view_.typing ? type(keys.front()) : press(keys.front(), table_lines))) {
        return false;
      } else {
        keys.remove_prefix(1);
      }
    }
    return true;
  }

 private:
  void scroll(std::string_view code, std::size_t page, std::size_t table_lines) {
    if (code == "A") {
      up(1);
    } else if (code == "B") {
      down(1, table_lines);
    } else if (code == "5~") {
      up(page);
    } else if (code == "6~") {
      down(page, table_lines);
    } else if (code == "H" || code == "1~") {
      view_.first = 0;
    } else if (code == "F" || code == "4~") {
      down(table_lines, table_lines);
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

void show(const RackOverview& overview, const TopView& view) {
  // Each line is cleared behind its end, so that nothing flickers.
  std::string output = "\x1b[H";
  const std::vector<std::string> lines = top_frame(overview, view);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    output += lines[i] + "\x1b[K" + (i + 1 < lines.size() ? "\r\n" : "");
  }
  Terminal::write(output + "\x1b[J");
}

void watch(RackObserver& observer, const TopOptions& options) {
  RackOverview overview = observer.look();
  const Terminal terminal;
  TopView view;
  view.colours = wants_colours();
  Keys keys(view);
  const auto period = std::chrono::duration_cast<steady_clock::duration>(
      std::chrono::duration<double>(1 / options.rate));
  steady_clock::time_point next = steady_clock::now();
  while (g_ended == 0) {
    if (steady_clock::now() >= next) {
      if (!view.paused) {
        overview = observer.look();
      }
      next = steady_clock::now() + period;
    }
    Terminal::measure(view);
    show(overview, view);
    if (!keys.take(Terminal::keys(next), top_table_lines(overview, view))) {
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
  view.colours = wants_colours();
  for (const std::string& line : top_frame(observer.look(), view)) {
    fmt::print("{}\n", line);
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
  command->add_option("--http-token", options->token_file,
                      "File with the token, for a rack on another machine");
  command->add_option("--rate", options->rate, "Frames per second, 0.1 to 10")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  command->add_flag("--once", options->once, "Print a single frame and end, for scripts");
  command->footer(
      "Keys: q quits, p pauses, arrows and page keys scroll, / filters rows by a text.\n"
      "Examples:\n"
      "  stator run racks/gantry.toml --link ethercat:eth1 --http 8080\n"
      "  stator top\n"
      "  stator top --http http://192.168.1.20:8080 --http-token token --once");
  command->callback([options] { top(*options); });
}

}  // namespace stator::cli
