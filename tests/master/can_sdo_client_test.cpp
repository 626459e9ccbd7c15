// The SDO client on CAN: expedited and segmented transfers (CiA 301), aborts, silence,
// wrong toggles.
#include "stator/master/can_sdo_client.hpp"

#include <deque>
#include <vector>

#include <gtest/gtest.h>

namespace stator::master {
namespace {

std::vector<std::byte> bytes(std::initializer_list<unsigned> values) {
  std::vector<std::byte> result;
  for (const unsigned value : values) {
    result.push_back(static_cast<std::byte>(value));
  }
  return result;
}

/// Answers what it is told to, and keeps the requests.
struct Node {
  std::vector<std::vector<std::byte>> requests;
  std::deque<std::vector<std::byte>> answers;

  CanSdoClient client() {
    return {5, [this](const can::Frame& request) -> std::optional<can::Frame> {
              EXPECT_EQ(request.identifier, 0x605U);
              requests.emplace_back(request.payload().begin(), request.payload().end());
              if (answers.empty()) {
                return std::nullopt;
              }
              const can::Frame answer = can::data_frame(0x585, answers.front());
              answers.pop_front();
              return answer;
            }};
  }
};

TEST(CanSdoClient, UploadsUpToFourBytesExpedited) {
  Node node{.requests = {}, .answers = {bytes({0x4B, 0x41, 0x60, 0x00, 0x37, 0x02, 0, 0})}};
  const auto data = node.client().upload({0x6041, 0});
  ASSERT_TRUE(data) << data.error().text;
  EXPECT_EQ(*data, bytes({0x37, 0x02}));
  EXPECT_EQ(node.requests[0], bytes({0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0}));
}

TEST(CanSdoClient, UploadsMoreInSegments) {
  Node node{.requests = {},
            .answers = {bytes({0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0}),
                        bytes({0x00, 'T', 'M', 'C', 'M', '-', '3', '3'}),
                        bytes({0x1B, '1', '5', 0, 0, 0, 0, 0})}};
  const auto data = node.client().upload({0x1008, 0});
  ASSERT_TRUE(data) << data.error().text;
  EXPECT_EQ(*data, bytes({'T', 'M', 'C', 'M', '-', '3', '3', '1', '5'}));
  EXPECT_EQ(node.requests[1], bytes({0x60, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(node.requests[2], bytes({0x70, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(CanSdoClient, DownloadsUpToFourBytesExpedited) {
  Node node{.requests = {}, .answers = {bytes({0x60, 0x40, 0x60, 0x00, 0, 0, 0, 0})}};
  ASSERT_TRUE(node.client().download({0x6040, 0}, bytes({0x06, 0x00})));
  EXPECT_EQ(node.requests[0], bytes({0x2B, 0x40, 0x60, 0x00, 0x06, 0x00, 0, 0}));
}

TEST(CanSdoClient, DownloadsMoreInSegments) {
  Node node{.requests = {},
            .answers = {bytes({0x60, 0x00, 0x20, 0x01, 0, 0, 0, 0}),
                        bytes({0x20, 0, 0, 0, 0, 0, 0, 0}), bytes({0x30, 0, 0, 0, 0, 0, 0, 0})}};
  ASSERT_TRUE(node.client().download({0x2000, 1}, bytes({1, 2, 3, 4, 5, 6, 7, 8, 9})));
  EXPECT_EQ(node.requests[0], bytes({0x21, 0x00, 0x20, 0x01, 9, 0, 0, 0}));
  EXPECT_EQ(node.requests[1], bytes({0x00, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(node.requests[2], bytes({0x1B, 8, 9, 0, 0, 0, 0, 0}));
}

TEST(CanSdoClient, TellsAbortCodesSilenceAndNonsense) {
  Node node{.requests = {},
            .answers = {bytes({0x80, 0x40, 0x60, 0x00, 0x30, 0x00, 0x09, 0x06}),
                        bytes({0x20, 0, 0, 0, 0, 0, 0, 0})}};
  const auto aborted = node.client().download({0x6040, 0}, bytes({1, 2}));
  ASSERT_FALSE(aborted);
  EXPECT_EQ(aborted.error().code, ErrorCode::sdo_aborted);
  EXPECT_EQ(aborted.error().detail, 0x06090030U);
  EXPECT_EQ(node.client().download({0x6040, 0}, bytes({1, 2})).error().code, ErrorCode::protocol);
  EXPECT_EQ(node.client().upload({0x6040, 0}).error().code, ErrorCode::mailbox);
}

TEST(CanSdoClient, RefusesAToggleThatDoesNotAlternate) {
  Node node{
      .requests = {},
      .answers = {bytes({0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0}), bytes({0x10, 1, 2, 3, 4, 5, 6, 7})}};
  EXPECT_EQ(node.client().upload({0x1008, 0}).error().code, ErrorCode::protocol);
}

}  // namespace
}  // namespace stator::master
