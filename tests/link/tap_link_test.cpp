// A TAP interface, of the kernel and on a socket pair: frames, waiting, addresses, refusals.
#include "stator/link/ethernet/tap_link.hpp"

#include <array>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include "link/ethernet_frames.hpp"
#include "link/veth_namespace.hpp"
#include "stator/link/ethernet/open_link.hpp"
#include "stator/link/ethernet/raw_ethernet_link.hpp"

namespace stator::link {
namespace {

using base::SimDuration;
using testing::AllOf;
using testing::HasSubstr;
using namespace base::literals;
using Bytes = std::vector<std::byte>;

constexpr std::uint16_t kIpv4 = 0x0800;

Bytes receive(EthernetLink& link, SimDuration timeout = 10_s) {
  Bytes buffer(kMaximumFrameLength);
  const auto length = link.receive(buffer, timeout);
  EXPECT_TRUE(length) << length.error().text;
  buffer.resize(length ? *length : 0);
  return buffer;
}

/// A link on one end of a socket pair, which keeps frames apart like a TAP.
class TapOnSocketPair : public testing::Test {
 protected:
  std::unique_ptr<TapLink> adopt(const TapOptions& options) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends.data()), 0);
    peer_ = FileDescriptor(ends[1]);
    auto link = TapLink::adopt(FileDescriptor(ends[0]), options);
    EXPECT_TRUE(link) << link.error().text;
    return link ? std::move(*link) : nullptr;
  }
  void peer_sends(const Bytes& frame) const {
    EXPECT_EQ(::write(peer_.get(), frame.data(), frame.size()), static_cast<ssize_t>(frame.size()));
  }
  [[nodiscard]] Bytes peer_receives() const {
    Bytes buffer(2000);
    const ssize_t length = ::recv(peer_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    buffer.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
    return buffer;
  }

  FileDescriptor peer_;
};

class TapWaitTest : public TapOnSocketPair, public testing::WithParamInterface<WaitMode> {};

TEST_P(TapWaitTest, FramesOfEveryLengthPassUnchanged) {
  const auto link = adopt({.interface = "tap", .wait = GetParam()});
  for (const std::size_t length :
       {std::size_t{14}, std::size_t{60}, std::size_t{1514}, std::size_t{1518}}) {
    peer_sends(make_frame(length, 5));
    ASSERT_EQ(receive(*link), make_frame(length, 5)) << length;
    ASSERT_TRUE(link->send(make_frame(length, 9)));
    ASSERT_EQ(peer_receives(), make_frame(length, 9)) << length;
  }
}

TEST_P(TapWaitTest, WithoutAFrameTheWaitEndsWithZero) {
  const auto link = adopt({.interface = "tap", .wait = GetParam()});
  EXPECT_EQ(receive(*link, 0_ns).size(), 0U);
  EXPECT_EQ(receive(*link, 100_us).size(), 0U);
}

TEST_P(TapWaitTest, WakeEndsTheWaitOfAnotherThread) {
  const auto link = adopt({.interface = "tap", .wait = GetParam()});
  std::size_t length = 1;
  std::thread waiting([&] { length = receive(*link, 1000_s).size(); });
  link->wake();
  waiting.join();
  EXPECT_EQ(length, 0U);
}

INSTANTIATE_TEST_SUITE_P(EveryWaitMode, TapWaitTest,
                         testing::Values(WaitMode::block, WaitMode::spin, WaitMode::adaptive));

TEST_F(TapOnSocketPair, FramesOfOtherProtocolsAreLeftOut) {
  const auto link = adopt({.interface = "tap"});
  peer_sends(make_frame(60, 1, kIpv4));
  peer_sends(Bytes(5));
  peer_sends(make_frame(60, 2));
  EXPECT_EQ(receive(*link), make_frame(60, 2));
  EXPECT_EQ(link->statistics().frames_received, 1U);
}

TEST_F(TapOnSocketPair, ForABridgeEveryFrameIsTaken) {
  const auto link = adopt({.interface = "tap", .ether_type = std::nullopt});
  peer_sends(make_frame(60, 1, kIpv4));
  EXPECT_EQ(receive(*link), make_frame(60, 1, kIpv4));
}

TEST_F(TapOnSocketPair, AFullMediumLosesTheFrameAndSaysSo) {
  const auto link = adopt({.interface = "tap"});
  for (int i = 0; i < 100'000; ++i) {
    if (const auto sent = link->send(make_frame(1500)); !sent) {
      EXPECT_EQ(sent.error().code, LinkErrorCode::queue_full);
      EXPECT_EQ(link->statistics().send_errors, 1U);
      return;
    }
  }
  FAIL() << "the socket pair never was full";
}

TEST_F(TapOnSocketPair, FramesOfNoEthernetLengthAreRefusedAndCounted) {
  const auto link = adopt({.interface = "tap"});
  EXPECT_FALSE(link->send(Bytes(13)));
  EXPECT_FALSE(link->send(make_frame(1519)));
  ASSERT_TRUE(link->send(make_frame(60)));
  EXPECT_EQ(link->statistics().send_errors, 2U);
  EXPECT_EQ(link->statistics().frames_sent, 1U);
  EXPECT_EQ(link->statistics().bytes_sent, 60U);
}

TEST(TapLink, ANameThatNoInterfaceCanHaveIsRefused) {
  for (const char* name : {"", "sixteen-letters-", "a/b", "a b", "tap%d"}) {
    const auto link = TapLink::open({.interface = name});
    ASSERT_FALSE(link) << name;
    EXPECT_EQ(link.error().code, LinkErrorCode::invalid_option) << name;
  }
}

/// A TAP interface of the kernel, in a network namespace of the test's own.
class RealTap : public testing::Test {
 protected:
  void SetUp() override {
    std::string reason;
    network_ = VethNamespace::create(reason);
    if (network_ == nullptr) {
      GTEST_SKIP() << reason;
    }
    if (const auto probe = TapLink::open({.interface = "probe0"}); !probe) {
      GTEST_SKIP() << "needs a TAP interface: " << probe.error().text;
    }
  }
  static std::unique_ptr<TapLink> open(const TapOptions& options) {
    auto link = TapLink::open(options);
    EXPECT_TRUE(link) << link.error().text;
    return link ? std::move(*link) : nullptr;
  }
  static LinkError open_error(const std::string& name) {
    const auto link = TapLink::open({.interface = name});
    EXPECT_FALSE(link);
    return link ? LinkError{} : link.error();
  }
  static bool exists(const std::string& name) {
    const auto interfaces = network_interfaces();
    return std::ranges::count(interfaces, name, &NetworkInterface::name) == 1;
  }

  std::unique_ptr<VethNamespace> network_;
};

TEST_F(RealTap, AMasterOnTheInterfaceReachesTheLink) {
  const auto tap = open_link({LinkKind::tap, "tap0", 0}, LinkEnd::slaves, {});
  ASSERT_TRUE(tap) << tap.error().text;
  const auto master = RawEthernetLink::open({.interface = "tap0"});
  ASSERT_TRUE(master) << master.error().text;
  ASSERT_TRUE((*master)->send(make_frame(60, 3)));
  EXPECT_EQ(receive(**tap), make_frame(60, 3));
  ASSERT_TRUE((*tap)->send(make_frame(1514, 4)));
  EXPECT_EQ(receive(**master), make_frame(1514, 4));
}

TEST_F(RealTap, TheInterfaceIsMadeSwitchedOnAndVanishes) {
  auto link = open({.interface = "tap0"});
  const auto interfaces = network_interfaces();
  const auto made = std::ranges::find(interfaces, "tap0", &NetworkInterface::name);
  ASSERT_NE(made, interfaces.end());
  EXPECT_TRUE(made->up);
  link.reset();
  EXPECT_FALSE(exists("tap0"));
}

TEST_F(RealTap, AnInterfaceThatWasMadeBeforeIsUsedAndStays) {
  ASSERT_TRUE(network_->ip("tuntap add dev tap0 mode tap"));
  open({.interface = "tap0"}).reset();
  EXPECT_TRUE(exists("tap0"));
}

TEST_F(RealTap, AnInterfaceHeldBySomebodyElseIsNamed) {
  const auto holder = open({.interface = "tap0"});
  const LinkError error = open_error("tap0");
  EXPECT_EQ(error.code, LinkErrorCode::interface_taken);
  EXPECT_THAT(error.text, AllOf(HasSubstr("tap0"), HasSubstr("another name")));
}

TEST_F(RealTap, AnInterfaceOfAnotherKindIsRefusedWithTheLinkThatReachesIt) {
  const LinkError error = open_error(VethNamespace::kFirst);
  EXPECT_EQ(error.code, LinkErrorCode::interface_taken);
  EXPECT_THAT(error.text, HasSubstr("ethercat:stator0"));
}

TEST_F(RealTap, TheInterfaceGetsItsAddresses) {
  const auto link = open({.interface = "tap0"});
  const auto set = link->set_address({.mac_address = {{0x02, 1, 2, 3, 4, 5}},
                                      .address = {{10, 7, 6, 5}},
                                      .subnet_mask = {{255, 255, 240, 0}}});
  ASSERT_TRUE(set) << set.error().text;
  EXPECT_TRUE(network_->ip("address show dev tap0 | grep -q 'inet 10.7.6.5/20 '"));
  EXPECT_TRUE(network_->ip("link show dev tap0 | grep -q '02:01:02:03:04:05'"));
}

TEST_F(RealTap, WhileItIsSwitchedOffFramesAreRefusedWithTheRemedy) {
  const auto link = open({.interface = "tap0"});
  ASSERT_TRUE(network_->ip("link set tap0 down"));
  const auto sent = link->send(make_frame(60));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, LinkErrorCode::interface_down);
  EXPECT_THAT(sent.error().text, HasSubstr("ip link set dev tap0 up"));
}

}  // namespace
}  // namespace stator::link
