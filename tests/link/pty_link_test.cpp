#include "stator/link/serial/pty_link.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/temporary_directory.hpp"

namespace stator::link {
namespace {

using namespace base::literals;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

/// Every value a byte can have, which a line that is not raw would change.
Bytes all_values() {
  Bytes bytes(256);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::byte>(i);
  }
  return bytes;
}

class PtyLinkTest : public testing::Test {
 protected:
  void open() {
    auto opened = PtyLink::open(path_);
    ASSERT_TRUE(opened) << opened.error().text;
    link_ = std::move(*opened);
  }
  [[nodiscard]] FileDescriptor client() const {
    FileDescriptor descriptor(::open(path_.c_str(), O_RDWR | O_NOCTTY));
    EXPECT_TRUE(descriptor.is_open());
    return descriptor;
  }
  static void send(const FileDescriptor& client, const Bytes& bytes) {
    EXPECT_EQ(::write(client.get(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }
  /// What a client reads until it has `length` bytes.
  static Bytes read(const FileDescriptor& client, std::size_t length) {
    Bytes bytes;
    while (bytes.size() < length) {
      pollfd waiting{.fd = client.get(), .events = POLLIN, .revents = 0};
      if (::poll(&waiting, 1, 10'000) <= 0) {
        ADD_FAILURE() << "only " << bytes.size() << " bytes came";
        break;
      }
      std::array<std::byte, 256> buffer{};
      const ssize_t got = ::read(client.get(), buffer.data(), buffer.size());
      bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + std::max<ssize_t>(got, 0));
    }
    return bytes;
  }
  /// What the link receives until it has `length` bytes.
  [[nodiscard]] Bytes receive(std::size_t length) const {
    Bytes bytes;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (bytes.size() < length && std::chrono::steady_clock::now() < deadline) {
      std::array<std::byte, 256> buffer{};
      const auto got = link_->receive(buffer, 1_s);
      if (!got) {
        ADD_FAILURE() << got.error().text;
        break;
      }
      bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*got));
    }
    return bytes;
  }

  tests::TemporaryDirectory directory_;
  std::string path_ = directory_.path() + "/port";
  std::unique_ptr<PtyLink> link_;
};

TEST_F(PtyLinkTest, BytesOfEveryValuePassBothWaysUnchanged) {
  open();
  const FileDescriptor program = client();
  send(program, all_values());
  EXPECT_EQ(receive(256), all_values());
  ASSERT_TRUE(link_->send(all_values()));
  EXPECT_EQ(read(program, 256), all_values());
}

TEST_F(PtyLinkTest, ProgramsMayCloseAndOpenItAgain) {
  open();
  for (int i = 0; i < 3; ++i) {
    {
      const FileDescriptor program = client();
      send(program, all_values());
    }
    EXPECT_EQ(receive(256), all_values()) << "nothing is lost when the program is gone already";
    const FileDescriptor again = client();
    ASSERT_TRUE(link_->send(all_values()));
    EXPECT_EQ(read(again, 256), all_values());
  }
}

TEST_F(PtyLinkTest, WithoutAProgramNothingComesAndWhatIsSentIsDroppedInTheEnd) {
  open();
  std::array<std::byte, 16> buffer{};
  const auto nothing = link_->receive(buffer, 0_ms);
  ASSERT_TRUE(nothing);
  EXPECT_EQ(*nothing, 0U);
  base::Expected<void, LinkError> sent;
  for (int i = 0; i < 100 && sent; ++i) {
    sent = link_->send(all_values());
  }
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, LinkErrorCode::queue_full);
}

TEST_F(PtyLinkTest, WakeEndsTheWait) {
  open();
  link_->wake();
  std::array<std::byte, 16> buffer{};
  const auto nothing = link_->receive(buffer, 3'600_s);
  ASSERT_TRUE(nothing);
  EXPECT_EQ(*nothing, 0U);
}

TEST_F(PtyLinkTest, NameVanishesWithTheLink) {
  open();
  EXPECT_EQ(std::filesystem::read_symlink(path_), link_->terminal());
  link_.reset();
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(path_)));
}

TEST_F(PtyLinkTest, NameLeftBehindByAnEarlierProcessIsReplaced) {
  std::filesystem::create_symlink("/dev/pts/12345", path_);
  open();
  EXPECT_EQ(std::filesystem::read_symlink(path_), link_->terminal());
}

TEST_F(PtyLinkTest, ANameInUseIsRefusedAndStaysWithItsHolder) {
  open();
  const auto second = PtyLink::open(path_);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, LinkErrorCode::address_in_use);
  EXPECT_EQ(second.error().text,
            "another process serves \"" + path_ + "\"; end it, or choose another path");
  EXPECT_EQ(std::filesystem::read_symlink(path_), link_->terminal());

  link_.reset();
  open();
  EXPECT_EQ(std::filesystem::read_symlink(path_), link_->terminal());
  link_.reset();
  EXPECT_TRUE(std::filesystem::is_empty(directory_.path())) << "nothing is left beside the name";
}

TEST_F(PtyLinkTest, TheNameOfAProcessThatWasKilledIsFree) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe2(pipe.data(), O_CLOEXEC), 0);
  const FileDescriptor told(pipe[0]);
  const pid_t holder = ::fork();
  ASSERT_GE(holder, 0);
  if (holder == 0) {
    const auto held = PtyLink::open(path_);
    const char done = held ? 'y' : 'n';
    const bool written = ::write(pipe[1], &done, 1) == 1;
    while (written) {
      ::pause();
    }
    ::_exit(1);
  }
  ::close(pipe[1]);
  char done = 0;
  const bool answered = ::read(told.get(), &done, 1) == 1;
  const auto refused = PtyLink::open(path_);
  EXPECT_EQ(::kill(holder, SIGKILL), 0);
  EXPECT_EQ(::waitpid(holder, nullptr, 0), holder);
  ASSERT_TRUE(answered);
  ASSERT_EQ(done, 'y');
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, LinkErrorCode::address_in_use);

  open();
  EXPECT_EQ(std::filesystem::read_symlink(path_), link_->terminal());
}

TEST_F(PtyLinkTest, ANameLeftBehindGoesToOneOfManyWhoWantIt) {
  constexpr int kRounds = 50;
  for (int round = 0; round < kRounds; ++round) {
    std::filesystem::create_symlink("/dev/pts/12345", path_);
    std::array<std::unique_ptr<PtyLink>, 4> links;
    {
      std::vector<std::jthread> threads;
      for (auto& link : links) {
        threads.emplace_back([&] {
          if (auto opened = PtyLink::open(path_)) {
            link = std::move(*opened);
          }
        });
      }
    }
    const auto holds = [](const auto& link) { return link != nullptr; };
    ASSERT_EQ(std::ranges::count_if(links, holds), 1);
    const auto& holder = *std::ranges::find_if(links, holds);
    ASSERT_EQ(std::filesystem::read_symlink(path_), holder->terminal());
  }
}

TEST_F(PtyLinkTest, TheTerminalOfAnotherProgramIsNotReplaced) {
  const FileDescriptor other(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  std::array<char, 64> terminal{};
  ASSERT_EQ(::grantpt(other.get()), 0);
  ASSERT_EQ(::ptsname_r(other.get(), terminal.data(), terminal.size()), 0);
  std::filesystem::create_symlink(terminal.data(), path_);
  const auto opened = PtyLink::open(path_);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, LinkErrorCode::address_in_use);
  EXPECT_THAT(opened.error().text, HasSubstr(std::string("leads to ") + terminal.data()));
  EXPECT_EQ(std::filesystem::read_symlink(path_), terminal.data());

  std::ofstream(path_ + ".lock") << "";  // of an earlier process that had that terminal
  open();
  EXPECT_EQ(std::filesystem::read_symlink(path_), link_->terminal());
}

TEST_F(PtyLinkTest, AFileIsNotReplaced) {
  std::ofstream(path_) << "precious";
  const auto opened = PtyLink::open(path_);
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().text, HasSubstr("exists and is no pseudo-terminal"));
  EXPECT_EQ(std::filesystem::file_size(path_), 8U);
}

TEST_F(PtyLinkTest, ANameTakenOverByAnotherProcessIsNotRemoved) {
  open();
  std::filesystem::remove(path_);
  std::filesystem::create_symlink("/dev/pts/12345", path_);
  link_.reset();
  EXPECT_EQ(std::filesystem::read_symlink(path_), "/dev/pts/12345");
}

TEST_F(PtyLinkTest, SerialLinesAreOpenedAsPeopleWriteThem) {
  {
    const auto opened = open_serial_link("pty:" + path_);
    ASSERT_TRUE(opened);
    EXPECT_EQ((*opened)->name(), path_);
  }
  for (const char* text : {"pty:", "pty", "/dev/ttyS0", ""}) {
    const auto opened = open_serial_link(text);
    ASSERT_FALSE(opened) << text;
    EXPECT_THAT(opened.error().text, HasSubstr("pty:PATH"));
  }
}

}  // namespace
}  // namespace stator::link
