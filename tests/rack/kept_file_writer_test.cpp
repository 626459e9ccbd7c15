// Files of a state directory while they are written: appended changes, failures, kills, order of
// jobs.
#include "stator/rack/kept/kept_file_writer.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/child_process.hpp"
#include "base/temporary_directory.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/base/random.hpp"
#include "stator/rack/kept/background_writer.hpp"

namespace stator::rack {
namespace {

namespace fs = std::filesystem;

using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

KeptFile eeprom(Bytes content) {
  return {"eeprom", "X", std::move(content)};
}

class KeptFileWriterTest : public testing::Test {
 protected:
  /// What a rack that is started now gets.
  [[nodiscard]] Bytes kept() const { return decode(directory_.read("a").value()).content; }
  [[nodiscard]] Bytes file() const { return directory_.read("a").value(); }
  [[nodiscard]] std::uint64_t inode() const { return directory_.stamp("a").value().number; }
  /// True: another file has taken the old one's place.
  [[nodiscard]] bool replaces(const Bytes& content) {
    const std::uint64_t before = inode();
    writer_.write(eeprom(content));
    return inode() != before;
  }

  tests::TemporaryDirectory temporary_;
  std::string path_ = temporary_.path() + "/state";
  StateDirectory directory_{path_};
  KeptFileWriter writer_{directory_, "a"};
};

TEST_F(KeptFileWriterTest, Changes_AreAppendedAndTheFileStaysInItsPlace) {
  Bytes content(4096);
  writer_.write(eeprom(content));
  const Bytes first = file();
  for (int i = 1; i <= 10; ++i) {
    content[static_cast<std::size_t>(i) * 100] = std::byte{1};
    EXPECT_FALSE(replaces(content));
    EXPECT_EQ(kept(), content);
  }
  EXPECT_EQ(file().size(), first.size() + 10 * 34);
  Bytes whole = file();
  whole.resize(first.size());
  EXPECT_EQ(whole, first);
}

TEST_F(KeptFileWriterTest, FirstChangeAfterAStart_IsAppendedToo) {
  Bytes content(4096);
  writer_.write(eeprom(content));
  KeptFileWriter next(directory_, "a");
  const std::uint64_t before = inode();
  content[7] = std::byte{7};
  next.write(eeprom(content));
  EXPECT_EQ(inode(), before);
  EXPECT_EQ(kept(), content);
}

TEST_F(KeptFileWriterTest, ContentsOfAllLengths_FollowEachOther) {
  base::Random random(22);
  auto writer = std::make_unique<KeptFileWriter>(directory_, "a");
  for (int i = 0; i < 500; ++i) {
    Bytes content(random.below(3000));
    std::ranges::generate(content, [&] { return static_cast<std::byte>(random.below(2)); });
    writer->write(eeprom(content));
    ASSERT_EQ(kept(), content) << i;
    ASSERT_LE(file().size(), 3000U + 100 + kLongestLog) << i;
    if (random.below(50) == 0) {
      writer = std::make_unique<KeptFileWriter>(directory_, "a");  // of the next start
    }
  }
}

TEST_F(KeptFileWriterTest, LongLog_GivesWayToAWholeFile) {
  Bytes content(5000);
  writer_.write(eeprom(content));
  const std::size_t whole = file().size();
  std::size_t longest = 0;
  bool written_anew = false;
  for (int i = 0; i < 40; ++i) {
    std::ranges::fill(content, static_cast<std::byte>(i + 1));
    writer_.write(eeprom(content));
    longest = std::max(longest, file().size());
    written_anew = written_anew || file().size() == whole;
    ASSERT_EQ(kept(), content);
  }
  EXPECT_TRUE(written_anew);
  EXPECT_LE(longest, whole + kLongestLog);
}

TEST_F(KeptFileWriterTest, FileThatSomebodyElseHasTouched_IsReplacedAsAWhole) {
  Bytes content(100, std::byte{1});
  const auto change_and_expect = [&](const char* what) {
    content[3] ^= std::byte{1};
    writer_.write(eeprom(content));
    EXPECT_EQ(file(), encode("eeprom", "X", content)) << what;
  };
  writer_.write(eeprom(content));
  fs::remove(path_ + "/a");
  change_and_expect("removed");
  std::ofstream(path_ + "/a", std::ios::app) << "more";
  change_and_expect("longer");
  fs::remove(path_ + "/a");
  std::ofstream(path_ + "/a") << "something";
  change_and_expect("another one");
  fs::create_hard_link(path_ + "/a", path_ + "/copy");
  const Bytes copy = directory_.read("copy").value();
  change_and_expect("with a second name");
  EXPECT_EQ(directory_.read("copy"), copy);
}

TEST_F(KeptFileWriterTest, DamagedFile_IsNoBaseForAChange) {
  Bytes file = encode("eeprom", "X", Bytes(100));
  file.back() ^= std::byte{1};
  directory_.replace("a", file);
  writer_.write(eeprom(Bytes(100)));
  EXPECT_EQ(kept(), Bytes(100));
}

TEST_F(KeptFileWriterTest, ContentOfAnotherKindOrProduct_IsReplacedAsAWhole) {
  writer_.write(eeprom(Bytes(100)));
  writer_.write({"firmware", "X", Bytes(100)});
  EXPECT_EQ(file(), encode("firmware", "X", Bytes(100)));
  writer_.write({"firmware", "Y", Bytes(100)});
  EXPECT_EQ(file(), encode("firmware", "Y", Bytes(100)));
}

// A process was killed while it appended.
TEST_F(KeptFileWriterTest, PartOfARecord_GivesWayToTheNextOne) {
  Bytes content(300, std::byte{1});
  LogEnd end;
  const Bytes whole = encode("eeprom", "X", content);
  static_cast<void>(decode(whole, end));
  const Bytes record = encode_change(content, Bytes(250, std::byte{2}), end);
  for (const std::size_t part : {std::size_t{1}, std::size_t{12}, std::size_t{40}, record.size()}) {
    Bytes torn = whole;
    torn.insert(torn.end(), record.begin(), record.begin() + static_cast<std::ptrdiff_t>(part));
    directory_.replace("a", torn);
    KeptFileWriter next(directory_, "a");
    const std::uint64_t before = inode();
    content[5] ^= std::byte{1};  // a record shorter than most parts
    next.write(eeprom(content));
    EXPECT_EQ(inode(), before);
    EXPECT_EQ(kept(), content) << part;
    next.write(eeprom(whole));
    EXPECT_EQ(kept(), whole) << part;
    content[5] ^= std::byte{1};
  }
}

TEST_F(KeptFileWriterTest, AfterAFailure_TheFileIsReplacedAsAWhole) {
  Bytes content(100);
  writer_.write(eeprom(content));
  fs::rename(path_, path_ + "-elsewhere");
  EXPECT_THROW(writer_.write(eeprom(Bytes(100, std::byte{1}))), std::runtime_error);
  fs::rename(path_ + "-elsewhere", path_);
  EXPECT_EQ(kept(), content);
  content[9] = std::byte{1};
  writer_.write(eeprom(content));
  EXPECT_EQ(file(), encode("eeprom", "X", content));
}

// Each content begins with its number, which the child announces when the content is kept.
TEST_F(KeptFileWriterTest, KilledAtAnyMoment_WhatWasAnnouncedIsThere) {
  base::Random random(142);
  int later = 0;
  for (int round = 0; round < 60; ++round) {
    int announcements[2];
    ASSERT_EQ(::pipe(announcements), 0);
    tests::ChildProcess child = tests::ChildProcess::fork([&] {
      KeptFileWriter writer(directory_, "a");
      base::Random contents(static_cast<std::uint64_t>(round));
      for (std::uint32_t number = 1;; ++number) {
        Bytes content(4 + contents.below(400), static_cast<std::byte>(number));
        base::store_le(content.data(), number);
        writer.write(eeprom(content));
        if (::write(announcements[1], &number, sizeof number) != sizeof number) {
          ::_exit(1);
        }
      }
    });
    std::uint32_t announced = 0;
    for (std::uint64_t i = 0; i < 1 + random.below(30); ++i) {
      ASSERT_EQ(::read(announcements[0], &announced, sizeof announced), ssize_t{sizeof announced});
    }
    ::usleep(static_cast<useconds_t>(random.below(500)));
    child.signal(SIGKILL);
    child.wait();
    ::close(announcements[1]);
    while (::read(announcements[0], &announced, sizeof announced) == ssize_t{sizeof announced}) {
    }
    ::close(announcements[0]);
    const Bytes content = kept();
    const auto found = base::load_le<std::uint32_t>(content.data());
    ASSERT_TRUE(found == announced || found == announced + 1)
        << "round " << round << ": " << announced << " was announced, " << found << " is there";
    ASSERT_EQ(Bytes(content.begin() + 4, content.end()),
              Bytes(content.size() - 4, static_cast<std::byte>(found)));
    later += found == announced + 1 ? 1 : 0;
  }
  RecordProperty("kills between kept and announced", later);
}

class BackgroundWriterTest : public testing::Test {
 protected:
  tests::TemporaryDirectory temporary_;
  StateDirectory directory_{temporary_.path() + "/state"};
  BackgroundWriter writer_{directory_};
};

TEST_F(BackgroundWriterTest, NewestJobOfEachFile_IsDoneAndStandsForThoseBefore) {
  for (std::uint32_t version = 1; version <= 50; ++version) {
    for (std::size_t owner = 0; owner < 4; ++owner) {
      writer_.write({std::to_string(owner), eeprom(Bytes(100, static_cast<std::byte>(version))),
                     owner, version});
    }
  }
  writer_.wait();
  std::map<std::size_t, std::uint32_t> last;
  for (const auto& result : writer_.take_results()) {
    EXPECT_EQ(result.error, "");
    EXPECT_GT(result.version, last[result.owner]) << "in their order";
    last[result.owner] = result.version;
  }
  for (std::size_t owner = 0; owner < 4; ++owner) {
    EXPECT_EQ(last[owner], 50U);
    EXPECT_EQ(decode(directory_.read(std::to_string(owner)).value()).content,
              Bytes(100, std::byte{50}));
  }
}

TEST_F(BackgroundWriterTest, FileThatIsOrderedOverAndOver_KeepsItsTurn) {
  // While the first is written, the others come; of these "a" comes again and again.
  writer_.write({"large", {"firmware", "X", Bytes(8'000'000)}, 0, 1});
  writer_.write({"a", eeprom(Bytes(10)), 1, 1});
  writer_.write({"b", eeprom(Bytes(10)), 2, 1});
  writer_.write({"a", eeprom(Bytes(20)), 1, 2});
  writer_.wait();
  std::vector<std::size_t> order;
  for (const auto& result : writer_.take_results()) {
    if (order.empty() || order.back() != result.owner) {
      order.push_back(result.owner);
    }
  }
  ASSERT_GE(order.size(), 3U);
  EXPECT_EQ(order[0], 0U);
  EXPECT_EQ(order[1], 1U) << "before b, which came after it";
  EXPECT_EQ(decode(directory_.read("a").value()).content, Bytes(20));
}

TEST_F(BackgroundWriterTest, FailedJob_SaysWhatIsWrong) {
  fs::remove_all(temporary_.path() + "/state");
  writer_.write({"a", eeprom(Bytes(10)), 3, 4});
  writer_.wait();
  const auto results = writer_.take_results();
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].owner, 3U);
  EXPECT_THAT(results[0].error, HasSubstr("there is no such file now"));
}

}  // namespace
}  // namespace stator::rack
