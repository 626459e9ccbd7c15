// CAN frames as the MessagePack maps of python-can's UDP multicast, malformed ones included.
#include "stator/link/can/multicast_message.hpp"

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "stator/link/can/message_pack.hpp"

namespace stator::link {
namespace {

using namespace base::literals;

std::span<const std::byte> bytes(std::string_view text) {
  return std::as_bytes(std::span(text));
}

/// A value as it is on the wire.
std::string raw(std::initializer_list<unsigned> bytes) {
  std::string text;
  for (const unsigned each : bytes) {
    text.push_back(static_cast<char>(each));
  }
  return text;
}

/// A datagram of named values.
std::string datagram(const std::vector<std::pair<std::string, std::string>>& fields) {
  std::string text;
  text.push_back(static_cast<char>(0x80 + fields.size()));
  for (const auto& [name, value] : fields) {
    text.push_back(static_cast<char>(0xA0 + name.size()));
    text.append(name);
    text.append(value);
  }
  return text;
}

const std::string kFalse = raw({0xC2});
const std::string kTrue = raw({0xC3});
const std::string kOneByte = raw({0xC4, 1, 0x2A});

TEST(MulticastMessage, IsTheMapThatPythonCanSends) {
  const auto message = encode_multicast(can::data_frame(0x123, {1, 2}), base::SimTime(1'500_ms));
  const auto content = message.content();
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(content.data()), content.size()),
            datagram({{"timestamp", raw({0xCB, 0x3F, 0xF8, 0, 0, 0, 0, 0, 0})},
                      {"arbitration_id", raw({0xCD, 0x01, 0x23})},
                      {"is_extended_id", kFalse},
                      {"is_remote_frame", kFalse},
                      {"is_error_frame", kFalse},
                      {"channel", raw({0xC0})},
                      {"dlc", raw({2})},
                      {"data", raw({0xC4, 2, 1, 2})},
                      {"is_fd", kFalse},
                      {"bitrate_switch", kFalse},
                      {"error_state_indicator", kFalse}}));
}

TEST(MulticastMessage, FramesOfAllKindsComeBackAsTheyWere) {
  for (const std::uint32_t identifier : {0x0U, 0x7FU, 0x80U, 0x7FFU, 0x10000U, 0x1FFFFFFFU}) {
    can::Frame frame = can::data_frame(identifier, {0xF0, 0, 0x80, 1, 2, 3, 4, 5});
    frame.extended = identifier > 0x7FF;
    const auto decoded = decode_multicast(encode_multicast(frame, {}).content());
    EXPECT_EQ(decoded.content, MulticastContent::frame);
    EXPECT_EQ(decoded.frame, frame);
  }
  const can::Frame remote = can::remote_frame(0x701, 1);
  EXPECT_EQ(decode_multicast(encode_multicast(remote, {}).content()).frame, remote);
}

TEST(MulticastMessage, AbsentFieldsHaveTheDefaultsOfPythonCan) {
  const auto decoded =
      decode_multicast(bytes(datagram({{"arbitration_id", raw({5})}, {"data", kOneByte}})));
  EXPECT_EQ(decoded.content, MulticastContent::frame);
  EXPECT_TRUE(decoded.frame.extended);
  EXPECT_EQ(decoded.frame.length, 1);
}

TEST(MulticastMessage, UnknownFieldsOfAnyTypeArePassedOver) {
  const std::string nested =
      raw({0x82, 0xA1, 'a', 0x93, 1, 0xC0, 0xCA, 1, 2, 3, 4, 0xA1, 'b', 0x81, 0xA0, 0xC0});
  const auto decoded = decode_multicast(bytes(datagram({{"more", nested},
                                                        {"is_extended_id", kFalse},
                                                        {"arbitration_id", raw({5})},
                                                        {"dlc", raw({0})}})));
  EXPECT_EQ(decoded.content, MulticastContent::frame);
  EXPECT_EQ(decoded.frame, can::data_frame(5, {}));
}

TEST(MulticastMessage, ErrorFramesAndFlexibleDataRateAreNotForTheBus) {
  EXPECT_EQ(decode_multicast(encode_multicast(bus_error_frame(), {}).content()).content,
            MulticastContent::error_frame);
  EXPECT_EQ(decode_multicast(bytes(datagram({{"is_fd", kTrue}}))).content,
            MulticastContent::not_classical);
}

TEST(MulticastMessage, WhatIsNoFrameIsMalformed) {
  const std::vector<std::string> wrong{
      raw({}),
      raw({1}),
      raw({0xC1}),
      datagram({{"arbitration_id", raw({0xCD, 8, 0})}, {"is_extended_id", kFalse}}),
      datagram({{"dlc", raw({9})}, {"data", raw({0xC4, 9, 1, 2, 3, 4, 5, 6, 7, 8, 9})}}),
      datagram({{"dlc", raw({2})}, {"data", kOneByte}}),
      datagram({{"data", raw({0xA1, 0x2A})}}),
      datagram({{"is_remote_frame", kTrue}, {"data", kOneByte}}),
      datagram({{"is_extended_id", raw({1})}}),
      datagram({{"arbitration_id", raw({0xFF})}}),
      datagram({{"dlc", raw({0})}}).append("x")};
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    EXPECT_EQ(decode_multicast(bytes(wrong[i])).content, MulticastContent::malformed) << i;
  }
}

TEST(MulticastMessage, EveryCutOfAMessageIsMalformed) {
  const auto message = encode_multicast(can::data_frame(0x123, {1, 2}), {});
  for (std::size_t size = 0; size < message.size; ++size) {
    EXPECT_EQ(decode_multicast(message.content().first(size)).content, MulticastContent::malformed);
  }
}

TEST(MessagePackReader, NestingTooDeepIsGivenUp) {
  const std::string deep(10'000, static_cast<char>(0x91));
  EXPECT_FALSE(MessagePackReader(bytes(deep)).skip());
}

}  // namespace
}  // namespace stator::link
