// CAN ports as real programs use them: slcan over a pseudo-terminal, UDP multicast, can-exec.
#include "stator/link/can/can_link.hpp"

#include <array>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/temporary_directory.hpp"
#include "stator/link/can/can_exec_link.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {
namespace {

using namespace base::literals;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kTimeout = 10'000;  // ms

bool readable(int descriptor, int timeout = kTimeout) {
  pollfd waiting{.fd = descriptor, .events = POLLIN, .revents = 0};
  return ::poll(&waiting, 1, timeout) == 1;
}

/// Remembers events.
class Sink final : public base::EventSink {
 public:
  void on_event(const base::Event& event) override {
    sentences.push_back(base::to_sentence(event));
  }
  std::vector<std::string> sentences;
};

class CanLinkTest : public testing::Test {
 protected:
  std::unique_ptr<CanLink> open(const std::string& text) {
    auto opened =
        open_can_link(text, {.bit_rate = 1'000, .reporter = base::EventReporter(&sink_, 0)});
    EXPECT_TRUE(opened) << opened.error().text;
    return opened ? std::move(*opened) : nullptr;
  }
  std::string error_of(const std::string& text) {
    const auto opened = open_can_link(text);
    EXPECT_FALSE(opened);
    return opened ? "" : opened.error().text;
  }
  /// What programs send until `count` frames have come.
  static std::vector<can::Frame> receive(CanLink& link, std::size_t count) {
    std::vector<can::Frame> frames;
    while (frames.size() < count && readable(link.descriptor())) {
      std::array<can::Frame, 16> buffer;
      std::size_t got = buffer.size();
      while (got == buffer.size()) {
        got = link.receive(buffer, {}).value();
        frames.insert(frames.end(), buffer.begin(),
                      buffer.begin() + static_cast<std::ptrdiff_t>(got));
      }
    }
    return frames;
  }
  /// Lets the link serve connections until `clients` are there.
  static void serve_until_clients(CanLink& link, std::size_t clients) {
    while (link.statistics().clients != clients && readable(link.descriptor())) {
      receive(link, 0);
      std::array<can::Frame, 1> buffer;
      std::ignore = link.receive(buffer, {}).value();
    }
    ASSERT_EQ(link.statistics().clients, clients);
  }
  static FileDescriptor connect(const CanLink& link) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    const std::string port = link.name().substr(link.name().rfind(':') + 1);
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(port)));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    FileDescriptor connection(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(::connect(connection.get(), reinterpret_cast<sockaddr*>(&address), sizeof address),
              0);
    return connection;
  }
  static void say(const FileDescriptor& program, std::string_view text) {
    EXPECT_EQ(::write(program.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  /// What `program` reads until it ends in `end`.
  static std::string hear(const FileDescriptor& program, CanLink& link, std::string_view end) {
    std::string text;
    while (!text.ends_with(end)) {
      std::array<can::Frame, 16> buffer;
      std::ignore = link.receive(buffer, {}).value();
      if (!readable(program.get(), 1)) {
        if (!readable(link.descriptor(), kTimeout)) {
          ADD_FAILURE() << "only came: " << text;
          break;
        }
        continue;
      }
      std::array<char, 4096> part{};
      const ssize_t size = ::read(program.get(), part.data(), part.size());
      if (size <= 0) {
        ADD_FAILURE() << "the port closed the connection";
        break;
      }
      text.append(part.data(), static_cast<std::size_t>(size));
    }
    return text;
  }

  tests::TemporaryDirectory directory_;
  Sink sink_;
};

TEST_F(CanLinkTest, SlcanOnAPseudoTerminalCarriesFramesBothWays) {
  const std::string path = directory_.path() + "/can0";
  const auto link = open("slcan:" + path);
  EXPECT_EQ(link->name(), "slcan:" + path);
  EXPECT_THAT(link->usage(), HasSubstr(path));
  const FileDescriptor program(::open(path.c_str(), O_RDWR | O_NOCTTY));
  say(program, "O\rt1231FF\r");
  EXPECT_THAT(receive(*link, 1), ElementsAre(can::data_frame(0x123, {0xFF})));
  link->send(can::data_frame(0x321, {}), {});
  link->flush();
  EXPECT_EQ(hear(program, *link, "t3210\r"), "\rt3210\r");
}

TEST_F(CanLinkTest, ASlcanPortInUseIsRefusedAndGoesOn) {
  const std::string path = directory_.path() + "/can0";
  const auto link = open("slcan:" + path);
  EXPECT_THAT(error_of("slcan:" + path), HasSubstr("another process serves \"" + path + "\""));
  const FileDescriptor program(::open(path.c_str(), O_RDWR | O_NOCTTY));
  say(program, "O\rt1231FF\r");
  EXPECT_THAT(receive(*link, 1), ElementsAre(can::data_frame(0x123, {0xFF})));
}

TEST_F(CanLinkTest, TheChannelOfAProgramThatIsGoneCloses) {
  const std::string path = directory_.path() + "/can0";
  const auto link = open("slcan:" + path);
  {
    const FileDescriptor program(::open(path.c_str(), O_RDWR | O_NOCTTY));
    say(program, "O\rt1230\r");
  }
  EXPECT_EQ(receive(*link, 1).size(), 1U) << "what it sent before is not lost";
  std::array<can::Frame, 1> nothing;
  EXPECT_EQ(link->receive(nothing, {}).value(), 0U) << "it only notices that the program is gone";
  link->send(can::data_frame(0x321, {}), {});
  link->flush();
  const FileDescriptor next(::open(path.c_str(), O_RDWR | O_NOCTTY));
  say(next, "V\r");
  EXPECT_EQ(hear(next, *link, "V1013\r"), "V1013\r");
}

TEST_F(CanLinkTest, ABitRateThatIsNotTheBusesIsTold) {
  const auto link = open("slcan-tcp:0");
  const FileDescriptor program = connect(*link);
  say(program, "S6\rS8\rO\rt1230\r");
  EXPECT_EQ(receive(*link, 1).size(), 1U);
  ASSERT_EQ(sink_.sentences.size(), 1U);
  EXPECT_THAT(sink_.sentences[0], HasSubstr("500.000 kbit/s"));
  EXPECT_THAT(sink_.sentences[0], HasSubstr("1000 kbit/s"));
}

TEST_F(CanLinkTest, ProgramsOfOnePortHearEachOtherAndTheBus) {
  const auto link = open("slcan-tcp:0");
  const FileDescriptor one = connect(*link);
  const FileDescriptor other = connect(*link);
  say(one, "O\r");
  say(other, "O\r");
  EXPECT_EQ(hear(one, *link, "\r"), "\r");
  EXPECT_EQ(hear(other, *link, "\r"), "\r");
  say(one, "t1110\r");
  EXPECT_EQ(receive(*link, 1).size(), 1U);
  link->send(can::data_frame(0x222, {}), {});
  link->flush();
  EXPECT_EQ(hear(other, *link, "t2220\r"), "t1110\rt2220\r");
  EXPECT_EQ(hear(one, *link, "t2220\r"), "t2220\r");
}

TEST_F(CanLinkTest, WhatAProgramSentBeforeItLeftIsTakenAndItIsForgotten) {
  const auto link = open("socketcand:0");
  {
    const FileDescriptor program = connect(*link);
    say(program, "< open can0 >< rawmode >< send 1 0 >< send 2 0 >< sen");
  }
  EXPECT_EQ(receive(*link, 2).size(), 2U);
  serve_until_clients(*link, 0);
}

TEST_F(CanLinkTest, MoreFramesThanFitStayUntilTheNextCall) {
  const auto link = open("slcan-tcp:0");
  const FileDescriptor program = connect(*link);
  say(program, "O\rt0010\rt0020\rt0030\r");
  hear(program, *link, "\r");
  // hear() has let the first ones pass; these come into a buffer for one frame.
  say(program, "t0010\rt0020\rt0030\r");
  ASSERT_TRUE(readable(link->descriptor()));
  std::array<can::Frame, 1> one;
  for (std::uint32_t identifier = 1; identifier <= 3; ++identifier) {
    ASSERT_EQ(link->receive(one, {}).value(), 1U);
    EXPECT_EQ(one[0].identifier, identifier);
  }
  EXPECT_EQ(link->receive(one, {}).value(), 0U);
}

TEST_F(CanLinkTest, AProgramThatDoesNotReadLosesFramesInTheEndAndTheyAreCounted) {
  const auto link = open("slcan-tcp:0");
  const FileDescriptor program = connect(*link);
  say(program, "O\r");
  hear(program, *link, "\r");
  const can::Frame frame = can::data_frame(1, {1, 2, 3, 4, 5, 6, 7, 8});
  for (int i = 0; i < 100'000; ++i) {
    link->send(frame, {});
    link->flush();
  }
  EXPECT_EQ(link->statistics().frames_dropped, 0U) << "a hundred thousand frames are kept";
  for (int i = 0; i < 1'500'000; ++i) {
    link->send(frame, {});
  }
  EXPECT_GT(link->statistics().frames_dropped, 0U);
  EXPECT_EQ(link->statistics().frames_sent, 1'600'000U);
}

TEST_F(CanLinkTest, NonsenseIsCountedAndHarmsNobody) {
  const auto link = open("slcan-tcp:0");
  const FileDescriptor program = connect(*link);
  say(program, "hello\rO\r");
  EXPECT_EQ(hear(program, *link, "\r"), "\a\r");
  EXPECT_EQ(link->statistics().malformed, 1U);
}

TEST_F(CanLinkTest, APortThatIsTakenIsSaidSo) {
  const auto link = open("socketcand:0");
  EXPECT_THAT(error_of(link->name()), HasSubstr("another program listens at TCP port"));
  EXPECT_THAT(error_of("slcan-tcp:192.0.2.1:0"), HasSubstr("not an address of this machine"));
  EXPECT_THAT(error_of("slcan:" + directory_.path() + "/none/can0"), HasSubstr("No such file"));
}

TEST_F(CanLinkTest, AnInterfaceThatIsNotThereIsSaidSo) {
  EXPECT_THAT(error_of("socketcan:nocan9"),
              testing::AnyOf(HasSubstr("type vcan"), HasSubstr("this kernel has no CAN")));
}

/// A program as the preloaded library makes it.
class CanExecProgram {
 public:
  explicit CanExecProgram(const std::string& bus, can_exec::Configuration configuration = {},
                          const std::vector<can_filter>& filters = {can_filter{}})
      : socket_(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)) {
    sockaddr_un_of(bus);
    configuration.filter_count = static_cast<std::uint32_t>(filters.size());
    std::string message(reinterpret_cast<const char*>(&configuration), sizeof configuration);
    message.append(reinterpret_cast<const char*>(filters.data()),
                   filters.size() * sizeof(can_filter));
    write(message);
  }
  void write(std::string_view message) const {
    EXPECT_EQ(::send(socket_.get(), message.data(), message.size(), 0),
              static_cast<ssize_t>(message.size()));
  }
  void send(const can_frame& frame) const {
    write({reinterpret_cast<const char*>(&frame), sizeof frame});
  }
  struct Heard {
    canid_t identifier;
    std::uint32_t flags;
    friend bool operator==(const Heard&, const Heard&) = default;
  };
  /// All that has come, without the port's word on being connected.
  [[nodiscard]] std::vector<Heard> heard() const {
    std::vector<Heard> all;
    std::array<std::byte, 64> message{};
    ssize_t size = 0;
    while ((size = ::recv(socket_.get(), message.data(), message.size(), MSG_DONTWAIT)) > 0) {
      can_exec::Origin origin;
      std::memcpy(&origin, message.data() + size - sizeof origin, sizeof origin);
      can_frame frame{};
      std::memcpy(&frame, message.data(), sizeof frame);
      if (origin.flags != can_exec::kConnected) {
        all.push_back({frame.can_id, origin.flags});
      }
    }
    return all;
  }

 private:
  void sockaddr_un_of(const std::string& bus) {
    struct {
      sa_family_t family = AF_UNIX;
      std::array<char, 108> path{};
    } address;
    const std::string path = can_exec::directory() + "/" + bus;
    path.copy(address.path.data(), address.path.size() - 1);
    EXPECT_EQ(::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
  }

  FileDescriptor socket_;
};

can_frame socketcan_frame(canid_t identifier) {
  can_frame frame{};
  frame.can_id = identifier;
  return frame;
}

class CanExecLinkTest : public CanLinkTest {
 protected:
  /// Lets the port do all there is to do.
  std::vector<can::Frame> serve() {
    std::vector<can::Frame> frames;
    while (readable(link_->descriptor(), 0)) {
      std::array<can::Frame, 64> buffer;
      const std::size_t got = link_->receive(buffer, {}).value();
      frames.insert(frames.end(), buffer.begin(),
                    buffer.begin() + static_cast<std::ptrdiff_t>(got));
    }
    return frames;
  }

  std::string bus_ = "t" + std::to_string(::getpid());
  std::unique_ptr<CanLink> link_ = open("can-exec:" + bus_);
};

using Heard = CanExecProgram::Heard;

TEST_F(CanExecLinkTest, FramesGoToTheBusToOtherProgramsAndBackWhenWanted) {
  const CanExecProgram one(bus_);
  const CanExecProgram own(bus_, {.options = can_exec::kLoopback | can_exec::kReceiveOwn});
  const CanExecProgram quiet(bus_, {.options = 0});
  serve();
  one.send(socketcan_frame(0x101));
  own.send(socketcan_frame(0x102));
  quiet.send(socketcan_frame(0x103));
  EXPECT_EQ(serve().size(), 3U);
  link_->send(can::data_frame(0x200, {}), {});
  link_->flush();
  EXPECT_THAT(one.heard(), ElementsAre(Heard{0x102, can_exec::kFromProgram}, Heard{0x200, 0}));
  EXPECT_THAT(own.heard(),
              ElementsAre(Heard{0x101, can_exec::kFromProgram},
                          Heard{0x102, can_exec::kFromProgram | can_exec::kOwn}, Heard{0x200, 0}));
  EXPECT_EQ(quiet.heard().size(), 3U);
}

TEST_F(CanExecLinkTest, AProgramThatSendsWithoutAPauseLeavesOthersTheirTurn) {
  const CanExecProgram flood(bus_);
  serve();
  for (int i = 0; i < 4; ++i) {
    flood.send(socketcan_frame(0x7E0));
  }
  const CanExecProgram other(bus_);
  other.send(socketcan_frame(0x101));
  std::vector<can::Frame> taken;
  for (int i = 0; i < 8; ++i) {
    std::array<can::Frame, 1> one;
    ASSERT_EQ(link_->receive(one, {}).value(), 1U);
    taken.push_back(one[0]);
    flood.send(socketcan_frame(0x7E0));
  }
  EXPECT_THAT(taken, testing::Contains(can::data_frame(0x101, {})));
}

TEST_F(CanExecLinkTest, FiltersAreAlternativesUnlessJoined) {
  const std::vector<can_filter> filters{{.can_id = 0x100, .can_mask = 0x700},
                                        {.can_id = 0x101 | CAN_INV_FILTER, .can_mask = 0x7FF}};
  const CanExecProgram any(bus_, {}, filters);
  const CanExecProgram all(bus_, {.options = can_exec::kJoinFilters}, filters);
  const CanExecProgram none(bus_, {}, {});
  serve();
  for (const std::uint32_t identifier : {0x100U, 0x101U, 0x200U}) {
    link_->send(can::data_frame(identifier, {}), {});
  }
  link_->flush();
  EXPECT_THAT(any.heard(), ElementsAre(Heard{0x100, 0}, Heard{0x101, 0}, Heard{0x200, 0}));
  EXPECT_THAT(all.heard(), ElementsAre(Heard{0x100, 0}));
  EXPECT_THAT(none.heard(), testing::IsEmpty());
}

TEST_F(CanExecLinkTest, ErrorFramesReachThoseWhoAskForTheirClass) {
  const CanExecProgram deaf(bus_);
  const CanExecProgram alert(bus_, {.error_mask = kProtocolViolation});
  serve();
  link_->send_error(bus_error_frame(), {});
  link_->send_error({.classes = CAN_ERR_RESTARTED}, {});
  link_->flush();
  EXPECT_THAT(deaf.heard(), testing::IsEmpty());
  EXPECT_THAT(alert.heard(), ElementsAre(Heard{CAN_ERR_FLAG | CAN_ERR_PROT | CAN_ERR_BUSERROR, 0}));
}

TEST_F(CanExecLinkTest, NonsenseEndsOnlyWhoSendsIt) {
  const CanExecProgram good(bus_);
  const CanExecProgram bad(bus_);
  serve();
  bad.write("nonsense");
  can_frame too_long = socketcan_frame(1);
  too_long.can_dlc = 9;
  bad.send(too_long);
  EXPECT_TRUE(serve().empty());
  EXPECT_EQ(link_->statistics().malformed, 2U);
  good.send(socketcan_frame(1));
  EXPECT_EQ(serve().size(), 1U);
}

TEST_F(CanExecLinkTest, ABusHasOnePortAndItsNameVanishesWithIt) {
  EXPECT_THAT(error_of("can-exec:" + bus_), HasSubstr("another process serves"));
  const std::string path = can_exec::directory() + "/" + bus_;
  EXPECT_TRUE(std::filesystem::exists(path));
  link_.reset();
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace stator::link
