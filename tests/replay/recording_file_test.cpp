// The file of a recording: when it has its name, and what is refused in its place.

#include "stator/replay/recording_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stator/replay/recording_reader.hpp"
#include "stator/replay/regular_file.hpp"

namespace stator::replay {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class RecordingFileTest : public ::testing::Test {
 protected:
  RecordingFileTest() : folder_(::testing::TempDir() + "files-" + std::to_string(::getpid())) {
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  ~RecordingFileTest() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  static void write(const std::string& path, const std::string& content) {
    std::ofstream(path, std::ios::binary) << content;
  }
  static std::string content(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static std::string reading(const std::string& path) {
    try {
      RecordingReader reader(path);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  }
  static std::string writing(const std::string& path) {
    try {
      RecordingFile file(path, {.program = "test"});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  }

  fs::path folder_;
};

TEST_F(RecordingFileTest, WhatIsNoFileIsRefusedWithoutReadingIt) {
  ASSERT_EQ(::mkfifo(path("fifo").c_str(), 0600), 0);
  fs::create_symlink(path("fifo"), path("link"));
  EXPECT_THAT(reading(path("fifo")), HasSubstr("it is a FIFO; name a file"));
  EXPECT_THAT(reading(path("link")), HasSubstr("it is a FIFO; name a file"));
  EXPECT_THAT(reading(folder_), HasSubstr("it is a directory; name a file"));
  EXPECT_THAT(reading("/dev/zero"), HasSubstr("it is a device; name a file"));
  EXPECT_THAT(reading("/dev/stdin/"), HasSubstr("cannot read recording"));
}

TEST_F(RecordingFileTest, ALinkToARecordingIsThatRecording) {
  EXPECT_EQ(writing(path("run.stator")), "none");
  fs::create_symlink("run.stator", path("latest.stator"));
  EXPECT_EQ(reading(path("latest.stator")), "none");
}

TEST_F(RecordingFileTest, OneWithoutItsHeaderIsEmpty) {
  write(path("nothing"), "");
  write(path("begun"), "Stat");
  write(path("short"), std::string("StatorRn\x40\x00\x00\x00", 12));
  write(path("long"), std::string("StatorRn\xFF\xFF\xFF\x0F\x00\x00\x00\x00", 16));
  EXPECT_THAT(reading(path("nothing")), HasSubstr("empty recording"));
  EXPECT_THAT(reading(path("begun")), HasSubstr("empty recording"));
  EXPECT_THAT(reading(path("short")), HasSubstr("empty recording"));
  EXPECT_THAT(reading(path("long")), HasSubstr("empty recording"));
}

TEST_F(RecordingFileTest, ZerosBehindARecordingAreDamageAndNotEndlessChunks) {
  EXPECT_EQ(writing(path("run.stator")), "none");
  fs::resize_file(path("run.stator"), std::uintmax_t{1} << 40U);
  RecordingReader reader(path("run.stator"));
  Step step;
  EXPECT_FALSE(reader.next(step));
  EXPECT_EQ(reader.ending(), RecordingEnding::damaged);
}

TEST_F(RecordingFileTest, OneThatNobodyEndedIsCut) {
  EXPECT_EQ(writing(path("run.stator")), "none");
  RecordingReader reader(path("run.stator"));
  Step step;
  EXPECT_FALSE(reader.next(step));
  EXPECT_EQ(reader.ending(), RecordingEnding::cut);
  EXPECT_THAT(reader.damage(), HasSubstr("was not ended"));
}

TEST_F(RecordingFileTest, TheNameAppearsWithTheHeader) {
  write(path("run.stator"), "the one before");
  {
    NewFile file(path("run.stator"));
    EXPECT_EQ(content(path("run.stator")), "the one before");
  }
  EXPECT_EQ(content(path("run.stator")), "the one before");
  EXPECT_FALSE(fs::exists(path("run.stator.new")));
  EXPECT_EQ(writing(path("run.stator")), "none");
  EXPECT_EQ(reading(path("run.stator")), "none");
  EXPECT_FALSE(fs::exists(path("run.stator.new")));
}

TEST_F(RecordingFileTest, ALinkThatWaitsWhereTheFileIsMadeIsNotFollowed) {
  write(path("victim"), "untouched");
  fs::create_symlink(path("victim"), path("run.stator.new"));
  EXPECT_EQ(writing(path("run.stator")), "none");
  EXPECT_EQ(content(path("victim")), "untouched");
  EXPECT_EQ(reading(path("run.stator")), "none");
}

TEST_F(RecordingFileTest, IsNotWrittenToWhatIsNoFile) {
  ASSERT_EQ(::mkfifo(path("fifo").c_str(), 0600), 0);
  fs::create_symlink(path("nowhere"), path("dangling"));
  EXPECT_THAT(writing(path("fifo")), HasSubstr("it is a FIFO; name a file"));
  EXPECT_THAT(writing(path("dangling")), HasSubstr("it is a link to nothing"));
  EXPECT_THAT(writing(folder_), HasSubstr("directory"));
  EXPECT_THAT(writing("/no/such/run.stator"), HasSubstr("cannot write /no/such/run.stator"));
  EXPECT_THAT(writing("/dev/full"), HasSubstr("it is a device"));
}

}  // namespace
}  // namespace stator::replay
