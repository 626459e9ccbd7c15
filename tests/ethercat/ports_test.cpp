// Ports of a slave: links, loops, DL status, what is counted, what is forwarded.

#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "ethercat/test_bus.hpp"
#include "source_paths.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using testing::bytes;
using testing::number;
using testing::TestBus;
using testing::zeros;

constexpr unsigned kAutoClose1 = 0x04;  // loop settings of port 1 in 0x0101
constexpr unsigned kAlwaysOpen1 = 0x08;
constexpr unsigned kAlwaysClosed1 = 0x0C;

SlaveControllerConfiguration four_ports() {
  SlaveControllerConfiguration configuration;
  configuration.port_descriptor = 0xFF;
  return configuration;
}

unsigned reachable(TestBus& bus) {
  return bus.broadcast_read(0x0000, 1).working_counter;
}
unsigned dl_status(TestBus& bus, std::uint16_t position) {
  return static_cast<unsigned>(number(bus.read(position, 0x0110, 2).data));
}

/// Rows of a table of DL status values: the high byte, and in words the ports 3 to 0.
class DlStatusTable : public ::testing::TestWithParam<const char*> {};

TEST_P(DlStatusTable, EveryRowIsWhatASlaveShows) {
  std::ifstream file(std::string(STATOR_TEST_DATA) + GetParam());
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto rows = tests::parse_csv(text);
  ASSERT_EQ(rows.size(), 21U);
  for (std::size_t r = 1; r < rows.size(); ++r) {
    SlaveController slave(four_ports());
    slave.load_sii(testing::valid_sii());
    unsigned loop_control = 0;
    for (unsigned port = 0; port < 4; ++port) {
      const std::string& words = rows[r].at(4 - port);
      const bool link = words.starts_with("Link") || words.starts_with("link");
      slave.set_link(port, link);
      if (link && words.ends_with("closed")) {
        loop_control |= 3U << (2 * port);
      }
    }
    std::array<std::byte, 64> buffer{};
    FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
    builder.append(Command::apwr, 0, physical_address(0, 0x0101), bytes({loop_control}));
    std::vector<DatagramView> datagrams(1);
    DatagramCursor cursor(builder.finish());
    ASSERT_TRUE(cursor.next(datagrams[0]));
    slave.process(datagrams, {base::SimTime(), base::SimTime(), ArrivalTimes{}});
    testing::Bytes shown(1);
    slave.peek(0x0111, shown);
    EXPECT_EQ(number(shown), std::stoul(rows[r][0], nullptr, 16)) << "row " << rows[r][0];
  }
}

INSTANTIATE_TEST_SUITE_P(Documents, DlStatusTable,
                         ::testing::Values("/tmc8670/dl_status_port_codes.csv",
                                           "/tmc8461/dl_status_decode.csv"));

TEST(Ports, DlStatus_TellsLinksAndLoopsConsistently) {
  TestBus bus(3);
  EXPECT_EQ(dl_status(bus, 0), 0x5A33U);
  EXPECT_EQ(dl_status(bus, 1), 0x5A33U);
  EXPECT_EQ(dl_status(bus, 2), 0x5613U) << "last: port 1 closed, no link";
}

TEST(Ports, TwoPortChip_HasPortsTwoAndThreeAlwaysClosed) {
  TestBus bus(1);
  bus.write(0, 0x0101, bytes({0xA0}));
  EXPECT_EQ(number(bus.read(0, 0x0101, 1).data), 0xA0U) << "stored without effect";
  bus.slave().set_link(2, true);
  bus.slave().set_link(3, true);
  EXPECT_EQ(dl_status(bus, 0), 0x5613U);
  bus.slave().count_receive_error(2, ReceiveError::physical);
  EXPECT_EQ(number(bus.read(0, 0x0300, 8).data), 0U);
}

TEST(Ports, DlStatusChange_RaisesAnEventThatReadingItTakesAway) {
  TestBus bus(2);
  bus.write(0, 0x0200, bytes({0x04, 0x00}));
  bus.read(0, 0x0110, 2);
  EXPECT_EQ(bus.read(0, 0x0000, 1).interrupt & 0x04U, 0U);
  bus.segment().set_link(1, false);
  EXPECT_EQ(bus.read(0, 0x0000, 1).interrupt & 0x04U, 0x04U);
  bus.read(0, 0x0110, 2);
  EXPECT_EQ(bus.read(0, 0x0000, 1).interrupt & 0x04U, 0U);
}

TEST(Ports, Auto_ClosesWithoutLinkAndOpensWithIt) {
  TestBus bus(3);
  bus.segment().set_link(2, false);
  EXPECT_EQ(reachable(bus), 2U);
  EXPECT_EQ(dl_status(bus, 1), 0x5613U);
  bus.segment().set_link(2, true);
  EXPECT_EQ(reachable(bus), 3U);
  bus.segment().set_link(0, false);
  EXPECT_FALSE(bus.broadcast_read(0x0000, 1).returned);
}

TEST(Ports, AutoClose_StaysClosedUntilItIsWrittenAgain) {
  TestBus bus(2);
  bus.write(0, 0x0101, bytes({kAutoClose1}));
  EXPECT_EQ(reachable(bus), 2U) << "open with a link";
  bus.segment().set_link(1, false);
  bus.segment().set_link(1, true);
  EXPECT_EQ(reachable(bus), 1U);
  EXPECT_EQ(dl_status(bus, 0), 0x5E33U) << "link, but closed";
  bus.write(0, 0x0101, bytes({kAutoClose1}));
  EXPECT_EQ(reachable(bus), 2U);
}

TEST(Ports, AutoClose_WrittenWithoutLinkDoesNotOpenLater) {
  TestBus bus(2);
  bus.segment().set_link(1, false);
  bus.write(0, 0x0101, bytes({kAutoClose1}));
  bus.segment().set_link(1, true);
  EXPECT_EQ(reachable(bus), 1U);
}

TEST(Ports, AutoClose_OpensWhenAFrameComesInAtTheClosedPort) {
  TestBus bus(2);
  bus.write(1, 0x0101, bytes({0x01}));  // port 0 of the second slave
  bus.segment().set_link(1, false);
  bus.segment().set_link(1, true);
  EXPECT_FALSE(bus.broadcast_read(0x0000, 1).returned) << "this frame ends at the closed port";
  EXPECT_EQ(bus.segment().statistics().lost, 1U);
  EXPECT_EQ(reachable(bus), 2U);
}

TEST(Ports, AlwaysClosed_StaysClosedWhenFramesComeIn) {
  TestBus bus(2);
  bus.write(1, 0x0101, bytes({0x03}));
  EXPECT_FALSE(bus.broadcast_read(0x0000, 1).returned);
  EXPECT_FALSE(bus.broadcast_read(0x0000, 1).returned);
}

TEST(Ports, AlwaysOpenWithoutCable_LosesFrames) {
  TestBus bus(1);
  bus.write(0, 0x0101, bytes({kAlwaysOpen1}));
  EXPECT_FALSE(bus.broadcast_read(0x0000, 1).returned);
  EXPECT_EQ(bus.segment().statistics().lost, 1U);
}

TEST(Ports, LoopControl_TakesEffectAfterTheFrame) {
  TestBus bus(2);
  bus.with(Command::apwr, physical_address(0, 0x0101), bytes({kAlwaysClosed1}))
      .with(Command::brd, physical_address(0, 0x0000), zeros(1));
  EXPECT_EQ(bus.send()[1].working_counter, 2U);
  EXPECT_EQ(reachable(bus), 1U) << "port 1 closed";
  EXPECT_EQ(dl_status(bus, 0), 0x5E33U) << "link and communication stay";
  bus.write(0, 0x0101, bytes({0x00}));
  EXPECT_EQ(reachable(bus), 2U);
}

TEST(Ports, TemporaryLoopControl_EndsAfterASecond) {
  TestBus bus(2);
  bus.write(0, 0x0100, bytes({0x03, kAlwaysClosed1}));
  EXPECT_EQ(reachable(bus), 1U);
  bus.wait(SimDuration(900'000'000));
  EXPECT_EQ(reachable(bus), 1U);
  bus.wait(SimDuration(200'000'000));
  EXPECT_EQ(reachable(bus), 2U) << "already for the first frame";
  EXPECT_EQ(number(bus.read(0, 0x0101, 1).data), 0U);
}

TEST(Ports, TemporaryLoopControlWrittenTwice_GoesBackToThePermanentSettings) {
  TestBus bus(2);
  bus.write(0, 0x0100, bytes({0x03, kAlwaysClosed1}));
  bus.write(0, 0x0100, bytes({0x03, kAlwaysClosed1}));
  bus.wait(SimDuration(1'100'000'000));
  EXPECT_EQ(reachable(bus), 2U);
}

TEST(Ports, LostLink_IsCountedAtOpenPortsSetToAutoOnly) {
  for (const auto& [setting, counted] : std::vector<std::pair<unsigned, unsigned>>{
           {0x00, 1}, {kAutoClose1, 0}, {kAlwaysOpen1, 0}, {kAlwaysClosed1, 0}}) {
    TestBus bus(2);
    bus.write(0, 0x0101, bytes({setting}));
    bus.segment().set_link(1, false);
    testing::Bytes counter(1);
    bus.slave(0).peek(0x0311, counter);
    EXPECT_EQ(number(counter), counted) << "setting " << setting;
  }
}

TEST(Ports, LostLinkCounters_SaturateAndAnyWriteClearsThemAll) {
  TestBus bus(2);
  for (int i = 0; i < 300; ++i) {
    bus.segment().set_link(1, false);
    bus.segment().set_link(1, true);
  }
  EXPECT_EQ(number(bus.read(0, 0x0310, 4).data), 0x0000FF00U);
  EXPECT_EQ(number(bus.read(1, 0x0310, 4).data), 0x000000FFU);
  bus.write(0, 0x0312, bytes({0x55}));
  EXPECT_EQ(number(bus.read(0, 0x0310, 4).data), 0U);
  EXPECT_EQ(number(bus.read(1, 0x0310, 4).data), 0x000000FFU);
}

TEST(Ports, ReceiveErrors_CountAtEnabledPortsOnly) {
  TestBus bus(2);
  for (const unsigned port : {0U, 1U}) {
    bus.slave(1).count_receive_error(port, ReceiveError::invalid_frame);
    bus.slave(1).count_receive_error(port, ReceiveError::physical);
    bus.slave(1).count_receive_error(port, ReceiveError::forwarded_error);
  }
  EXPECT_EQ(bus.read(1, 0x0300, 12).data, bytes({1, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}));
}

TEST(Ports, DlControl_KeepsItsReservedBitsZeroAndStoresThoseOfEBus) {
  TestBus bus(2);
  bus.write(1, 0x0100, bytes({0xFC, 0x00, 0xCF, 0xFE}));
  EXPECT_EQ(number(bus.read(1, 0x0100, 4).data), 0x004F0000U);
  EXPECT_EQ(reachable(bus), 2U);
}

TEST(Ports, ReceiveErrorCounters_Saturate) {
  TestBus bus(1);
  for (int i = 0; i < 300; ++i) {
    bus.slave().count_receive_error(0, ReceiveError::invalid_frame);
    bus.slave().count_receive_error(0, ReceiveError::physical);
    bus.slave().count_receive_error(0, ReceiveError::forwarded_error);
  }
  EXPECT_EQ(bus.read(0, 0x0300, 9).data, bytes({0xFF, 0xFF, 0, 0, 0, 0, 0, 0, 0xFF}));
}

TEST(Ports, DlStatus_IsReadOnlyForBothSides) {
  TestBus bus(2);
  EXPECT_EQ(bus.write(0, 0x0110, bytes({0xFF, 0xFF})).working_counter, 0U);
  testing::host_write(bus.slave(0), 0x0110, bytes({0xFF, 0xFF}));
  EXPECT_EQ(dl_status(bus, 0), 0x5A33U);
}

/// A frame of another protocol.
testing::Bytes foreign_frame(unsigned ether_type_high, unsigned ether_type_low) {
  testing::Bytes frame = zeros(60);
  frame[12] = static_cast<std::byte>(ether_type_high);
  frame[13] = static_cast<std::byte>(ether_type_low);
  return frame;
}

TEST(ForwardingRule, ForeignFrames_PassOnlyWhereNoSlaveDestroysThem) {
  TestBus bus(3);
  const auto passes = [&bus](testing::Bytes frame) {
    return bus.segment().process(frame, bus.now());
  };
  EXPECT_FALSE(passes(foreign_frame(0x08, 0x00))) << "reset value: destroyed";
  bus.broadcast_write(0x0100, bytes({0x00}));
  testing::Bytes frame = foreign_frame(0x08, 0x00);
  EXPECT_TRUE(bus.segment().process(frame, bus.now()));
  testing::Bytes expected = foreign_frame(0x08, 0x00);
  expected[6] = std::byte{0x02};
  EXPECT_EQ(frame, expected) << "forwarded with the locally administered source and no more";
  EXPECT_TRUE(passes(foreign_frame(0x88, 0xA4))) << "EtherCAT of a type without datagrams";
  bus.write(1, 0x0100, bytes({0x01}));
  EXPECT_FALSE(passes(foreign_frame(0x08, 0x00)));
  EXPECT_EQ(reachable(bus), 3U) << "EtherCAT frames are always processed";
}

TEST(ForwardingRule, ForeignFramesOfAWholeRing_PassTheOtherWayUnseen) {
  TestBus bus(2);
  bus.segment().connect(MasterInterface::secondary, SlavePort{1, 1});
  testing::Bytes frame = foreign_frame(0x08, 0x00);
  EXPECT_EQ(bus.segment().process(frame, bus.now(), MasterInterface::secondary),
            MasterInterface::primary);
}

TEST(VlanTag, IsCarriedAndNotEvaluated) {
  TestBus bus(2);
  std::array<std::byte, 64> buffer{};
  FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
  builder.append(Command::brd, 0, 0, std::size_t{1});
  const std::span<std::byte> plain = builder.finish();
  testing::Bytes tagged(plain.begin(), plain.end());
  const testing::Bytes tag = bytes({0x81, 0x00, 0x60, 0x05});
  tagged.insert(tagged.begin() + 12, tag.begin(), tag.end());
  ASSERT_TRUE(bus.segment().process(tagged, bus.now()));
  EXPECT_EQ(testing::Bytes(tagged.begin() + 12, tagged.begin() + 16), tag);
  EXPECT_EQ(tagged[tagged.size() - 2], std::byte{2}) << "working counter";
}

}  // namespace
}  // namespace stator::ethercat
