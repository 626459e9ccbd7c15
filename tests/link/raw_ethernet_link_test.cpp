// A raw socket on a virtual cable: frames of every length, waiting, statistics, and each refusal
// with its remedy.
#include "stator/link/ethernet/raw_ethernet_link.hpp"

#include <array>
#include <atomic>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <signal.h>

#include "base/child_process.hpp"
#include "link/ethernet_frames.hpp"
#include "link/veth_namespace.hpp"

namespace stator::link {
namespace {

using base::SimDuration;
using testing::AllOf;
using testing::HasSubstr;
using namespace base::literals;

class RawEthernetLinkTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string reason;
    veth_ = VethNamespace::create(reason);
    if (veth_ == nullptr) {
      GTEST_SKIP() << reason;
    }
  }

  static std::unique_ptr<RawEthernetLink> open(const char* interface,
                                               WaitMode wait = WaitMode::block) {
    auto link = RawEthernetLink::open({.interface = interface, .wait = wait});
    EXPECT_TRUE(link) << link.error().text;
    return link ? std::move(*link) : nullptr;
  }

  static LinkError open_error(const std::string& interface) {
    const auto link = RawEthernetLink::open({.interface = interface});
    EXPECT_FALSE(link);
    return link ? LinkError{} : link.error();
  }

  static std::vector<std::byte> receive(EthernetLink& link, SimDuration timeout = 10_s) {
    std::vector<std::byte> buffer(kMaximumFrameLength);
    const auto length = link.receive(buffer, timeout);
    EXPECT_TRUE(length) << length.error().text;
    buffer.resize(length ? *length : 0);
    return buffer;
  }

  std::unique_ptr<VethNamespace> veth_;
};

class RawEthernetLinkWaitTest : public RawEthernetLinkTest,
                                public testing::WithParamInterface<WaitMode> {};

TEST_P(RawEthernetLinkWaitTest, FramesOfEveryLengthCrossTheCableUnchanged) {
  const auto first = open(VethNamespace::kFirst, GetParam());
  const auto second = open(VethNamespace::kSecond, GetParam());
  for (const std::size_t length :
       {std::size_t{28}, std::size_t{29}, std::size_t{60}, std::size_t{61}, std::size_t{1514}}) {
    ASSERT_TRUE(first->send(make_frame(length, 5)));
    ASSERT_EQ(receive(*second), make_frame(length, 5)) << length << " bytes";
    ASSERT_TRUE(second->send(make_frame(length, 9)));
    ASSERT_EQ(receive(*first), make_frame(length, 9)) << length << " bytes back";
  }
}

TEST_P(RawEthernetLinkWaitTest, WithoutAFrameTheWaitEndsWithZero) {
  const auto link = open(VethNamespace::kFirst, GetParam());
  EXPECT_EQ(receive(*link, 0_ns).size(), 0U);
  EXPECT_EQ(receive(*link, 100_us).size(), 0U);
}

TEST_P(RawEthernetLinkWaitTest, WakeEndsTheWaitOfAnotherThreadOnce) {
  const auto link = open(VethNamespace::kFirst, GetParam());
  const auto peer = open(VethNamespace::kSecond);
  std::size_t length = 1;
  std::thread waiting([&] { length = receive(*link, 1000_s).size(); });
  link->wake();
  waiting.join();
  EXPECT_EQ(length, 0U);

  ASSERT_TRUE(peer->send(make_frame(60)));
  EXPECT_EQ(receive(*link).size(), 60U);
}

std::string wait_mode_name(const testing::TestParamInfo<WaitMode>& parameter) {
  constexpr std::array kNames{"Block", "Spin", "Adaptive"};
  return kNames[static_cast<std::size_t>(parameter.param)];
}

INSTANTIATE_TEST_SUITE_P(EveryWaitMode, RawEthernetLinkWaitTest,
                         testing::Values(WaitMode::block, WaitMode::spin, WaitMode::adaptive),
                         wait_mode_name);

TEST_F(RawEthernetLinkTest, OwnFramesDoNotComeBack) {
  const auto first = open(VethNamespace::kFirst);
  const auto second = open(VethNamespace::kSecond);
  ASSERT_TRUE(first->send(make_frame(60)));
  ASSERT_EQ(receive(*second).size(), 60U);
  EXPECT_EQ(receive(*first, 0_ns).size(), 0U);
}

TEST_F(RawEthernetLinkTest, FramesOfOtherProtocolsAreLeftToOthers) {
  const auto first = open(VethNamespace::kFirst);
  const auto second = open(VethNamespace::kSecond);
  ASSERT_TRUE(first->send(make_frame(60, 1, 0x0800)));
  ASSERT_TRUE(first->send(make_frame(60, 2)));
  EXPECT_EQ(receive(*second), make_frame(60, 2));
}

TEST_F(RawEthernetLinkTest, StatisticsCountWhatPassed) {
  const auto first = open(VethNamespace::kFirst);
  const auto second = open(VethNamespace::kSecond);
  ASSERT_TRUE(first->send(make_frame(60)));
  ASSERT_TRUE(first->send(make_frame(100)));
  receive(*second);
  EXPECT_EQ(first->statistics().frames_sent, 2U);
  EXPECT_EQ(first->statistics().bytes_sent, 160U);
  EXPECT_EQ(second->statistics().frames_received, 1U);
  EXPECT_EQ(second->statistics().bytes_received, 60U);
}

TEST_F(RawEthernetLinkTest, FramesNobodyTakesAreCountedAsDropped) {
  const auto first = open(VethNamespace::kFirst);
  const auto second = open(VethNamespace::kSecond);
  const auto frame = make_frame(1514);
  for (int i = 0; i < 5'000; ++i) {
    static_cast<void>(first->send(frame));
  }
  EXPECT_GT(second->statistics().frames_dropped, 0U);
}

TEST_F(RawEthernetLinkTest, ASignalEndsASleepingWait) {
  struct sigaction action {};
  action.sa_handler = [](int) {};
  struct sigaction previous {};
  ::sigaction(SIGUSR1, &action, &previous);

  const auto link = open(VethNamespace::kFirst);
  std::atomic<bool> ended = false;
  std::thread waiting([&] {
    receive(*link, 1000_s);
    ended = true;
  });
  // The signal may come before the thread sleeps, hence again until it has ended.
  while (!ended) {
    ::pthread_kill(waiting.native_handle(), SIGUSR1);
    std::this_thread::yield();
  }
  waiting.join();
  ::sigaction(SIGUSR1, &previous, nullptr);
}

TEST_F(RawEthernetLinkTest, AMissingInterfaceIsNamedTogetherWithThoseThatExist) {
  const LinkError error = open_error("eth77");
  EXPECT_EQ(error.code, LinkErrorCode::interface_missing);
  EXPECT_THAT(error.text, AllOf(HasSubstr("\"eth77\""), HasSubstr("stator0"), HasSubstr("lo")));
  EXPECT_EQ(open_error("").code, LinkErrorCode::interface_missing);
  EXPECT_EQ(open_error("a-name-much-longer-than-the-kernel-allows").code,
            LinkErrorCode::interface_missing);
}

TEST_F(RawEthernetLinkTest, AnInterfaceThatIsDownIsRefusedWithTheRemedy) {
  ASSERT_TRUE(veth_->ip("link set stator0 down"));
  const LinkError error = open_error("stator0");
  EXPECT_EQ(error.code, LinkErrorCode::interface_down);
  EXPECT_THAT(error.text, HasSubstr("ip link set dev stator0 up"));
}

TEST_F(RawEthernetLinkTest, AnInterfaceThatIsNotEthernetIsRefused) {
  ASSERT_TRUE(veth_->ip("link set lo up"));
  const LinkError error = open_error("lo");
  EXPECT_EQ(error.code, LinkErrorCode::invalid_option);
  EXPECT_THAT(error.text, HasSubstr("not an Ethernet interface"));
}

TEST_F(RawEthernetLinkTest, AnInterfaceSwitchedOffMeanwhileIsReportedAndCanComeBack) {
  const auto first = open(VethNamespace::kFirst);
  const auto second = open(VethNamespace::kSecond);
  ASSERT_TRUE(veth_->ip("link set stator0 down"));

  std::array<std::byte, kMaximumFrameLength> buffer;
  const auto received = first->receive(buffer, 1_s);
  ASSERT_FALSE(received);
  EXPECT_EQ(received.error().code, LinkErrorCode::interface_down);
  const auto sent = first->send(make_frame(60));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, LinkErrorCode::interface_down);
  EXPECT_EQ(first->statistics().send_errors, 1U);

  ASSERT_TRUE(veth_->ip("link set stator0 up"));
  ASSERT_TRUE(veth_->wait_for_carrier());
  ASSERT_TRUE(second->send(make_frame(60)));
  EXPECT_EQ(receive(*first).size(), 60U);
}

TEST_F(RawEthernetLinkTest, AFrameLongerThanTheInterfaceCarriesIsRefused) {
  const auto link = open(VethNamespace::kFirst);
  const auto sent = link->send(make_frame(4000));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, LinkErrorCode::frame_length);
  EXPECT_THAT(sent.error().text, AllOf(HasSubstr("stator0"), HasSubstr("4000 bytes")));
}

TEST_F(RawEthernetLinkTest, WithoutThePrivilegeTheErrorSaysHowToGrantIt) {
  // In a child process, because privileges given up do not come back.
  std::array<int, 2> channel{};
  ASSERT_EQ(::pipe(channel.data()), 0);
  tests::ChildProcess child = tests::ChildProcess::fork([&] {
    std::string answer = "setresuid failed";
    if (::setresuid(65534, 65534, 65534) == 0) {
      answer = open_error("stator0").text;
    }
    const bool written = ::write(channel[1], answer.data(), answer.size()) > 0;
    ::_exit(written ? 0 : 1);
  });
  ::close(channel[1]);
  std::array<char, 1024> text{};
  const ssize_t length = ::read(channel[0], text.data(), text.size());
  ::close(channel[0]);
  EXPECT_EQ(child.wait(), 0);
  const std::string answer(text.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
  if (answer == "setresuid failed") {
    GTEST_SKIP() << "needs a second user to change to; run as root";
  }
  EXPECT_THAT(answer, AllOf(HasSubstr("CAP_NET_RAW"), HasSubstr("run as root or"),
                            HasSubstr("sudo setcap cap_net_raw,cap_net_admin+ep /")));
}

TEST_F(RawEthernetLinkTest, TheInterfaceAddressIsThatOfTheSystem) {
  ASSERT_TRUE(veth_->ip("link set stator0 address 02:11:22:33:44:55"));
  const std::array<std::uint8_t, 6> expected{0x02, 0x11, 0x22, 0x33, 0x44, 0x55};
  EXPECT_EQ(open(VethNamespace::kFirst)->mac_address(), expected);
}

}  // namespace
}  // namespace stator::link
