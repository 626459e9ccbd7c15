// Stuff bits, CRC and length of CAN frames against values worked out by hand, and the arbitration
// field.
#include "stator/can/frame_length.hpp"

#include <random>
#include <string_view>

#include <gtest/gtest.h>

#include "stator/can/arbitration.hpp"

namespace stator::can {
namespace {

Frame extended(std::uint32_t identifier, std::initializer_list<unsigned> data) {
  Frame frame = data_frame(identifier, data);
  frame.extended = true;
  return frame;
}

TEST(FrameLength, Crc15_HasTheCheckValueOfItsPolynomial) {
  std::uint16_t crc = 0;
  for (const char letter : std::string_view("123456789")) {
    for (unsigned i = 8; i-- > 0;) {
      crc = crc15_next(crc, static_cast<unsigned>(letter) >> i & 1U);
    }
  }
  EXPECT_EQ(crc, 0x059E);
}

struct Vector {
  Frame frame;
  std::uint16_t crc;
  unsigned unstuffed;
  unsigned stuff;
};

// Worked out by polynomial division on the frame as one long number and by stuffing its digits.
TEST(FrameLength, StuffBitsAndCrcOfKnownFrames) {
  const Vector vectors[] = {
      {data_frame(0x014, {0x01}), 0x7753, 42, 3},
      {data_frame(0x000, {0x01, 0x05}), 0x7CC1, 50, 7},
      {data_frame(0x080, {}), 0x1C05, 34, 4},
      {data_frame(0x601, {0x40, 0, 0x10, 0, 0, 0, 0, 0}), 0x191A, 98, 13},
      {data_frame(0x181, {0x27, 0x06, 0, 0, 0, 0}), 0x7FC3, 82, 9},
      {remote_frame(0x701), 0x3C79, 34, 2},
      {remote_frame(0x701, 8), 0x487E, 34, 2},
      {extended(0x12345678, {0xDE, 0xAD, 0xBE, 0xEF}), 0x331B, 86, 2},
      {extended(0x1FFFFFFF, {255, 255, 255, 255, 255, 255, 255, 255}), 0x1B69, 118, 18},
      {data_frame(0x000, {0, 0, 0, 0, 0, 0, 0, 0}), 0x145B, 98, 16},
      {data_frame(0x555, {0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA}), 0x7DCE, 98, 1},
  };
  for (const Vector& vector : vectors) {
    const FrameBits bits = frame_bits(vector.frame);
    EXPECT_EQ(bits.crc, vector.crc) << std::hex << vector.frame.identifier;
    EXPECT_EQ(bits.unstuffed, vector.unstuffed) << std::hex << vector.frame.identifier;
    EXPECT_EQ(bits.stuff, vector.stuff) << std::hex << vector.frame.identifier;
    EXPECT_EQ(frame_length_in_bits(vector.frame), vector.unstuffed + vector.stuff + 10);
  }
}

TEST(FrameLength, StaysWithinTheBoundsOfTheFormat) {
  std::mt19937 random(5);
  for (int i = 0; i < 20'000; ++i) {
    Frame frame{.identifier = static_cast<std::uint32_t>(random()),
                .extended = random() % 2 == 0,
                .length = static_cast<std::uint8_t>(random() % 9)};
    for (std::byte& byte : frame.data) {
      byte = static_cast<std::byte>(random() % 2 == 0 ? 0 : random());
    }
    const unsigned unstuffed = (frame.extended ? 54U : 34U) + frame.length * 8U;
    const unsigned length = frame_length_in_bits(frame);
    EXPECT_GE(length, unstuffed + 10);
    EXPECT_LE(length, unstuffed + 10 + (unstuffed - 1) / 4);
  }
}

TEST(Arbitration, LowerIdentifierThenDataThenBaseFormatComesFirst) {
  EXPECT_LT(arbitration_field(data_frame(0x080, {})), arbitration_field(data_frame(0x081, {})));
  EXPECT_LT(arbitration_field(data_frame(0x701, {})), arbitration_field(remote_frame(0x701)));
  Frame base_remote = remote_frame(0x123);
  Frame same_start = extended(0x123U << 18U, {});
  EXPECT_LT(arbitration_field(base_remote), arbitration_field(same_start))
      << "the recessive SRR and IDE bits of an extended frame lose even to a remote one";
  Frame extended_remote = same_start;
  extended_remote.remote = true;
  EXPECT_LT(arbitration_field(same_start), arbitration_field(extended_remote));
  EXPECT_LT(arbitration_field(extended_remote), arbitration_field(data_frame(0x124, {})));
  EXPECT_LT(arbitration_field(extended(0x123U << 18U | 5U, {})),
            arbitration_field(extended(0x123U << 18U | 6U, {})));
}

}  // namespace
}  // namespace stator::can
