#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"
#include "stator/base/random.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using base::SimTime;
using testing::Bytes;
using testing::bytes;
using testing::number;
using testing::TestBus;
using testing::zeros;

/// Two BRD datagrams of one byte each; offsets 16 and 29.
Bytes two_datagrams() {
  std::array<std::byte, kMaximumFrameLength> buffer{};
  FrameBuilder builder(buffer, {0x01, 0x01, 0x01, 0x01, 0x01, 0x01});
  builder.append(Command::brd, 0, physical_address(0, 0), std::size_t{1});
  builder.append(Command::brd, 1, physical_address(0, 0), std::size_t{1});
  const std::span<std::byte> frame = builder.finish();
  return Bytes(frame.begin(), frame.end());
}

class MalformedFrame : public ::testing::Test {
 protected:
  unsigned processing_errors() {
    return static_cast<unsigned>(number(bus.read(0, 0x030C, 1).data));
  }
  TestBus bus;
  Bytes frame = two_datagrams();
};

TEST_F(MalformedFrame, Truncated_TheWholeDatagramIsProcessedAndTheRestUntouched) {
  for (std::size_t length = 41; length >= 29; --length) {
    Bytes cut(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(length));
    const Bytes before = cut;
    const unsigned errors = processing_errors();
    EXPECT_TRUE(bus.segment().process(cut, bus.now()));
    EXPECT_EQ(std::to_integer<unsigned>(cut[27]), 1U) << "first working counter, " << length;
    EXPECT_EQ(Bytes(cut.begin() + 29, cut.end()), Bytes(before.begin() + 29, before.end()));
    EXPECT_EQ(processing_errors(), errors + 1);
  }
}

TEST_F(MalformedFrame, DatagramLengthPastTheEtherCatLength_IsNotTouched) {
  frame.resize(60);
  frame[29 + 6] = std::byte{2};  // one byte more than announced, though padding would hold it
  const Bytes before = frame;
  EXPECT_TRUE(bus.segment().process(frame, bus.now()));
  EXPECT_EQ(Bytes(frame.begin() + 29, frame.end()), Bytes(before.begin() + 29, before.end()));
  EXPECT_EQ(bus.segment().statistics().malformed, 1U);
}

TEST_F(MalformedFrame, OtherTypes_AreNotAnswered) {
  Bytes foreign = frame;
  foreign[12] = std::byte{0x08};
  EXPECT_FALSE(bus.segment().process(foreign, bus.now()));
  Bytes network_variables = frame;
  network_variables[15] = std::byte{0x40};
  EXPECT_FALSE(bus.segment().process(network_variables, bus.now()));
  EXPECT_EQ(bus.segment().statistics().foreign, 2U);
}

TEST_F(MalformedFrame, TooShortForItsHeaders_IsNotAnswered) {
  for (std::size_t length = 0; length < 16; ++length) {
    EXPECT_FALSE(bus.segment().process(std::span(frame).first(length), bus.now()));
  }
  EXPECT_EQ(bus.segment().statistics().malformed, 16U);
}

TEST_F(MalformedFrame, EmptyDatagram_CountsNothing) {
  const auto answer = bus.transfer(Command::brd, physical_address(0, 0), {});
  EXPECT_TRUE(answer.returned);
  EXPECT_EQ(answer.working_counter, 0U);
  EXPECT_EQ(bus.transfer(Command::lrw, 0, {}).working_counter, 0U);
}

/// Random datagrams aimed at registers, areas and logical addresses, then random damage. The slaves
/// must survive (sanitizers watch) and answer a sane frame afterwards.
TEST(MalformedFrames, RandomFrames_LeaveTheSlavesAlive) {
  TestBus bus(3);
  base::Random random(20'240'601);
  std::array<std::byte, kMaximumFrameLength> buffer{};
  SimTime now;
  for (int round = 0; round < 200'000; ++round) {
    FrameBuilder builder(buffer, {0x01, 0x01, 0x01, 0x01, 0x01, 0x01});
    const std::size_t datagrams = random.below(4);
    for (std::size_t i = 0; i < datagrams; ++i) {
      const auto command = static_cast<Command>(random.below(17));
      const bool logical = command >= Command::lrd && command <= Command::lrw;
      const auto ado = static_cast<std::uint16_t>(random.below(4) == 0 ? random.below(0x10000)
                                                                       : random.below(0x1300));
      const auto adp = static_cast<std::uint16_t>(-static_cast<int>(random.below(4)));
      const std::uint32_t address = logical ? static_cast<std::uint32_t>(random.below(0x40)) - 0x20U
                                            : physical_address(adp, ado);
      const std::size_t length = random.below(8) == 0 ? random.below(400) : random.below(20);
      if (const auto data = builder.append(command, 0, address, length)) {
        for (std::byte& byte : *data) {
          byte = static_cast<std::byte>(random.below(3) == 0 ? random.next() : random.below(4));
        }
      }
    }
    std::span<std::byte> frame = builder.finish();
    if (random.below(4) == 0) {
      frame[random.below(frame.size())] = static_cast<std::byte>(random.next());
    }
    if (random.below(8) == 0) {
      frame = frame.first(random.below(frame.size() + 1));
    }
    now += SimDuration(static_cast<std::int64_t>(random.below(2'000'000)));
    // A heap copy of the exact size, so that any access outside is seen.
    Bytes exact(frame.begin(), frame.end());
    static_cast<void>(bus.segment().process(exact, now));
    if (random.below(3) == 0) {
      Bytes data(random.below(64));
      SlaveController& slave = bus.slave(random.below(3));
      const auto address = static_cast<std::uint16_t>(random.below(0x1300));
      if (random.below(2) == 0) {
        slave.read(address, data);
      } else {
        slave.write(address, data);
      }
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    bus.slave(i).power_on_reset();
  }
  static_cast<void>(bus.segment().process({}, now));
  bus.segment().advance(now);
  EXPECT_EQ(bus.broadcast_read(0x0000, 1).working_counter, 3U);
}

}  // namespace
}  // namespace stator::ethercat
