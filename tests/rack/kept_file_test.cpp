// The format of files in a state directory: checksums, changes, and every kind of damage.
#include "stator/rack/kept/kept_file.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/base/byte_order.hpp"
#include "stator/base/crc32.hpp"
#include "stator/base/random.hpp"
#include "stator/rack/kept/kept_file_reading.hpp"

namespace stator::rack {
namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

Bytes filled(std::size_t size, int value) {
  return Bytes(size, static_cast<std::byte>(value));
}

Bytes random_bytes(base::Random& random, std::size_t size) {
  Bytes bytes(size);
  std::ranges::generate(bytes, [&random] { return static_cast<std::byte>(random.next()); });
  return bytes;
}

std::string failure(const Bytes& file) {
  LogEnd end;
  const auto kept = read_kept_file(file, end);
  return kept ? "none" : kept.error();
}

/// A file and what it held from its first content to the last, with the length it had then.
struct History {
  Bytes file;
  std::vector<Bytes> contents;
  std::vector<std::size_t> lengths;

  explicit History(const Bytes& first) : file(encode("eeprom", "X", first)), contents{first} {
    static_cast<void>(decode(file, end));
    lengths.push_back(file.size());
  }
  void change(const Bytes& content) {
    const Bytes record = encode_change(contents.back(), content, end);
    file.insert(file.end(), record.begin(), record.end());
    contents.push_back(content);
    lengths.push_back(file.size());
  }

  LogEnd end;
};

/// Contents that differ in a few bytes, in all of them, and in length.
History random_history(std::uint64_t seed, int changes) {
  base::Random random(seed);
  History history(random_bytes(random, random.below(60)));
  for (int i = 0; i < changes; ++i) {
    Bytes content = history.contents.back();
    switch (random.below(4)) {
      case 0:
        content = random_bytes(random, random.below(60));
        break;
      case 1:
        content.resize(random.below(60));
        break;
      default:
        for (std::byte& byte : content) {
          if (random.below(8) == 0) {
            byte = static_cast<std::byte>(random.next());
          }
        }
    }
    history.change(content);
  }
  return history;
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
    const Bytes content = random_bytes(random, size);
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
    const auto bytes = std::as_bytes(std::span(text));
    EXPECT_THAT(failure({bytes.begin(), bytes.end()}), HasSubstr("no file that Stator has kept"))
        << text;
  }
}

TEST(KeptFile, EveryShorterOrLongerFile_IsRefused) {
  const Bytes file = encode("eeprom", "X", filled(100, 7));
  for (std::size_t size = 0; size < file.size(); ++size) {
    EXPECT_NE(failure({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)}), "none")
        << size;
  }
  Bytes longer = file;
  longer.push_back(std::byte{7});
  EXPECT_THAT(failure(longer), HasSubstr("change 1 of its content, at byte 131, is no record"));
}

TEST(KeptFile, EveryFlippedBitOfTheContent_IsNoticed) {
  const Bytes file = encode("eeprom", "X", filled(16, 7));
  const std::size_t content = file.size() - 16;
  for (std::size_t bit = content * 8; bit < file.size() * 8; ++bit) {
    Bytes damaged = file;
    damaged[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
    EXPECT_THAT(failure(damaged), HasSubstr("CRC-32"));
  }
}

TEST(KeptFile, BytesOfADamagedFirstLine_AreNotSaid) {
  for (const char* product : {"\x1b[2J\x1b]0;gone\x07", "\xff\xfe", "a\rb"}) {
    EXPECT_THAT(failure(encode("eeprom", product, {})),
                AllOf(HasSubstr("bytes that are no text"), Each(testing::Ge(' '))))
        << product;
  }
}

TEST(KeptFileChanges, OfAnySizeAndPlace_LeadToTheNewestContent) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const History history = random_history(seed, 20);
    LogEnd end;
    EXPECT_EQ(decode(history.file, end).content, history.contents.back()) << "seed " << seed;
    EXPECT_EQ(end.changes, 20U);
    EXPECT_EQ(end.length, history.file.size());
    EXPECT_EQ(end.log, history.file.size() - history.lengths.front());
    EXPECT_EQ(end.check, history.end.check);
  }
}

TEST(KeptFileChanges, TakeTheBytesThatDifferAndAFewMore) {
  Bytes content(4096);
  History history(content);
  content[8] = content[14] = std::byte{1};  // alias and checksum of an SII
  history.change(content);
  EXPECT_EQ(history.lengths[1] - history.lengths[0], 32U + 7 + 1);
  history.change(content);
  EXPECT_EQ(history.lengths[2] - history.lengths[1], 32U + 1) << "nothing differs";
}

// Killed, or out of power: the file ends anywhere.
TEST(KeptFileChanges, CutAnywhere_TheLastWholeOneHolds) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const History history = random_history(seed, 6);
    std::size_t whole = 0;
    for (std::size_t size = history.lengths.front(); size <= history.file.size(); ++size) {
      while (whole + 1 < history.lengths.size() && history.lengths[whole + 1] <= size) {
        ++whole;
      }
      Bytes cut(history.file.begin(), history.file.begin() + static_cast<std::ptrdiff_t>(size));
      LogEnd end;
      ASSERT_EQ(decode(cut, end).content, history.contents[whole]) << seed << ", " << size;
      ASSERT_EQ(end.length, history.lengths[whole]) << "where the next change is to be written";
      // Some file systems give a file its length before its content.
      cut.resize(size + 700);
      ASSERT_EQ(decode(cut).content, history.contents[whole]) << seed << ", zeros from " << size;
    }
  }
}

TEST(KeptFile, DecodingADamagedFile_ThrowsWhatIsWrongWithIt) {
  Bytes damaged = encode("eeprom", "X", filled(10, 1));
  damaged.back() ^= std::byte{1};
  try {
    static_cast<void>(decode(damaged));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("promises CRC-32"));
    EXPECT_EQ(error.what(), failure(damaged));
  }
}

TEST(KeptFileChanges, EveryFlippedBitAnywhere_IsRefused) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const History history = random_history(seed, 6);
    for (std::size_t bit = 0; bit < history.file.size() * 8; ++bit) {
      Bytes damaged = history.file;
      damaged[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
      ASSERT_NE(failure(damaged), "none") << "seed " << seed << ", bit " << bit;
    }
  }
}

TEST(KeptFileChanges, AnyBytesAnywhere_GiveAContentThatWasThereOrAreRefused) {
  base::Random random(99);
  for (int round = 0; round < 20'000; ++round) {
    const History history = random_history(static_cast<std::uint64_t>(round % 50), 5);
    Bytes damaged = history.file;
    const std::size_t begin = random.below(damaged.size());
    const std::size_t count = 1 + random.below(std::min<std::size_t>(64, damaged.size() - begin));
    const bool zeros = random.below(2) == 0;
    for (std::size_t i = begin; i < begin + count; ++i) {
      damaged[i] = zeros ? std::byte{} : static_cast<std::byte>(random.next());
    }
    LogEnd end;
    if (const auto kept = read_kept_file(damaged, end)) {
      ASSERT_NE(std::ranges::find(history.contents, kept->content), history.contents.end())
          << "round " << round;
    }
  }
}

TEST(KeptFileChanges, DamagedOneBeforeWholeOnes_IsNamed) {
  History history(filled(10, 1));
  history.change(filled(10, 2));
  history.change(filled(10, 3));
  history.change(filled(10, 4));
  Bytes damaged = history.file;
  damaged[history.lengths[1] + 32] ^= std::byte{1};
  EXPECT_EQ(failure(damaged),
            "it is damaged: change 2 of its content, at byte 83, does not agree with its checksum");
  damaged = history.file;
  damaged[history.lengths[1] + 16] ^= std::byte{1};
  EXPECT_THAT(failure(damaged), HasSubstr("change 2 of its content, at byte 83, has a header"));
}

TEST(KeptFileChanges, LeftOutOrOfAnotherFile_AreRefused) {
  History history(filled(10, 1));
  history.change(filled(10, 2));
  history.change(filled(10, 3));
  Bytes without = history.file;
  without.erase(without.begin() + static_cast<std::ptrdiff_t>(history.lengths[0]),
                without.begin() + static_cast<std::ptrdiff_t>(history.lengths[1]));
  EXPECT_THAT(failure(without), HasSubstr("change 1 of its content"));
  Bytes other = encode("eeprom", "X", filled(10, 9));
  other.insert(other.end(), history.file.begin() + static_cast<std::ptrdiff_t>(history.lengths[0]),
               history.file.end());
  EXPECT_THAT(failure(other), HasSubstr("change 1 of its content"));
}

// With checksums that hold, so that only its numbers are wrong.
TEST(KeptFileChanges, ThatPromiseMoreThanTheyBring_TakeNoMemory) {
  const std::vector<std::array<std::uint32_t, 3>> wrong = {
      {0xFFFFFFFF, 0xFFFFFFF6, 10},  // gigabytes
      {11, 0, 10},                   // a byte from nowhere
      {1000, 990, 10},               // a gap
      {10, 5, 10},                   // behind the end
      {10, 0xFFFFFFFF, 10},
  };
  for (const auto& [size, offset, count] : wrong) {
    History history(filled(10, 1));
    history.change(filled(10, 2));
    std::byte* const record = history.file.data() + history.lengths[0];
    base::store_le(record + 12, size);
    base::store_le(record + 16, offset);
    base::store_le(record + 20, count);
    base::store_le(record + 28, base::crc32(std::span(record, 28)));
    EXPECT_THAT(failure(history.file), HasSubstr("which had 10")) << size << ' ' << offset;
  }
}

TEST(KeptFile, DeviceNames_MakeFileNamesThatCannotLeaveTheDirectoryOrCollide) {
  EXPECT_EQ(file_name_for("tmcm-3315_2.b"), "tmcm-3315_2.b");
  EXPECT_EQ(file_name_for("../x"), "..%2Fx");
  EXPECT_EQ(file_name_for("a b%20"), "a%20b%2520");
}

}  // namespace
}  // namespace stator::rack
