// A state directory's lock, and its files under links, full disks, removal and kills.
#include "stator/rack/kept/state_directory.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/child_process.hpp"
#include "base/temporary_directory.hpp"
#include "stator/base/random.hpp"

namespace stator::rack {
namespace {

namespace fs = std::filesystem;

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using Bytes = std::vector<std::byte>;

Bytes filled(std::size_t size, int value) {
  return Bytes(size, static_cast<std::byte>(value));
}

std::string failure(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "nothing thrown";
}

/// Files of this process cannot grow beyond `bytes`, as on a full disk. Root is no exception.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

class StateDirectoryTest : public testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }
  [[nodiscard]] std::string text_of(const std::string& path) const {
    std::ifstream stream(path);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::string refusal() {
    return failure([this] { StateDirectory directory(path_); });
  }

  tests::TemporaryDirectory temporary_;
  std::string path_ = temporary_.path() + "/state";
  std::string outside_ = temporary_.path() + "/outside";
};

TEST_F(StateDirectoryTest, IsCreatedAndReplacesFilesAsAWhole) {
  const StateDirectory directory(path_);
  EXPECT_FALSE(directory.read("a"));
  directory.replace("a", filled(200'000, 1));
  EXPECT_EQ(directory.read("a"), filled(200'000, 1));
  directory.replace("a", filled(3, 2));
  EXPECT_EQ(directory.read("a"), filled(3, 2));
  EXPECT_FALSE(fs::exists(file("a.new")));
}

TEST_F(StateDirectoryTest, AppendsBehindWhatHoldsAndOnlyToTheFileThatItKnows) {
  const StateDirectory directory(path_);
  const auto first = directory.replace("a", filled(5, 1));
  const auto second = directory.append("a", first, 3, filled(4, 2));
  ASSERT_TRUE(second);
  Bytes expected = filled(3, 1);
  expected.insert(expected.end(), 4, std::byte{2});
  EXPECT_EQ(directory.read("a"), expected);
  EXPECT_FALSE(directory.append("a", first, 3, filled(4, 3))) << "it has changed since";
  EXPECT_EQ(directory.read("a"), expected);
  fs::remove(file("a"));
  EXPECT_FALSE(directory.append("a", *second, 7, filled(4, 3)));
  EXPECT_FALSE(fs::exists(file("a")));
}

TEST_F(StateDirectoryTest, BelongsToOneProcessAtATime) {
  {
    const StateDirectory first(path_);
    EXPECT_THAT(refusal(), HasSubstr("in use by another rack"));
  }
  EXPECT_EQ(refusal(), "nothing thrown");
}

TEST_F(StateDirectoryTest, WithoutItsLockFile_StillBelongsToOneProcess) {
  const StateDirectory first(path_);
  fs::remove(file("lock"));
  EXPECT_THAT(refusal(), HasSubstr("in use by another rack"));
  fs::rename(path_, path_ + "-elsewhere");
  EXPECT_THAT(failure([this] { StateDirectory second(path_ + "-elsewhere"); }),
              HasSubstr("in use by another rack"));
}

TEST_F(StateDirectoryTest, OfARackThatLocksOnlyTheFile_IsInUse) {
  fs::create_directory(path_);
  const link::FileDescriptor other(
      ::open(file("lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  ASSERT_EQ(::flock(other.get(), LOCK_EX), 0);
  EXPECT_THAT(refusal(), HasSubstr("in use by another rack"));
}

TEST_F(StateDirectoryTest, StrangeLock_IsNamedAndNothingHappensToWhatItPointsTo) {
  fs::create_directory(path_);
  fs::create_symlink(outside_, file("lock"));
  EXPECT_THAT(refusal(), AllOf(StartsWith(file("lock")), HasSubstr("a symbolic link"),
                               HasSubstr("delete it")));
  EXPECT_FALSE(fs::exists(outside_));
  fs::remove(file("lock"));
  ASSERT_EQ(::mkfifo(file("lock").c_str(), 0600), 0);
  EXPECT_THAT(refusal(), AllOf(StartsWith(file("lock")), HasSubstr("a FIFO")));
  fs::remove(file("lock"));
  fs::create_directory(file("lock"));
  EXPECT_THAT(refusal(), AllOf(StartsWith(file("lock")), HasSubstr("a directory")));
}

TEST_F(StateDirectoryTest, WhatCannotBeUsed_IsNamedWithReasonAndRemedy) {
  EXPECT_THAT(failure([this] { StateDirectory nested(path_ + "/deeper/still"); }),
              AllOf(StartsWith(path_), HasSubstr("No such file"), HasSubstr("create it")));
  std::ofstream(path_) << "a file";
  EXPECT_THAT(refusal(), HasSubstr("must be a directory"));
}

// Opening some of them would wait for ever, reading others would never end.
TEST_F(StateDirectoryTest, WhatIsNoRegularFile_IsRefusedAtOnceWithItsName) {
  const StateDirectory directory(path_);
  const auto expect_refused = [&](const char* kind) {
    EXPECT_THAT(failure([&] { static_cast<void>(directory.read("a")); }),
                AllOf(StartsWith(file("a: ")), HasSubstr(kind), HasSubstr("delete it")));
    fs::remove(file("a"));
  };
  fs::create_directory(file("a"));
  expect_refused("it is a directory");
  ASSERT_EQ(::mkfifo(file("a").c_str(), 0600), 0);
  expect_refused("it is a FIFO");
  fs::create_symlink("/dev/zero", file("a"));
  expect_refused("it is a symbolic link");
  fs::create_symlink("nowhere", file("a"));
  expect_refused("it is a symbolic link");
  // By a way that is short enough for the address of a socket.
  const link::FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(file("a").size(), sizeof address.sun_path);
  file("a").copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  expect_refused("it is a socket");
  if (::mknod(file("a").c_str(), S_IFCHR | 0600, makedev(1, 5)) == 0) {  // as root: /dev/zero
    expect_refused("it is a device");
  }
}

TEST_F(StateDirectoryTest, FileLargerThanAnyKeptOne_IsRefusedUnread) {
  const StateDirectory directory(path_);
  std::ofstream(file("a")) << "x";
  fs::resize_file(file("a"), std::uintmax_t{1} << 40);
  EXPECT_THAT(
      failure([&] { static_cast<void>(directory.read("a")); }),
      AllOf(StartsWith(file("a: ")), HasSubstr("has 1099511627776 bytes"), HasSubstr("delete it")));
  fs::resize_file(file("a"), 100);
  EXPECT_EQ(directory.read("a", 100)->size(), 100U);
  EXPECT_THAT(failure([&] { static_cast<void>(directory.read("a", 99)); }),
              HasSubstr("at most 99"));
}

TEST_F(StateDirectoryTest, NameThatCouldNeverBeWritten_IsRefusedWhenItIsRead) {
  const StateDirectory directory(path_);
  const std::string longest(251, 'x');  // and ".new" while it is written
  EXPECT_FALSE(directory.read(longest));
  directory.replace(longest, filled(3, 1));
  EXPECT_EQ(directory.read(longest), filled(3, 1));
  EXPECT_THAT(failure([&] { static_cast<void>(directory.read(longest + "x")); }),
              AllOf(HasSubstr(longest + "x: the file's name is too long"), HasSubstr("takes 255"),
                    HasSubstr("shorter name")));
}

TEST_F(StateDirectoryTest, WhatAKilledProcessHasLeftHalfWritten_IsClearedByTheOwnerAlone) {
  fs::create_directory(path_);
  std::ofstream(file("a.new")) << "stator 1 eep";
  EXPECT_FALSE(StateDirectory(path_, StateDirectory::Use::look).read("a"));
  EXPECT_TRUE(fs::exists(file("a.new")));
  EXPECT_FALSE(StateDirectory(path_).read("a"));
  EXPECT_FALSE(fs::exists(file("a.new")));
}

TEST_F(StateDirectoryTest, LinksInPlaceOfTheTemporaryFile_LeadNowhere) {
  const StateDirectory directory(path_);
  std::ofstream(outside_) << "precious";
  for (const bool hard : {false, true}) {
    if (hard) {
      fs::create_hard_link(outside_, file("a.new"));
    } else {
      fs::create_symlink(outside_, file("a.new"));
    }
    directory.replace("a", filled(3, 1));
    EXPECT_EQ(directory.read("a"), filled(3, 1));
    EXPECT_EQ(text_of(outside_), "precious") << (hard ? "hard link" : "symbolic link");
    EXPECT_FALSE(fs::exists(fs::symlink_status(file("a.new"))));
  }
}

TEST_F(StateDirectoryTest, LinksInPlaceOfTheFile_AreReplacedAndNeverWrittenInto) {
  const StateDirectory directory(path_);
  std::ofstream(outside_) << "precious";
  for (const bool hard : {false, true}) {
    const auto before = directory.replace("a", filled(3, 1));
    fs::remove(file("a"));
    if (hard) {
      fs::create_hard_link(outside_, file("a"));
    } else {
      fs::create_symlink(outside_, file("a"));
    }
    EXPECT_FALSE(directory.append("a", before, 3, filled(3, 2)));
    directory.replace("a", filled(3, 2));
    EXPECT_EQ(directory.read("a"), filled(3, 2));
    EXPECT_EQ(text_of(outside_), "precious") << (hard ? "hard link" : "symbolic link");
  }
  // Its own file, which has got a second name: that is somebody's copy.
  const auto before = directory.replace("a", filled(3, 1));
  fs::create_hard_link(file("a"), outside_ + "2");
  EXPECT_FALSE(directory.append("a", before, 3, filled(3, 2)));
  EXPECT_FALSE(directory.stamp("a"));
}

TEST_F(StateDirectoryTest, FileThatCannotBeWritten_LeavesTheOldOneAndSaysSo) {
  const StateDirectory directory(path_);
  directory.replace("a", filled(3, 1));
  fs::create_directory(file("a.new"));
  EXPECT_THAT(failure([&] { directory.replace("a", filled(3, 2)); }),
              AllOf(StartsWith(file("a")), HasSubstr("old content is still there")));
  EXPECT_EQ(directory.read("a"), filled(3, 1));
}

TEST_F(StateDirectoryTest, FullDisk_TakesBackWhatWasWrittenInPart) {
  const StateDirectory directory(path_);
  const auto before = directory.replace("a", filled(100, 1));
  {
    const FullDisk full(120);
    EXPECT_THAT(
        failure([&] { static_cast<void>(directory.append("a", before, 100, filled(50, 2))); }),
        AllOf(StartsWith(file("a")), HasSubstr("File too large"),
              HasSubstr("old content is still there"), HasSubstr("Make room")));
    EXPECT_THAT(failure([&] { directory.replace("a", filled(200, 2)); }),
                HasSubstr("old content is still there"));
    EXPECT_THAT(failure([&] { directory.replace("b", filled(200, 2)); }),
                AllOf(StartsWith(file("b")), HasSubstr("there is no such file now")));
  }
  EXPECT_EQ(directory.read("a"), filled(100, 1));
  EXPECT_FALSE(fs::exists(file("a.new"))) << "nothing that takes room is left";
  EXPECT_FALSE(fs::exists(file("b.new")));
}

TEST_F(StateDirectoryTest, RemovedOrMovedWhileItIsUsed_KeepsNothingAndSaysWhatIsTrue) {
  const StateDirectory directory(path_);
  const auto before = directory.replace("a", filled(3, 1));
  fs::rename(path_, path_ + "-elsewhere");
  for (const auto& write : std::vector<std::function<void()>>{
           [&] { directory.replace("a", filled(3, 2)); },
           [&] { static_cast<void>(directory.append("a", before, 3, filled(3, 2))); }}) {
    EXPECT_THAT(failure(write), AllOf(HasSubstr("the state directory has been moved away"),
                                      HasSubstr("old content is still there")));
  }
  fs::create_directory(path_);
  EXPECT_THAT(failure([&] { directory.replace("a", filled(3, 2)); }), HasSubstr("moved away"))
      << "another one of its name is not the one that is locked";
  fs::remove(path_);
  fs::rename(path_ + "-elsewhere", path_);
  EXPECT_EQ(failure([&] { directory.replace("a", filled(3, 2)); }), "nothing thrown");
  fs::remove_all(path_);
  EXPECT_THAT(
      failure([&] { directory.replace("a", filled(3, 3)); }),
      AllOf(HasSubstr("the state directory has been removed"),
            HasSubstr("there is no such file now"), Not(HasSubstr("old content is still there"))));
}

// A child replaces the file over and over, announces each time, and is killed anywhere in between.
TEST_F(StateDirectoryTest, KilledAtAnyMoment_TheFileIsTheOldOrTheNewOne) {
  constexpr std::size_t kSize = 100'000;
  base::Random random(3315);
  const Bytes before = encode("firmware", "X", filled(kSize, 0));
  int changed = 0;
  for (int round = 1; round <= 40; ++round) {
    const Bytes after = encode("firmware", "X", filled(kSize + 1, round));
    StateDirectory(path_).replace("image", before);
    int announcements[2];
    ASSERT_EQ(::pipe(announcements), 0);
    tests::ChildProcess child = tests::ChildProcess::fork([&] {
      const StateDirectory directory(path_);
      for (bool turn = true;; turn = !turn) {
        if (::write(announcements[1], "x", 1) != 1) {
          ::_exit(1);
        }
        directory.replace("image", turn ? after : before);
      }
    });
    char announcement = 0;
    for (std::uint64_t i = 0; i < 1 + random.below(4); ++i) {
      ASSERT_EQ(::read(announcements[0], &announcement, 1), 1);
    }
    ::usleep(static_cast<useconds_t>(random.below(1500)));
    child.signal(SIGKILL);
    child.wait();
    ::close(announcements[0]);
    ::close(announcements[1]);
    const auto found = StateDirectory(path_).read("image");
    ASSERT_TRUE(found);
    ASSERT_TRUE(*found == before || *found == after)
        << "round " << round << ": " << found->size() << " bytes of neither file";
    changed += *found == after ? 1 : 0;
  }
  EXPECT_GT(changed, 0) << "no kill came after a change; the test shows nothing";
}

}  // namespace
}  // namespace stator::rack
