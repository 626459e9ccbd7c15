// Both ends of one veth cable as the two links: what one sends, the other receives.

#include "stator/link/ethernet/link_pair_receiver.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "link/ethernet_frames.hpp"
#include "link/veth_namespace.hpp"

namespace stator::link {
namespace {

using namespace base::literals;

class LinkPairReceiverTest : public ::testing::TestWithParam<WaitMode> {
 protected:
  void SetUp() override {
    std::string reason;
    veth_ = VethNamespace::create(reason);
    if (veth_ == nullptr) {
      GTEST_SKIP() << reason;
    }
    first = open(VethNamespace::kFirst);
    second = open(VethNamespace::kSecond);
    ASSERT_TRUE(first != nullptr && second != nullptr);
  }
  static std::unique_ptr<RawEthernetLink> open(const char* interface) {
    auto opened = RawEthernetLink::open({.interface = interface});
    return opened ? std::move(*opened) : nullptr;
  }
  /// Link and content of the next frame; link 2 when none came.
  static std::pair<std::size_t, std::vector<std::byte>> next(LinkPairReceiver& receiver,
                                                             base::SimDuration patience = 10_s) {
    std::vector<std::byte> buffer(kMaximumFrameLength);
    const auto received = receiver.receive(buffer, patience);
    EXPECT_TRUE(received) << received.error().text;
    buffer.resize(received ? received->length : 0);
    return {buffer.empty() ? 2 : received->link, buffer};
  }

  std::unique_ptr<VethNamespace> veth_;
  std::unique_ptr<RawEthernetLink> first;
  std::unique_ptr<RawEthernetLink> second;
};

TEST_P(LinkPairReceiverTest, TellsOnWhichLinkAFrameCame) {
  LinkPairReceiver receiver(*first, *second, GetParam(), 200_us);
  ASSERT_TRUE(first->send(make_frame(60, 1)));
  EXPECT_EQ(next(receiver), std::pair(std::size_t{1}, make_frame(60, 1)));
  ASSERT_TRUE(second->send(make_frame(60, 2)));
  EXPECT_EQ(next(receiver), std::pair(std::size_t{0}, make_frame(60, 2)));
  EXPECT_EQ(next(receiver, 100_us).first, 2U);
}

TEST_P(LinkPairReceiverTest, BusyLinks_AreServedInTurn) {
  LinkPairReceiver receiver(*first, *second, GetParam(), 200_us);
  for (unsigned i = 0; i < 3; ++i) {
    ASSERT_TRUE(first->send(make_frame(60, i)));
    ASSERT_TRUE(second->send(make_frame(60, 10 + i)));
  }
  std::vector<std::size_t> order;
  for (int i = 0; i < 6; ++i) {
    order.push_back(next(receiver).first);
  }
  for (std::size_t i = 1; i < order.size(); ++i) {
    EXPECT_NE(order[i], order[i - 1]) << "frame " << i;
  }
}

TEST_P(LinkPairReceiverTest, InterfaceSwitchedOff_IsSilentAndNoError) {
  LinkPairReceiver receiver(*first, *second, GetParam(), 200_us);
  EXPECT_TRUE(first->has_carrier());
  ASSERT_TRUE(veth_->ip("link set stator1 down"));
  EXPECT_EQ(next(receiver, 1_ms).first, 2U);
  // The system tells the other end in the background.
  for (int wait = 0; wait < 200 && (first->has_carrier() || second->has_carrier()); ++wait) {
    EXPECT_EQ(next(receiver, 10_ms).first, 2U);
  }
  EXPECT_FALSE(first->has_carrier());
  EXPECT_FALSE(second->has_carrier());
}

INSTANTIATE_TEST_SUITE_P(WaitModes, LinkPairReceiverTest,
                         ::testing::Values(WaitMode::block, WaitMode::spin, WaitMode::adaptive));

}  // namespace
}  // namespace stator::link
