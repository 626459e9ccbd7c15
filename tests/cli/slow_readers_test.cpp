// Nobody's slowness stops a rack: pipes, FIFOs and clients that nobody reads, and a rack that
// answers and ends nevertheless.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "base/child_process.hpp"
#include "base/temporary_directory.hpp"
#include "cli/stator_program.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::cli {
namespace {

using link::FileDescriptor;
using ::testing::HasSubstr;
using ::testing::Not;

/// For what has to happen, on however slow a machine.
constexpr std::chrono::seconds kLongEnough{240};
/// How often in a row a program that moves no further is looked at.
constexpr int kStandsStill = 50;

/// A CANopen master's end of a pseudo-terminal with CAN frames as text.
class Programmer {
 public:
  explicit Programmer(const std::string& path)
      : terminal_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    termios settings{};
    ::tcgetattr(terminal_.get(), &settings);
    ::cfmakeraw(&settings);
    ::tcsetattr(terminal_.get(), TCSANOW, &settings);
    static_cast<void>(say("O\r"));
  }

  /// Asks node 5 for an object that does not exist, a new one each time, which the rack logs. True:
  /// it was refused.
  bool is_refused() {
    const unsigned index = 0x2F00 + asked_ % 0x1000;
    const unsigned subindex = asked_++ / 0x1000;
    const std::string request =
        fmt::format("t605840{:02X}{:02X}{:02X}00000000\r", index & 0xFFU, index >> 8U, subindex);
    const std::string answer =
        fmt::format("t585880{:02X}{:02X}{:02X}", index & 0xFFU, index >> 8U, subindex);
    const auto limit = std::chrono::steady_clock::now() + kLongEnough;
    while (std::chrono::steady_clock::now() < limit) {
      // Again, since a device that starts does not hear.
      static_cast<void>(say(request));
      const auto again = std::chrono::steady_clock::now() + std::chrono::seconds(2);
      while (std::chrono::steady_clock::now() < again) {
        hear();
        if (heard_.find(answer) != std::string::npos) {
          heard_.clear();
          return true;
        }
      }
    }
    return false;
  }
  /// How many of `count` were refused before one had no answer.
  int refused(int count) {
    int done = 0;
    while (done < count && is_refused()) {
      ++done;
    }
    return done;
  }
  /// Says something without listening and without waiting, since a rack whose time stands still
  /// does not read; false: there is no room.
  [[nodiscard]] bool say(const std::string& text) const {
    return ::write(terminal_.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size());
  }

 private:
  void hear() {
    pollfd readable{.fd = terminal_.get(), .events = POLLIN, .revents = 0};
    if (::poll(&readable, 1, 100) > 0) {
      std::string piece(4096, '\0');
      const ssize_t length = ::read(terminal_.get(), piece.data(), piece.size());
      heard_.append(piece, 0, static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
    }
  }

  FileDescriptor terminal_;
  std::string heard_;
  unsigned asked_ = 0;
};

class SlowReaders : public ::testing::Test {
 protected:
  /// A FIFO with a reader that never reads.
  FileDescriptor unread_fifo(const std::string& name) {
    const std::string path = file(name);
    EXPECT_EQ(::mkfifo(path.c_str(), 0600), 0);
    return FileDescriptor(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  }
  /// What waits in a FIFO.
  static int unread_bytes(const FileDescriptor& fifo) {
    int bytes = 0;
    EXPECT_EQ(::ioctl(fifo.get(), FIONREAD, &bytes), 0);
    return bytes;
  }
  [[nodiscard]] std::string file(const std::string& name) const {
    return directory_.path() + "/" + name;
  }

  /// Starts a TMCC160 as node 5 with `more` at the end of its rack file, its standard output and
  /// error going where `redirection` says, and waits until it can be reached.
  void start(const std::string& redirection, const std::string& bus = {},
             const std::string& more = {}, const std::string& options = {}) {
    std::ofstream(file("rack.toml")) << "[[bus]]\nports = [\"slcan:" << file("can") << "\"]\n"
                                     << bus
                                     << "[[bus.device]]\ntype = \"tmcc160\"\nname = \"spindle\"\n"
                                        "node_id = 5\n"
                                     << more;
    std::string command = "exec ";
    command += STATOR_PROGRAM;
    command += " run " + file("rack.toml") + " " + options + " </dev/null " + redirection;
    process_ = tests::ChildProcess::run({"/bin/sh", "-c", command});
    const auto limit = std::chrono::steady_clock::now() + kLongEnough;
    while (::access(file("can").c_str(), F_OK) != 0) {
      ASSERT_LT(std::chrono::steady_clock::now(), limit);
      ASSERT_TRUE(process_.runs());
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  /// Ends it as Ctrl-C does. Its exit status; -2: it does not end.
  int end() {
    process_.signal(SIGINT);
    const auto limit = std::chrono::steady_clock::now() + kLongEnough;
    while (process_.runs()) {
      if (std::chrono::steady_clock::now() > limit) {
        return -2;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return process_.wait();
  }
  std::string log() { return tests::content(file("log")); }

  const tests::TemporaryDirectory directory_;
  tests::ChildProcess process_;
};

// Each refusal is a line of some 170 bytes, and a pipe holds 64 KiB.
constexpr int kMoreThanAPipe = 1500;

TEST_F(SlowReaders, OfStandardErrorStopNobody) {
  const FileDescriptor pipe = unread_fifo("pipe");
  ASSERT_NO_FATAL_FAILURE(start(">" + file("out") + " 2>" + file("pipe")));
  Programmer programmer(file("can"));
  EXPECT_EQ(programmer.refused(kMoreThanAPipe), kMoreThanAPipe);
  EXPECT_EQ(end(), 0);
  EXPECT_THAT(tests::content(file("out")), HasSubstr("frames from programs")) << "the report";
}

TEST_F(SlowReaders, OfBothOutputsInOnePipeStopNobody) {
  const FileDescriptor pipe = unread_fifo("pipe");
  ASSERT_NO_FATAL_FAILURE(start(">" + file("pipe") + " 2>&1"));
  Programmer programmer(file("can"));
  EXPECT_EQ(programmer.refused(kMoreThanAPipe), kMoreThanAPipe);
  EXPECT_EQ(end(), 0);
}

TEST_F(SlowReaders, OfAPipeThatIsFullFromTheBeginningStopNobody) {
  const FileDescriptor pipe = unread_fifo("pipe");
  ASSERT_EQ(::fcntl(pipe.get(), F_SETFL, O_NONBLOCK), 0);
  const std::string much(4096, '.');
  while (::write(pipe.get(), much.data(), much.size()) > 0) {
  }
  ASSERT_NO_FATAL_FAILURE(start(">" + file("pipe") + " 2>&1"));
  Programmer programmer(file("can"));
  EXPECT_TRUE(programmer.is_refused());
  EXPECT_EQ(end(), 0);
}

// The queue takes a megabyte.
TEST_F(SlowReaders, HearOfTheLinesTheyHaveMissed) {
  const FileDescriptor pipe = unread_fifo("pipe");
  ASSERT_NO_FATAL_FAILURE(start(">" + file("out") + " 2>" + file("pipe")));
  Programmer programmer(file("can"));
  constexpr int kMoreThanTheQueue = 10'000;
  ASSERT_EQ(programmer.refused(kMoreThanTheQueue), kMoreThanTheQueue);
  ASSERT_EQ(::fcntl(pipe.get(), F_SETFL, O_NONBLOCK), 0);
  std::string read;
  const auto limit = std::chrono::steady_clock::now() + kLongEnough;
  while (read.find("lines of this log are missing here") == std::string::npos &&
         std::chrono::steady_clock::now() < limit) {
    std::string piece(65536, '\0');
    const ssize_t length = ::read(pipe.get(), piece.data(), piece.size());
    if (length > 0) {
      read.append(piece, 0, static_cast<std::size_t>(length));
    } else {
      ASSERT_TRUE(programmer.is_refused());  // something new to log
    }
  }
  EXPECT_THAT(read, HasSubstr("lines of this log are missing here, because they were not read in"));
  EXPECT_EQ(end(), 0);
  EXPECT_THAT(tests::content(file("out")), HasSubstr("lines of the log were lost"));
}

TEST_F(SlowReaders, GetEverythingInTheEndIfTheyReadThen) {
  const FileDescriptor pipe = unread_fifo("pipe");
  ASSERT_NO_FATAL_FAILURE(start(">" + file("out") + " 2>" + file("pipe")));
  Programmer programmer(file("can"));
  ASSERT_EQ(programmer.refused(kMoreThanAPipe), kMoreThanAPipe);
  ASSERT_EQ(::fcntl(pipe.get(), F_SETFL, O_NONBLOCK), 0);
  process_.signal(SIGINT);
  std::string read;
  std::string piece(65536, '\0');
  while (process_.runs()) {
    const ssize_t length = ::read(pipe.get(), piece.data(), piece.size());
    read.append(piece, 0, static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
  }
  for (ssize_t length = 0; (length = ::read(pipe.get(), piece.data(), piece.size())) > 0;) {
    read.append(piece, 0, static_cast<std::size_t>(length));
  }
  EXPECT_EQ(process_.wait(), 0);
  EXPECT_GE(std::ranges::count(read, '\n'), kMoreThanAPipe);
  EXPECT_THAT(tests::content(file("out")), Not(HasSubstr("lost, because")));
}

TEST_F(SlowReaders, ThatGoDoNotEndTheRun) {
  { const FileDescriptor pipe = unread_fifo("pipe"); }
  FileDescriptor reader(::open(file("pipe").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  ASSERT_NO_FATAL_FAILURE(start(">" + file("pipe") + " 2>&1"));
  Programmer programmer(file("can"));
  ASSERT_TRUE(programmer.is_refused());
  reader = FileDescriptor();
  EXPECT_EQ(programmer.refused(10), 10);
  EXPECT_EQ(end(), 0);
}

TEST_F(SlowReaders, OfRecordingsAndCapturesStopNobodyAndAreToldOf) {
  const FileDescriptor log_reader = unread_fifo("candump");
  const FileDescriptor capture_reader = unread_fifo("pcap");
  const FileDescriptor csv_reader = unread_fifo("csv");
  ASSERT_NO_FATAL_FAILURE(
      start(">" + file("log") + " 2>&1",
            "log = \"" + file("candump") + "\"\ncapture = \"" + file("pcap") + "\"\n",
            "[record]\nfile = \"" + file("csv") + "\"\nperiod = \"10us\"\nsignals = [\"*\"]\n"));
  Programmer programmer(file("can"));
  const auto limit = std::chrono::steady_clock::now() + kLongEnough;
  while (log().find("recording " + file("csv") + ": what comes is not taken") ==
         std::string::npos) {
    ASSERT_LT(std::chrono::steady_clock::now(), limit) << log();
    ASSERT_TRUE(programmer.is_refused());
  }
  EXPECT_EQ(programmer.refused(100), 100);
  EXPECT_EQ(end(), 1) << "what was to be written is not complete";
  EXPECT_THAT(log(), HasSubstr("recording " + file("csv") + " is not complete: "));
  EXPECT_THAT(log(), HasSubstr("rows are missing, because they were not taken in time"));
}

TEST_F(SlowReaders, ThatOpenNoFifoDoNotKeepARunFromStartingAndEnding) {
  ASSERT_EQ(::mkfifo(file("csv").c_str(), 0600), 0);
  ASSERT_NO_FATAL_FAILURE(
      start(">" + file("log") + " 2>&1", {},
            "[record]\nfile = \"" + file("csv") + "\"\nperiod = \"1ms\"\nsignals = [\"*\"]\n"));
  Programmer programmer(file("can"));
  EXPECT_TRUE(programmer.is_refused());
  EXPECT_EQ(end(), 1);
  EXPECT_THAT(log(), HasSubstr("bytes are missing, because nobody took them in the end"));
}

// Simulated time stands still for the reader, but the end comes nevertheless.
TEST_F(SlowReaders, InLockstepAreWaitedForUntilTheEndIsAskedFor) {
  const FileDescriptor csv_reader = unread_fifo("csv");
  ASSERT_NO_FATAL_FAILURE(
      start(">" + file("log") + " 2>&1", {},
            "[record]\nfile = \"" + file("csv") + "\"\nperiod = \"1us\"\nsignals = [\"*\"]\n",
            "--clock lockstep"));
  const Programmer programmer(file("can"));
  // Each moves time, by far more rows than the queue has room for, until the program takes none any
  // more and the reader's pipe is as it was.
  const auto limit = std::chrono::steady_clock::now() + kLongEnough;
  int unread = 0;
  for (int still = 0; still < kStandsStill && std::chrono::steady_clock::now() < limit;) {
    if (programmer.say("t0800\r")) {
      still = 0;
      continue;
    }
    const int before = std::exchange(unread, unread_bytes(csv_reader));
    still = unread > 0 && unread == before ? still + 1 : 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(end(), 1);
  EXPECT_THAT(log(), Not(HasSubstr("what comes is not taken quickly enough")));
  EXPECT_THAT(log(), HasSubstr("is not complete"));
}

}  // namespace
}  // namespace stator::cli
