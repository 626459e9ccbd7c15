// The socket for firmware: who gets the chip, who is turned away, and what broken programs do.

#include "stator/link/serial/chip_server.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace stator::link {
namespace {

using base::SimDuration;
using News = ChipServer::News;
using ::testing::HasSubstr;

std::string socket_path() {
  static int number = 0;
  return ::testing::TempDir() + "/stator-chip-" + std::to_string(::getpid()) + "-" +
         std::to_string(++number);
}

FileDescriptor connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  FileDescriptor connection(::socket(AF_UNIX, SOCK_STREAM, 0));
  EXPECT_EQ(
      ::connect(connection.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  return connection;
}

void write(const FileDescriptor& connection, const std::vector<std::byte>& bytes) {
  ASSERT_EQ(::send(connection.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(bytes.size()));
}

std::string read_some(const FileDescriptor& connection) {
  std::array<char, 4096> buffer{};
  const ssize_t length = ::recv(connection.get(), buffer.data(), buffer.size(), 0);
  return {buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0))};
}

std::vector<std::byte> request(std::uint8_t kind, std::size_t length = 0) {
  std::vector<std::byte> out;
  const std::vector<std::byte> body(length);
  append_chip_message(out, {.kind = kind, .tag = 1, .body = body});
  return out;
}

/// News other than nothing, within a generous time.
News next(ChipServer& server, ChipMessage& message) {
  for (int i = 0; i < 200; ++i) {
    const News news = server.receive(message, SimDuration(50'000'000));
    if (news != News::nothing) {
      return news;
    }
  }
  return News::nothing;
}

class ChipServerAtPath : public ::testing::Test {
 protected:
  ChipServerAtPath() : path(socket_path()) {
    auto opened = ChipServer::open("unix:" + path);
    EXPECT_TRUE(opened) << opened.error().text;
    server = std::move(*opened);
  }
  std::string path;
  std::unique_ptr<ChipServer> server;
  ChipMessage message;
};

TEST_F(ChipServerAtPath, ProgramConnectsAsksAndLeaves) {
  FileDescriptor program = connect_to(path);
  EXPECT_EQ(next(*server, message), News::connected);
  write(program, request(3, 5));
  ASSERT_EQ(next(*server, message), News::message);
  EXPECT_EQ(message.kind, 3U);
  EXPECT_EQ(message.body.size(), 5U);
  server->send({.kind = 0x83, .tag = 1});
  EXPECT_EQ(read_some(program), std::string("\0\0\x83\x01", 4));
  program = FileDescriptor();
  EXPECT_EQ(next(*server, message), News::left);
  EXPECT_EQ(server->statistics().programs, 1U);
}

TEST_F(ChipServerAtPath, SecondProgramIsToldWhyAndTheFirstGoesOn) {
  const FileDescriptor first = connect_to(path);
  EXPECT_EQ(next(*server, message), News::connected);
  const FileDescriptor second = connect_to(path);
  EXPECT_EQ(server->receive(message, SimDuration(50'000'000)), News::nothing);
  EXPECT_THAT(read_some(second), HasSubstr("another program has this chip"));
  EXPECT_EQ(read_some(second), "") << "closed";
  write(first, request(3));
  EXPECT_EQ(next(*server, message), News::message);
  EXPECT_EQ(server->statistics().turned_away, 1U);
}

TEST_F(ChipServerAtPath, ProgramStartedAnewWaitsUntilTheLastWordsOfTheOneBeforeAreRead) {
  FileDescriptor first = connect_to(path);
  EXPECT_EQ(next(*server, message), News::connected);
  write(first, request(3, 5));
  first = FileDescriptor();
  const FileDescriptor second = connect_to(path);
  EXPECT_EQ(next(*server, message), News::message);
  EXPECT_EQ(message.body.size(), 5U);
  EXPECT_EQ(next(*server, message), News::left);
  EXPECT_EQ(next(*server, message), News::connected);
  write(second, request(4));
  EXPECT_EQ(next(*server, message), News::message);
  EXPECT_EQ(message.kind, 4U);
  EXPECT_EQ(server->statistics().turned_away, 0U);
}

TEST_F(ChipServerAtPath, MessageThatIsTooLongEndsTheConnection) {
  const FileDescriptor program = connect_to(path);
  EXPECT_EQ(next(*server, message), News::connected);
  write(program, {std::byte{0xFF}, std::byte{0xFF}, std::byte{2}, std::byte{0}});
  EXPECT_EQ(next(*server, message), News::left);
  EXPECT_THAT(read_some(program), HasSubstr("longer than 4100 bytes"));
  EXPECT_EQ(server->statistics().thrown_out, 1U);
  const FileDescriptor next_one = connect_to(path);
  EXPECT_EQ(next(*server, message), News::connected) << "and the next one is let in";
}

TEST_F(ChipServerAtPath, FloodWithoutReadingIsHeldBackAndEventsAreDropped) {
  const FileDescriptor program = connect_to(path);
  EXPECT_EQ(next(*server, message), News::connected);
  server->greeted();
  const std::vector<std::byte> body(4096);
  std::size_t answered = 0;
  const auto asking = request(3);
  for (int i = 0; i < 3000; ++i) {
    static_cast<void>(
        ::send(program.get(), asking.data(), asking.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
    if (server->receive(message, SimDuration()) == News::message) {
      server->send({.kind = 0x83, .tag = 1, .body = body});
      ++answered;
    }
  }
  EXPECT_LT(answered, 1000U) << "unread answers hold requests back";
  EXPECT_FALSE(server->send_event({.kind = 0xC0, .tag = 0, .body = {}}));
  EXPECT_GT(server->statistics().events_lost, 0U);
}

TEST_F(ChipServerAtPath, EventsOfOtherThreadsArriveWhole) {
  const FileDescriptor program = connect_to(path);
  EXPECT_EQ(next(*server, message), News::connected);
  const std::array<std::byte, 16> body{};
  std::thread other([&] {
    for (int i = 0; i < 500; ++i) {
      static_cast<void>(server->send_event({.kind = 0xC0, .tag = 0, .body = body}));
    }
  });
  for (int i = 0; i < 500; ++i) {
    server->send({.kind = 0x83, .tag = 7, .body = body});
  }
  other.join();
  ChipMessageReader reader;
  int whole = 0;
  for (int round = 0; round < 5000 && whole < 1000; ++round) {
    // What the system had no room for goes out while the server looks for news.
    ASSERT_EQ(server->receive(message, SimDuration(1'000'000)), News::nothing);
    const std::span<std::byte> space = reader.space();
    const ssize_t length = ::recv(program.get(), space.data(), space.size(), MSG_DONTWAIT);
    reader.received(static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
    while (const auto each = reader.next()) {
      ASSERT_EQ(each->body.size(), 16U);
      ++whole;
    }
  }
  EXPECT_EQ(whole, 1000);
}

TEST_F(ChipServerAtPath, SocketLeftBehindIsReplacedAServedOneIsNot) {
  const auto second = ChipServer::open("unix:" + path);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().text, HasSubstr("another process listens"));
  server.reset();
  EXPECT_NE(::access(path.c_str(), F_OK), 0) << "removed in the end";
  {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    const FileDescriptor dead(::socket(AF_UNIX, SOCK_STREAM, 0));
    ASSERT_EQ(::bind(dead.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  EXPECT_TRUE(ChipServer::open("unix:" + path));
}

TEST(ChipServer, FileInTheWayStays) {
  const std::string path = socket_path();
  std::ofstream(path) << "precious";
  const auto opened = ChipServer::open("unix:" + path);
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().text, HasSubstr("is a file"));
  EXPECT_EQ(::access(path.c_str(), F_OK), 0);
  ::unlink(path.c_str());
}

TEST(ChipServer, AddressesAreExplained) {
  for (const char* const wrong : {"", "unix:", "tcp:", "tcp:banana", "serial:x"}) {
    const auto opened = ChipServer::open(wrong);
    ASSERT_FALSE(opened) << wrong;
    EXPECT_THAT(opened.error().text, HasSubstr("unix:PATH")) << wrong;
  }
  EXPECT_FALSE(ChipServer::open("unix:" + std::string(200, 'x')));
}

TEST(ChipServer, ListensAtTcpWithAnyFreePort) {
  const auto opened = ChipServer::open("tcp:127.0.0.1:0");
  ASSERT_TRUE(opened) << opened.error().text;
  const std::string& name = (*opened)->name();
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(name.substr(name.rfind(':') + 1))));
  ::inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
  const FileDescriptor program(::socket(AF_INET, SOCK_STREAM, 0));
  ASSERT_EQ(::connect(program.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
            0);
  ChipMessage message;
  EXPECT_EQ(next(**opened, message), News::connected);
}

}  // namespace
}  // namespace stator::link
