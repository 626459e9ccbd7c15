#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include "base/child_process.hpp"
#include "cli/stator_program.hpp"
#include "source_paths.hpp"

namespace stator {
namespace {

/// The program at a terminal of 110 by 32 characters, with a person who types.
class Terminal {
 public:
  explicit Terminal(std::vector<std::string> arguments) {
    winsize size{.ws_row = 32, .ws_col = 110, .ws_xpixel = 0, .ws_ypixel = 0};
    const pid_t child = ::forkpty(&file_, nullptr, nullptr, &size);
    if (child == 0) {
      ::setenv("TERM", "xterm", 1);
      std::string program = STATOR_PROGRAM;
      std::vector<char*> words{program.data()};
      for (std::string& each : arguments) {
        words.push_back(each.data());
      }
      words.push_back(nullptr);
      ::execv(program.c_str(), words.data());
      ::_exit(127);
    }
    process_ = tests::ChildProcess::adopt(child);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal() { ::close(file_); }

  void type(const std::string& text) {
    ASSERT_EQ(::write(file_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  /// Whether `text` appears behind what was looked for before, within a time that is never used up.
  bool shows(const std::string& text) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (true) {
      const std::size_t place = output_.find(text, seen_);
      if (place != std::string::npos) {
        seen_ = place + text.size();
        return true;
      }
      if (std::chrono::steady_clock::now() > end || !read_more()) {
        ADD_FAILURE() << "not shown: " << text << "\nbut: " << output_.substr(seen_);
        return false;
      }
    }
  }

  /// Gives `command` and interrupts it until `text` appears. Ctrl-C empties the terminal's input:
  /// what was typed before the program listened is lost with it, and has to be typed anew.
  bool shows_after_interrupting(const std::string& command, const std::string& text) {
    constexpr int kMilliseconds = 100;
    for (int attempt = 0; attempt < 200; ++attempt) {
      type(attempt % 10 == 0 ? command : "\x03");
      while (read_more(kMilliseconds)) {
      }
      if (output_.find(text, seen_) != std::string::npos) {
        return shows(text);
      }
    }
    ADD_FAILURE() << "not shown: " << text << "\nbut: " << output_.substr(seen_);
    return false;
  }

  int exit_status() {
    while (read_more()) {
    }
    return process_.wait();
  }

 private:
  bool read_more(int milliseconds = 60'000) {
    pollfd waiting{.fd = file_, .events = POLLIN, .revents = 0};
    std::array<char, 4096> buffer{};
    if (::poll(&waiting, 1, milliseconds) <= 0) {
      return false;
    }
    const ssize_t length = ::read(file_, buffer.data(), buffer.size());
    if (length <= 0) {
      return false;
    }
    output_.append(buffer.data(), static_cast<std::size_t>(length));
    return true;
  }

  tests::ChildProcess process_;
  int file_ = -1;
  std::string output_;
  std::size_t seen_ = 0;
};

const std::string kProgram = STATOR_SOURCE_DIR "/examples/tmcl/endless_loop.tmc";

TEST(TmclTerminal, TheDebuggersScreenShowsTextRegistersAndAnswers) {
  Terminal terminal({"tmcl", "debug", kProgram, "--tui"});
  EXPECT_TRUE(terminal.shows("WAIT POS, 0, 0"));
  EXPECT_TRUE(terminal.shows("position_actual"));
  EXPECT_TRUE(terminal.shows("(stator)"));
  terminal.type("tb 6\rrun\r");
  EXPECT_TRUE(terminal.shows("Breakpoint 1, Loop+3"));
  terminal.type("continue\r");
  EXPECT_TRUE(terminal.shows("Ctrl-C holds it"));
  terminal.type("\x03");
  EXPECT_TRUE(terminal.shows("Interrupted"));
  terminal.type("quit\r");
  EXPECT_EQ(terminal.exit_status(), 0);
}

TEST(TmclTerminal, ADebuggerOfLinesIsInterruptedByCtrlC) {
  Terminal terminal({"tmcl", "debug", kProgram});
  EXPECT_TRUE(terminal.shows("(stator)"));
  EXPECT_TRUE(terminal.shows_after_interrupting("run\r", "Interrupted"));
  EXPECT_TRUE(terminal.shows("(stator)"));
  terminal.type("q\r");
  EXPECT_EQ(terminal.exit_status(), 0);
}

TEST(TmclTerminal, TheShellCompletesWordsAndRecallsLines) {
  Terminal terminal({"tmcl", "shell"});
  EXPECT_TRUE(terminal.shows("tmcl>"));
  terminal.type("gap max_cu\t 0\r");
  EXPECT_TRUE(terminal.shows("MAX_CURRENT (axis parameter 6) = 8"));
  EXPECT_TRUE(terminal.shows("tmcl>")) << "before that, keys mean other things";
  terminal.type("\x10\r");  // the line before
  EXPECT_TRUE(terminal.shows("MAX_CURRENT (axis parameter 6) = 8"));
  terminal.type("quit\r");
  EXPECT_EQ(terminal.exit_status(), 0);
}

}  // namespace
}  // namespace stator
