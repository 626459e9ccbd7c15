#include "stator/link/serial/tcp_serial_link.hpp"

#include <array>
#include <chrono>
#include <optional>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace stator::link {
namespace {

using namespace base::literals;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

/// Every value a byte can have.
Bytes all_values() {
  Bytes bytes(256);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::byte>(i);
  }
  return bytes;
}

class TcpSerialLinkTest : public testing::TestWithParam<WaitMode> {
 protected:
  void open(WaitMode wait = WaitMode::block) {
    auto opened = TcpSerialLink::open("127.0.0.1", 0, {.wait = wait, .spin_time = 100_us});
    ASSERT_TRUE(opened) << opened.error().text;
    link_ = std::move(*opened);
  }
  [[nodiscard]] FileDescriptor client() const {
    FileDescriptor socket(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(link_->port());
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
    return socket;
  }
  static void send(const FileDescriptor& client, const Bytes& bytes) {
    EXPECT_EQ(::write(client.get(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }
  /// What a client reads until it has `length` bytes, or until its connection is closed.
  static Bytes read(const FileDescriptor& client, std::size_t length) {
    Bytes bytes;
    while (bytes.size() < length) {
      pollfd waiting{.fd = client.get(), .events = POLLIN, .revents = 0};
      std::array<std::byte, 256> buffer{};
      const ssize_t got =
          ::poll(&waiting, 1, 10'000) > 0 ? ::read(client.get(), buffer.data(), buffer.size()) : -1;
      if (got <= 0) {
        EXPECT_EQ(got, 0) << "only " << bytes.size() << " bytes came";
        break;
      }
      bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + got);
    }
    return bytes;
  }
  /// What the link receives until it has `length` bytes.
  [[nodiscard]] Bytes receive(std::size_t length) const {
    Bytes bytes;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (bytes.size() < length && std::chrono::steady_clock::now() < deadline) {
      std::array<std::byte, 100> buffer{};
      const auto got = link_->receive(buffer, 10_ms);
      if (!got) {
        ADD_FAILURE() << got.error().text;
        break;
      }
      bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*got));
    }
    return bytes;
  }
  /// Lets the link find what happened to its connections; nothing is received.
  void look() const {
    std::array<std::byte, 16> buffer{};
    for (int i = 0; i < 3; ++i) {
      const auto got = link_->receive(buffer, 1_ms);
      EXPECT_TRUE(got && *got == 0);
    }
  }

  std::unique_ptr<TcpSerialLink> link_;
};

TEST_P(TcpSerialLinkTest, BytesOfEveryValuePassBothWaysUnchanged) {
  open(GetParam());
  EXPECT_EQ(link_->name(), "127.0.0.1:" + std::to_string(link_->port()));
  const FileDescriptor program = client();
  send(program, all_values());
  EXPECT_EQ(receive(256), all_values());
  ASSERT_TRUE(link_->send(all_values()));
  EXPECT_EQ(read(program, 256), all_values());
  EXPECT_EQ(link_->statistics().bytes_received, 256U);
  EXPECT_EQ(link_->statistics().bytes_sent, 256U);
  EXPECT_EQ(link_->statistics().bytes_dropped, 0U);
}
INSTANTIATE_TEST_SUITE_P(Modes, TcpSerialLinkTest,
                         testing::Values(WaitMode::block, WaitMode::spin, WaitMode::adaptive));

TEST_F(TcpSerialLinkTest, WhatAProgramSentBeforeItEndedIsReceivedAndTheNextIsServed) {
  open();
  for (unsigned i = 1; i <= 3; ++i) {
    {
      const FileDescriptor program = client();
      send(program, all_values());
    }
    EXPECT_EQ(receive(256), all_values());
    const FileDescriptor again = client();
    send(again, {std::byte{1}});
    EXPECT_EQ(receive(1), Bytes{std::byte{1}});
    ASSERT_TRUE(link_->send(all_values()));
    EXPECT_EQ(read(again, 256), all_values());
    EXPECT_EQ(link_->clients(), 2 * i);
  }
}

TEST_F(TcpSerialLinkTest, TheNewestProgramGetsTheLine) {
  open();
  const FileDescriptor first = client();
  send(first, {std::byte{1}});
  EXPECT_EQ(receive(1), Bytes{std::byte{1}});
  const FileDescriptor second = client();
  look();
  ASSERT_TRUE(link_->send({{std::byte{7}}}));
  EXPECT_EQ(read(second, 1), Bytes{std::byte{7}});
  EXPECT_EQ(read(first, 1), Bytes()) << "its connection is closed";
}

TEST_F(TcpSerialLinkTest, WhatIsSentWhileNobodyIsConnectedIsDropped) {
  open();
  ASSERT_TRUE(link_->send(all_values()));
  { const FileDescriptor gone = client(); }
  look();
  ASSERT_TRUE(link_->send(all_values()));
  EXPECT_EQ(link_->statistics().bytes_dropped, 512U);
  const FileDescriptor program = client();
  look();
  ASSERT_TRUE(link_->send({{std::byte{7}}}));
  EXPECT_EQ(read(program, 1), Bytes{std::byte{7}}) << "nothing of what was sent before";
}

TEST_F(TcpSerialLinkTest, AProgramThatDoesNotReadLosesBytes) {
  open();
  const FileDescriptor program = client();
  look();
  base::Expected<void, LinkError> sent;
  for (int i = 0; i < 1'000'000 && sent; ++i) {
    sent = link_->send(all_values());
  }
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, LinkErrorCode::queue_full);
  EXPECT_EQ(link_->statistics().bytes_dropped, 256U);
}

TEST_F(TcpSerialLinkTest, WakeEndsTheWait) {
  open();
  link_->wake();
  std::array<std::byte, 16> buffer{};
  const auto nothing = link_->receive(buffer, 3'600_s);
  ASSERT_TRUE(nothing);
  EXPECT_EQ(*nothing, 0U);
}

TEST_F(TcpSerialLinkTest, APortThatIsTakenIsExplained) {
  open();
  const auto second = open_serial_link("tcp:" + link_->name());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, LinkErrorCode::address_in_use);
  EXPECT_THAT(second.error().text, HasSubstr("another program listens at TCP port"));
}

TEST(SerialLinkAddress, IsReadAsPeopleWriteIt) {
  const auto port_only = parse_serial_link("tcp:4001");
  ASSERT_TRUE(port_only);
  EXPECT_EQ(port_only->kind, SerialLinkKind::tcp);
  EXPECT_EQ(port_only->name, "127.0.0.1");
  EXPECT_EQ(port_only->port, 4001);
  const auto everywhere = parse_serial_link("tcp:0.0.0.0:4001");
  ASSERT_TRUE(everywhere);
  EXPECT_EQ(everywhere->name, "0.0.0.0");
  const auto path = parse_serial_link("pty:/tmp/a:b");
  ASSERT_TRUE(path);
  EXPECT_EQ(path->kind, SerialLinkKind::pty);
  EXPECT_EQ(path->name, "/tmp/a:b");
}

TEST(SerialLinkAddress, MistakesAreExplained) {
  const auto refusal_of = [](const char* text) {
    const auto parsed = parse_serial_link(text);
    return parsed ? std::string("accepted") : parsed.error().text;
  };
  for (const char* text : {"", "pty:", "pty", "/dev/ttyS0", "udp:1", "tcp"}) {
    EXPECT_THAT(refusal_of(text), HasSubstr("write pty:PATH or tcp:[ADDRESS:]PORT")) << text;
  }
  for (const char* text : {"tcp:localhost:1", "tcp::1", "tcp:1.2.3:1"}) {
    EXPECT_THAT(refusal_of(text), HasSubstr("needs an IPv4 address")) << text;
  }
  for (const char* text : {"tcp:", "tcp:65536", "tcp:x", "tcp:127.0.0.1:", "tcp:-1", "tcp:1x"}) {
    EXPECT_THAT(refusal_of(text), HasSubstr("needs a port from 1 to 65535")) << text;
  }
}

}  // namespace
}  // namespace stator::link
