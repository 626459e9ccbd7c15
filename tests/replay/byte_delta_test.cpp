// The coding of bytes by what differs from those before, as snapshots are kept.
#include "stator/replay/byte_delta.hpp"

#include <random>

#include <gtest/gtest.h>

namespace stator::replay {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::initializer_list<unsigned> values) {
  Bytes bytes;
  for (const unsigned value : values) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  return bytes;
}

Bytes delta(const Bytes& known, const Bytes& bytes) {
  Bytes written;
  ByteWriter writer(written);
  write_delta(writer, known, bytes);
  return written;
}

TEST(ByteDelta, EqualBytesTakeNearlyNothing) {
  const Bytes frame(1000, std::byte{0x5A});
  EXPECT_LE(delta(frame, frame).size(), 3U);
}

TEST(ByteDelta, GivesBackWhatWasWritten) {
  std::mt19937 random(1);  // NOLINT: the same in each run
  for (int round = 0; round < 2000; ++round) {
    Bytes known(random() % 80);
    Bytes bytes(random() % 80);
    for (std::byte& byte : known) {
      byte = static_cast<std::byte>(random() % 3);
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      bytes[i] =
          i < known.size() && random() % 4 != 0 ? known[i] : static_cast<std::byte>(random() % 256);
    }
    const Bytes written = delta(known, bytes);
    ByteReader reader(written);
    Bytes got;
    ASSERT_TRUE(read_delta(reader, known, 100, got));
    EXPECT_EQ(got, bytes);
    EXPECT_TRUE(reader.at_end());
  }
}

TEST(ByteDelta, RefusesWhatMakesNoSense) {
  const Bytes known(4);
  Bytes got;
  for (const Bytes& nonsense : {bytes_of({5, 0x80}),                 // a number without end
                                bytes_of({4, 2, 4, 1, 2, 3, 4, 0}),  // goes beyond the length
                                bytes_of({4, 9, 0, 0}),              // skips beyond it
                                bytes_of({101, 0}),                  // longer than allowed
                                bytes_of({4, 1, 3, 1})}) {           // cut off
    ByteReader reader(nonsense);
    EXPECT_FALSE(read_delta(reader, known, 100, got));
    EXPECT_FALSE(reader.good());
  }
}

}  // namespace
}  // namespace stator::replay
