#pragma once

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace stator::tests {

/// A process that the test has started. Signals go to it and to nothing else, whatever went wrong
/// before: kill() and waitpid() take other numbers than a child's for groups, and -1 for
/// everything. One that does not start ends the test by an exception. With the object it is killed.
class ChildProcess {
 public:
  /// None.
  ChildProcess() = default;

  /// Runs `command`, a path and arguments, with its standard output in `output`.
  static ChildProcess run(std::vector<std::string> command,
                          const std::string& output = "/dev/null") {
    std::vector<char*> words;
    for (std::string& each : command) {
      words.push_back(each.data());
    }
    words.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(),
                                       O_WRONLY | O_CREAT | O_TRUNC, 0600);
    pid_t started = 0;
    const int error =
        ::posix_spawn(&started, words.front(), &actions, nullptr, words.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    if (error != 0) {
      fail("cannot start " + command.front(), error);
    }
    return ChildProcess(started);
  }

  /// A copy of this process that does `body` and ends, with success if that returns.
  template <typename Body>
  static ChildProcess fork(Body body) {
    const pid_t started = ::fork();
    if (started == 0) {
      body();
      ::_exit(0);
    }
    return adopt(started);
  }

  /// What fork() or forkpty() returned to the parent.
  static ChildProcess adopt(pid_t returned) {
    if (returned <= 0) {
      fail("cannot start a process", errno);
    }
    return ChildProcess(returned);
  }

  ~ChildProcess() {
    signal(SIGKILL);
    wait();
  }
  ChildProcess(ChildProcess&& other) noexcept
      : process_(std::exchange(other.process_, 0)), status_(other.status_) {}
  ChildProcess& operator=(ChildProcess&& other) noexcept {
    std::swap(process_, other.process_);
    std::swap(status_, other.status_);
    return *this;
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  [[nodiscard]] bool runs() {
    take_status(WNOHANG);
    return process_ > 0;
  }
  /// Nothing if it has ended.
  void signal(int number) {
    if (runs()) {
      ::kill(process_, number);
    }
  }
  /// Waits for its end. Its exit status; 128 plus the signal that ended it; -1: there was none.
  int wait() {
    take_status(0);
    return status_;
  }

 private:
  explicit ChildProcess(pid_t process) : process_(process) {}

  [[noreturn]] static void fail(const std::string& what, int error) {
    throw std::system_error(error, std::generic_category(), what);
  }

  void take_status(int options) {
    int status = 0;
    pid_t found = 0;
    while (process_ > 0 && (found = ::waitpid(process_, &status, options)) < 0 && errno == EINTR) {
    }
    if (process_ > 0 && found == process_) {
      process_ = 0;
      status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
  }

  pid_t process_ = 0;
  int status_ = -1;
};

/// What a command of the shell said, and how it ended.
struct Outcome {
  int status = -1;     ///< of the shell: 127 if there is no such program
  std::string output;  ///< its standard output
};

/// Runs `command` in a shell as people use one.
inline Outcome run_in_shell(const std::string& command) {
  std::FILE* const pipe = ::popen(command.c_str(), "r");  // NOLINT(cert-env33-c)
  if (pipe == nullptr) {
    throw std::system_error(errno, std::generic_category(), "cannot start a shell");
  }
  Outcome outcome;
  char buffer[4096];
  while (const std::size_t length = std::fread(buffer, 1, sizeof buffer, pipe)) {
    outcome.output.append(buffer, length);
  }
  const int status = ::pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  if (outcome.status == 127) {
    throw std::runtime_error("there is no such program: " + command + "\n" + outcome.output);
  }
  return outcome;
}

}  // namespace stator::tests
