// EtherCAT frames in UDP datagrams between a master and slaves, and each refusal with its remedy.
#include "stator/link/ethernet/udp_ethernet_link.hpp"

#include <array>
#include <thread>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include "link/ethernet_frames.hpp"
#include "link/veth_namespace.hpp"
#include "stator/link/ethernet/open_link.hpp"

namespace stator::link {
namespace {

using base::SimDuration;
using testing::AllOf;
using testing::HasSubstr;
using namespace base::literals;
using Bytes = std::vector<std::byte>;

std::unique_ptr<UdpEthernetLink> require(
    base::Expected<std::unique_ptr<UdpEthernetLink>, LinkError> opened) {
  EXPECT_TRUE(opened) << opened.error().text;
  return opened ? std::move(*opened) : nullptr;
}

std::unique_ptr<UdpEthernetLink> slaves(WaitMode wait = WaitMode::block,
                                        const std::string& address = "127.0.0.1") {
  return require(UdpEthernetLink::listen({.address = address, .port = 0, .wait = wait}));
}

std::unique_ptr<UdpEthernetLink> master_of(const UdpEthernetLink& slaves,
                                           WaitMode wait = WaitMode::block,
                                           const std::string& address = "127.0.0.1") {
  return require(
      UdpEthernetLink::connect({.address = address, .port = slaves.local_port(), .wait = wait}));
}

Bytes receive(EthernetLink& link, SimDuration timeout = 10_s) {
  Bytes buffer(kMaximumFrameLength);
  const auto length = link.receive(buffer, timeout);
  EXPECT_TRUE(length) << length.error().text;
  buffer.resize(length ? *length : 0);
  return buffer;
}

Bytes payload_of(const Bytes& frame) {
  return frame.size() < kEthernetHeaderLength
             ? Bytes()
             : Bytes(frame.begin() + kEthernetHeaderLength, frame.end());
}

Bytes header_of(const Bytes& frame) {
  return {frame.begin(), frame.begin() + kEthernetHeaderLength};
}

Bytes bytes(std::initializer_list<unsigned> values) {
  Bytes result;
  for (const unsigned value : values) {
    result.push_back(static_cast<std::byte>(value));
  }
  return result;
}

/// A plain UDP socket, as foreign software has it.
class BareSocket {
 public:
  explicit BareSocket(std::uint16_t peer_port) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    peer_.sin_family = AF_INET;
    peer_.sin_port = htons(peer_port);
    peer_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  void send(const Bytes& payload) const {
    EXPECT_EQ(::sendto(socket_.get(), payload.data(), payload.size(), 0,
                       reinterpret_cast<const sockaddr*>(&peer_), sizeof peer_),
              static_cast<ssize_t>(payload.size()));
  }
  [[nodiscard]] Bytes receive() const {
    Bytes buffer(2000);
    const ssize_t length = ::recv(socket_.get(), buffer.data(), buffer.size(), 0);
    buffer.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
    return buffer;
  }

 private:
  FileDescriptor socket_;
  sockaddr_in peer_{};
};

class UdpEthernetLinkWaitTest : public testing::TestWithParam<WaitMode> {};

TEST_P(UdpEthernetLinkWaitTest, PayloadsOfEveryLengthPassBothWays) {
  const auto far = slaves(GetParam());
  const auto near = master_of(*far, GetParam());
  for (const std::size_t length :
       {std::size_t{14}, std::size_t{16}, std::size_t{60}, std::size_t{1514}, std::size_t{1518}}) {
    ASSERT_TRUE(near->send(make_frame(length, 5)));
    ASSERT_EQ(payload_of(receive(*far)), payload_of(make_frame(length, 5))) << length;
    ASSERT_TRUE(far->send(make_frame(length, 9)));
    ASSERT_EQ(payload_of(receive(*near)), payload_of(make_frame(length, 9))) << length;
  }
}

TEST_P(UdpEthernetLinkWaitTest, WithoutAFrameTheWaitEndsWithZero) {
  const auto link = slaves(GetParam());
  EXPECT_EQ(receive(*link, 0_ns).size(), 0U);
  EXPECT_EQ(receive(*link, 100_us).size(), 0U);
}

TEST_P(UdpEthernetLinkWaitTest, WakeEndsTheWaitOfAnotherThread) {
  const auto link = slaves(GetParam());
  std::size_t length = 1;
  std::thread waiting([&] { length = receive(*link, 1000_s).size(); });
  link->wake();
  waiting.join();
  EXPECT_EQ(length, 0U);
}

INSTANTIATE_TEST_SUITE_P(EveryWaitMode, UdpEthernetLinkWaitTest,
                         testing::Values(WaitMode::block, WaitMode::spin, WaitMode::adaptive));

TEST(UdpEthernetLink, TheDatagramIsTheFrameWithoutItsEthernetHeader) {
  const auto link = slaves();
  const BareSocket foreign(link->local_port());
  foreign.send(bytes({0x0D, 0x10, 0x07}));
  EXPECT_EQ(payload_of(receive(*link)), bytes({0x0D, 0x10, 0x07}));
  ASSERT_TRUE(link->send(make_frame(40)));
  EXPECT_EQ(foreign.receive(), payload_of(make_frame(40)));
}

TEST(UdpEthernetLink, TheHeaderMadeAroundItNamesSenderAndDirection) {
  const auto far = slaves();
  const auto near = master_of(*far);
  ASSERT_TRUE(near->send(make_frame(60)));
  EXPECT_EQ(header_of(receive(*far)),
            bytes({0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 127, 0, 0, 1, 0x88, 0xA4}));
  ASSERT_TRUE(far->send(make_frame(60)));
  EXPECT_EQ(header_of(receive(*near)),
            bytes({0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 2, 0, 127, 0, 0, 1, 0x88, 0xA4}));
}

TEST(UdpEthernetLink, AnswersGoToWhoSentTheLastFrame) {
  const auto link = slaves();
  const BareSocket first(link->local_port());
  const BareSocket second(link->local_port());
  first.send(Bytes(20));
  receive(*link);
  ASSERT_TRUE(link->send(make_frame(40, 1)));
  second.send(Bytes(20));
  receive(*link);
  ASSERT_TRUE(link->send(make_frame(40, 2)));
  EXPECT_EQ(first.receive(), payload_of(make_frame(40, 1)));
  EXPECT_EQ(second.receive(), payload_of(make_frame(40, 2)));
}

TEST(UdpEthernetLink, ListeningAtAllAddresses_AnswersFromTheOneThatWasCalled) {
  // 127.0.0.5 is this machine, too; a connected master would not take an answer from 127.0.0.1.
  const auto far = slaves(WaitMode::block, "0.0.0.0");
  const auto near = master_of(*far, WaitMode::block, "127.0.0.5");
  ASSERT_TRUE(near->send(make_frame(60)));
  receive(*far);
  ASSERT_TRUE(far->send(make_frame(60, 3)));
  EXPECT_EQ(payload_of(receive(*near)), payload_of(make_frame(60, 3)));
}

TEST(UdpEthernetLink, ABroadcastReachesTheSlavesAndTheAnswerTheMaster) {
  std::string reason;
  const auto network = VethNamespace::create(reason);
  if (network == nullptr) {
    GTEST_SKIP() << reason;
  }
  ASSERT_TRUE(network->ip("address add 10.9.8.1/24 dev stator0") && network->ip("link set lo up"));
  // A broadcast comes back to the sockets of the sending machine.
  const auto far = slaves(WaitMode::block, "0.0.0.0");
  const auto near = master_of(*far, WaitMode::block, "10.9.8.255");
  ASSERT_TRUE(near->send(make_frame(60, 4)));
  EXPECT_EQ(payload_of(receive(*far)), payload_of(make_frame(60, 4)));
  ASSERT_TRUE(far->send(make_frame(60, 5)));
  EXPECT_EQ(payload_of(receive(*near)), payload_of(make_frame(60, 5)));
}

TEST(UdpEthernetLink, AnEmptyDatagramIsAFrameWithoutPayload) {
  const auto link = slaves();
  const BareSocket foreign(link->local_port());
  foreign.send({});
  EXPECT_EQ(receive(*link).size(), kEthernetHeaderLength);
}

TEST(UdpEthernetLink, StatisticsCountFramesWithTheirHeaders) {
  const auto far = slaves();
  const auto near = master_of(*far);
  ASSERT_TRUE(near->send(make_frame(60)));
  receive(*far);
  ASSERT_TRUE(far->send(make_frame(50)));
  EXPECT_FALSE(far->send(Bytes(13)));
  EXPECT_FALSE(far->send(make_frame(1519)));
  const LinkStatistics statistics = far->statistics();
  EXPECT_EQ(statistics.frames_received, 1U);
  EXPECT_EQ(statistics.bytes_received, 60U);
  EXPECT_EQ(statistics.frames_sent, 1U);
  EXPECT_EQ(statistics.bytes_sent, 50U);
  EXPECT_EQ(statistics.send_errors, 2U);
  EXPECT_EQ(statistics.frames_dropped, 0U);
}

TEST(UdpEthernetLink, BeforeAnyFrameThereIsNobodyToAnswer) {
  const auto link = slaves();
  const auto sent = link->send(make_frame(60));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, LinkErrorCode::peer_missing);
}

TEST(UdpEthernetLink, AMasterIsToldThatNobodyListens) {
  auto far = slaves();
  const auto near = master_of(*far);
  far.reset();
  ASSERT_TRUE(near->send(make_frame(60)));
  Bytes buffer(kMaximumFrameLength);
  const auto received = near->receive(buffer, 10_s);
  ASSERT_FALSE(received);
  EXPECT_EQ(received.error().code, LinkErrorCode::peer_missing);
  EXPECT_THAT(received.error().text, HasSubstr("stator run"));
}

TEST(UdpEthernetLink, APortInUseIsNamedWithTheRemedy) {
  const auto link = slaves();
  const auto second = UdpEthernetLink::listen({.address = "127.0.0.1", .port = link->local_port()});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, LinkErrorCode::address_in_use);
  EXPECT_THAT(second.error().text,
              AllOf(HasSubstr(std::to_string(link->local_port())), HasSubstr("another port")));
}

TEST(UdpEthernetLink, AnAddressOfAnotherMachineIsRefusedWithThoseOfThisOne) {
  const auto link = UdpEthernetLink::listen({.address = "192.0.2.1"});
  ASSERT_FALSE(link);
  EXPECT_EQ(link.error().code, LinkErrorCode::address_missing);
  EXPECT_THAT(link.error().text, HasSubstr("127.0.0.1"));
}

TEST(UdpEthernetLink, WhatIsNoAddressIsRefused) {
  const auto link = UdpEthernetLink::connect({.address = "drive.local"});
  ASSERT_FALSE(link);
  EXPECT_EQ(link.error().code, LinkErrorCode::invalid_option);
}

TEST(UdpEthernetLink, OpenLinkMakesBothEnds) {
  const auto probe = slaves();
  const LinkAddress free{LinkKind::udp, "127.0.0.2", probe->local_port()};
  const auto far = open_link(free, LinkEnd::slaves, {});
  const auto near = open_link(free, LinkEnd::master, {});
  ASSERT_TRUE(far && near);
  EXPECT_EQ((*far)->name(), to_text(free));
  ASSERT_TRUE((*near)->send(make_frame(60)));
  EXPECT_EQ(receive(**far).size(), 60U);
}

}  // namespace
}  // namespace stator::link
