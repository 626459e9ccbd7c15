#include "rack/kept_file.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/child_process.hpp"
#include "base/random.hpp"
#include "base/temporary_directory.hpp"

namespace stator::rack {
namespace {

using testing::HasSubstr;
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

TEST(KeptFile, FirstLineSaysWhatItIsAndTheContentFollowsAsItIs) {
  const std::string digits = "123456789";
  const Bytes file = encode("eeprom", "TMCM-3315", std::as_bytes(std::span(digits)));
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(file.data()), file.size()),
            "stator 1 eeprom 9 CBF43926 TMCM-3315\n123456789");
}

TEST(KeptFile, EveryContentComesBack) {
  base::Random random(1);
  for (const std::size_t size : {0U, 1U, 10U, 2048U, 100'000U}) {
    Bytes content(size);
    for (std::byte& byte : content) {
      byte = static_cast<std::byte>(random.next());
    }
    const KeptFile kept = decode(encode("firmware", "a name with spaces", content));
    EXPECT_EQ(kept.kind, "firmware");
    EXPECT_EQ(kept.product, "a name with spaces");
    EXPECT_EQ(kept.content, content);
  }
}

TEST(KeptFile, ForeignFile_IsRefused) {
  for (const std::string& text : {std::string(), std::string("\x05\x00\x44", 3),
                                  std::string("stator 2 eeprom 0 00000000 X\n"),
                                  std::string("stator 1 eeprom 0 00000000 X")}) {
    EXPECT_THAT(failure([&] { static_cast<void>(decode(std::as_bytes(std::span(text)))); }),
                HasSubstr("no file that Stator has kept"))
        << text;
  }
}

TEST(KeptFile, EveryShorterOrLongerFile_IsRefused) {
  const Bytes file = encode("eeprom", "X", filled(100, 7));
  for (std::size_t size = 0; size < file.size(); ++size) {
    EXPECT_NE(failure([&] { static_cast<void>(decode(std::span(file).first(size))); }),
              "nothing thrown")
        << size;
  }
  Bytes longer = file;
  longer.push_back(std::byte{7});
  EXPECT_THAT(failure([&] { static_cast<void>(decode(longer)); }),
              HasSubstr("promises 100 bytes, 101 follow"));
}

TEST(KeptFile, EveryFlippedBitOfTheContent_IsNoticed) {
  const Bytes file = encode("eeprom", "X", filled(16, 7));
  const std::size_t content = file.size() - 16;
  for (std::size_t bit = content * 8; bit < file.size() * 8; ++bit) {
    Bytes damaged = file;
    damaged[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
    EXPECT_THAT(failure([&] { static_cast<void>(decode(damaged)); }), HasSubstr("CRC-32"));
  }
}

TEST(KeptFile, DeviceNames_MakeFileNamesThatCannotLeaveTheDirectoryOrCollide) {
  EXPECT_EQ(file_name_for("tmcm-3315_2.b"), "tmcm-3315_2.b");
  EXPECT_EQ(file_name_for("../x"), "..%2Fx");
  EXPECT_EQ(file_name_for("a b%20"), "a%20b%2520");
}

class StateDirectoryTest : public testing::Test {
 protected:
  tests::TemporaryDirectory temporary_;
  std::string path_ = temporary_.path() + "/state";
};

TEST_F(StateDirectoryTest, IsCreatedAndReplacesFilesAsAWhole) {
  const StateDirectory directory(path_);
  EXPECT_FALSE(directory.read("a"));
  directory.replace("a", filled(200'000, 1));
  EXPECT_EQ(directory.read("a"), filled(200'000, 1));
  directory.replace("a", filled(3, 2));
  EXPECT_EQ(directory.read("a"), filled(3, 2));
  EXPECT_FALSE(std::filesystem::exists(path_ + "/a.new"));
}

TEST_F(StateDirectoryTest, BelongsToOneProcessAtATime) {
  {
    const StateDirectory first(path_);
    EXPECT_THAT(failure([this] { StateDirectory second(path_); }),
                HasSubstr("in use by another rack"));
  }
  EXPECT_EQ(failure([this] { StateDirectory again(path_); }), "nothing thrown");
}

TEST_F(StateDirectoryTest, WhatCannotBeUsed_IsNamedWithReasonAndRemedy) {
  EXPECT_THAT(failure([this] { StateDirectory nested(path_ + "/deeper/still"); }),
              testing::AllOf(StartsWith(path_), HasSubstr("No such file"), HasSubstr("create it")));
  std::ofstream(path_) << "a file";
  EXPECT_THAT(failure([this] { StateDirectory file(path_); }), HasSubstr("must be a directory"));
}

TEST_F(StateDirectoryTest, FileThatCannotBeWritten_LeavesTheOldOneAndSaysSo) {
  const StateDirectory directory(path_);
  directory.replace("a", filled(3, 1));
  std::filesystem::create_directory(path_ + "/a.new");
  EXPECT_THAT(failure([&] { directory.replace("a", filled(3, 2)); }),
              testing::AllOf(StartsWith(path_ + "/a"), HasSubstr("old content is still there")));
  EXPECT_EQ(directory.read("a"), filled(3, 1));
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
