// PHY registers over the MII management interface 0510h, by the master, the host and link
// detection.
#include "stator/ethercat/units/mii_management.hpp"

#include <array>
#include <string>

#include <gtest/gtest.h>

#include "ethercat/controllers.hpp"
#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using base::literals::operator""_us;
using testing::Bytes;
using testing::bytes;
using testing::host_read;
using testing::host_write;
using testing::little_endian;
using testing::number;
using testing::TestBus;

constexpr unsigned kBusy = 0x8000;
constexpr unsigned kCommandError = 0x4000;
constexpr unsigned kReadError = 0x2000;

class Mii : public ::testing::Test {
 protected:
  explicit Mii(std::size_t slaves = 1) : bus(slaves) {}

  unsigned status() { return static_cast<unsigned>(number(bus.read(0, 0x0510, 2).data)); }
  /// Command, PHY and register in one datagram, as masters write them.
  unsigned command(unsigned code, unsigned phy, unsigned phy_register) {
    return bus.write(0, 0x0510, bytes({code & 0xFF, code >> 8, phy, phy_register})).working_counter;
  }
  unsigned read_phy(unsigned phy, unsigned phy_register) {
    command(0x0100, phy, phy_register);
    bus.wait(100_us);
    return static_cast<unsigned>(number(bus.read(0, 0x0514, 2).data));
  }
  void write_phy(unsigned phy, unsigned phy_register, unsigned value) {
    bus.write(0, 0x0514, little_endian(value, 2));
    command(0x0201, phy, phy_register);
    bus.wait(100_us);
  }

  TestBus bus;
  SlaveController& slave = bus.slave();
};

TEST_F(Mii, AfterPowerOn_OffersHostControlAndLinkDetectionAndShowsPhyZero) {
  EXPECT_EQ(status(), 0x0006U);
}

TEST_F(Mii, Read_IsBusyForOneTransferAndThenHoldsTheRegister) {
  EXPECT_EQ(command(0x0100, 0, 2), 1U);
  EXPECT_EQ(status() & (kBusy | 0x0300U), kBusy | 0x0100U);
  bus.wait(100_us);
  EXPECT_EQ(status() & (kBusy | 0x0300U), 0U);
  EXPECT_EQ(number(bus.read(0, 0x0514, 2).data), 0x0022U) << "PHY identifier 1";
  EXPECT_EQ(read_phy(0, 3), 0x1560U) << "PHY identifier 2";
}

TEST_F(Mii, BusyInterface_RefusesWrites) {
  bus.with(Command::apwr, physical_address(0, 0x0510), bytes({0x00, 0x01, 0x00, 0x02}));
  constexpr std::array<std::uint16_t, 4> kInterface{0x0510, 0x0512, 0x0513, 0x0514};
  for (const std::uint16_t address : kInterface) {
    bus.with(Command::apwr, physical_address(0, address), bytes({0x02, 0x00}));
  }
  const auto answers = bus.send();
  EXPECT_EQ(answers[0].working_counter, 1U);
  for (std::size_t i = 1; i < answers.size(); ++i) {
    EXPECT_EQ(answers[i].working_counter, 0U) << "datagram " << i;
  }
  bus.wait(100_us);
  EXPECT_EQ(number(bus.read(0, 0x0514, 2).data), 0x0022U) << "the read was not disturbed";
  EXPECT_EQ(bus.write(0, 0x0514, bytes({0, 0})).working_counter, 1U);
}

TEST_F(Mii, StatusRegister_FollowsTheLinkOfThePort) {
  EXPECT_EQ(read_phy(0, 1) & 0x0024U, 0x0024U) << "link and negotiation complete";
  EXPECT_EQ(read_phy(0, 5), 0x41E1U) << "abilities of the partner";
  EXPECT_EQ(read_phy(1, 1) & 0x0024U, 0U) << "nothing at the last port";
  EXPECT_EQ(read_phy(1, 5), 0U);
  slave.set_link(0, false);
  slave.set_link(0, true);
  EXPECT_EQ(read_phy(0, 1), 0x786DU);
}

TEST_F(Mii, MissingPhyOrRegister_SetsTheReadErrorUntilTheRegisterIsWritten) {
  EXPECT_EQ(read_phy(5, 1), 0xFFFFU);
  EXPECT_EQ(status() & kReadError, kReadError);
  bus.write(0, 0x0511, bytes({0}));
  EXPECT_EQ(status() & kReadError, 0U);
  read_phy(0, 9);
  EXPECT_EQ(status() & kReadError, kReadError) << "no register 9";
}

TEST_F(Mii, Write_ChangesThePhyAndNeedsWriteEnable) {
  write_phy(0, 4, 0x0101);
  EXPECT_EQ(read_phy(0, 4), 0x0101U);
  EXPECT_EQ(read_phy(1, 4), 0x01E1U) << "the other PHY keeps its own";
  bus.write(0, 0x0514, bytes({0x55, 0x55}));
  command(0x0200, 0, 4);
  bus.wait(100_us);
  EXPECT_EQ(status() & kCommandError, kCommandError);
  EXPECT_EQ(read_phy(0, 4), 0x0101U);
  EXPECT_EQ(status() & kCommandError, 0U) << "a valid command clears the error";
}

TEST_F(Mii, WriteEnable_EndsWithTheFrame) {
  bus.write(0, 0x0510, bytes({0x01}));
  bus.read(0, 0x0000, 1);
  EXPECT_EQ(status() & 1U, 0U);
  bus.write(0, 0x0511, bytes({0x02}));
  EXPECT_EQ(status() & kCommandError, kCommandError);
}

TEST_F(Mii, InvalidCommand_SetsTheErrorUntilCommandZero) {
  command(0x0300, 0, 0);
  EXPECT_EQ(status() & (kBusy | kCommandError | 0x0300U), kCommandError);
  command(0x0000, 0, 0);
  EXPECT_EQ(status() & kCommandError, 0U);
}

TEST_F(Mii, ResetAndRestartBits_ClearThemselves) {
  write_phy(0, 4, 0x0101);
  write_phy(0, 0, 0x9200);
  EXPECT_EQ(read_phy(0, 0), 0x3100U);
  EXPECT_EQ(read_phy(0, 4), 0x01E1U) << "PHY reset";
  write_phy(0, 0, 0x1300);
  EXPECT_EQ(read_phy(0, 0), 0x1100U) << "restart of negotiation done";
  write_phy(0, 1, 0xFFFF);
  EXPECT_EQ(read_phy(0, 1) & 0x7849U, 0x7849U) << "status is read only";
}

TEST_F(Mii, ShownAddress_IsThatOfThePortAskedFor) {
  bus.write(0, 0x0512, bytes({0x81}));
  EXPECT_EQ(status() & 0x00F8U, 1U << 3);
  bus.write(0, 0x0512, bytes({0x01}));
  EXPECT_EQ(status() & 0x00F8U, 0U) << "without bit 7 that of port 0";
}

TEST_F(Mii, PhyOffset_MovesTheAddresses) {
  SlaveControllerConfiguration configuration;
  configuration.mii.phy_offset = 1;
  configuration.mii.phy_addresses = {1, 2};
  TestBus other(1, configuration);
  EXPECT_EQ(number(other.read(0, 0x0510, 2).data), 0x0006U | 1U << 3);
  other.write(0, 0x0512, bytes({0x81}));
  EXPECT_EQ(number(other.read(0, 0x0510, 2).data) & 0x00F8U, 2U << 3);
  other.write(0, 0x0510, bytes({0x00, 0x01, 0x02, 0x02}));
  other.wait(100_us);
  EXPECT_EQ(number(other.read(0, 0x0514, 2).data), 0x0022U);
}

TEST_F(Mii, HostTakesTheInterfaceUnlessTheMasterClaimsIt) {
  bus.write(0, 0x0516, bytes({1}));
  host_write(slave, 0x0517, bytes({1}));
  EXPECT_EQ(number(bus.read(0, 0x0517, 1).data), 0U) << "claimed";
  bus.write(0, 0x0516, bytes({0}));
  host_write(slave, 0x0510, bytes({0x00, 0x01}));
  EXPECT_EQ(status() & kBusy, 0U) << "not the host's";
  host_write(slave, 0x0517, bytes({1}));
  EXPECT_EQ(number(bus.read(0, 0x0517, 1).data), 1U);
  EXPECT_EQ(status() & 1U, 1U) << "write enable reads 1 while the host owns it";
  EXPECT_EQ(command(0x0100, 0, 2), 0U);
  EXPECT_EQ(bus.write(0, 0x0516, bytes({1})).working_counter, 0U);
  host_write(slave, 0x0510, bytes({0x00, 0x01, 0x00, 0x02}));
  bus.wait(100_us);
  EXPECT_EQ(number(host_read(slave, 0x0514, 2)), 0x0022U);
  host_write(slave, 0x0514, bytes({0x01, 0x00}));
  host_write(slave, 0x0510, bytes({0x00, 0x02, 0x00, 0x04}));
  EXPECT_EQ(number(host_read(slave, 0x0510, 2)) & kBusy, kBusy) << "no enable bit needed";
  bus.wait(100_us);
  EXPECT_EQ(bus.write(0, 0x0517, bytes({2})).working_counter, 1U);
  EXPECT_EQ(number(bus.read(0, 0x0517, 1).data) & 1U, 0U) << "forced release";
  EXPECT_EQ(status() & 1U, 0U);
  EXPECT_EQ(read_phy(0, 4), 0x0001U) << "what the host wrote";
}

class MiiOfTwo : public Mii {
 protected:
  MiiOfTwo() : Mii(2) {}
};

TEST_F(MiiOfTwo, PortStatus_TellsLinksOfBothPorts) {
  EXPECT_EQ(bus.read(0, 0x0518, 4).data, bytes({0x03, 0x03, 0, 0}));
  EXPECT_EQ(bus.read(1, 0x0518, 4).data, bytes({0x03, 0x00, 0, 0}));
  EXPECT_EQ(host_read(slave, 0x0519, 1), bytes({0x03}));
  bus.set_fmmu(0, 0, {.logical = 0, .length = 4, .physical = 0x0518, .type = 1});
  slave.set_link(1, false);
  bus.slave(1).set_link(0, false);
  EXPECT_EQ(bus.transfer(Command::lrd, 0, testing::zeros(4)).data, bytes({0x03, 0x00, 0, 0}))
      << "through an FMMU";
}

TEST_F(Mii, PortStatus_ReadErrorStaysUntilAnyOfThemIsWritten) {
  SlaveControllerConfiguration configuration;
  configuration.mii.phy_addresses = {0, 5};  // but the chip looks at 0 and 1
  TestBus other(1, configuration);
  EXPECT_EQ(other.read(0, 0x0518, 4).data, bytes({0x03, 0x08, 0, 0}));
  EXPECT_EQ(other.write(0, 0x051B, bytes({0xFF})).working_counter, 1U);
  EXPECT_EQ(number(other.read(0, 0x0518, 4).data) & 0x0808U, 0U);
}

class AllRules final : public base::EventSink {
 public:
  void on_event(const base::Event& event) override {
    sentences.push_back(base::to_sentence(event));
  }
  std::vector<std::string> sentences;
};

TEST_F(Mii, PhyThatIsNotFound_GivesItsPortNoLinkAndSaysSoAtTheStart) {
  SlaveControllerConfiguration configuration;
  configuration.mii.phy_addresses = {0, 5};
  TestBus other(0);
  SlaveController& first = other.add(configuration);
  other.add({});
  EXPECT_FALSE(first.link(1)) << "a powered neighbour is at its cable";
  EXPECT_EQ(other.broadcast_read(0x0000, 1).working_counter, 1U);
  other.write(0, 0x0510, bytes({0x00, 0x01, 0x01, 0x02}));
  other.wait(100_us);
  EXPECT_EQ(number(other.read(0, 0x0510, 2).data) & kReadError, kReadError);
  other.write(0, 0x0510, bytes({0x00, 0x01, 0x05, 0x02}));
  other.wait(100_us);
  EXPECT_EQ(number(other.read(0, 0x0510, 2).data) & kReadError, 0U) << "it is there";

  AllRules sink;
  first.set_event_reporter(base::EventReporter(&sink, 0));
  first.power_on_reset();
  ASSERT_EQ(sink.sentences.size(), 1U);
  EXPECT_TRUE(sink.sentences[0].starts_with(
      "port 1 gets no link: link detection looks for its PHY at address 1 of the management bus"));
}

TEST_F(Mii, PhyThatIsNotFound_DoesNotMatterWhereThePinAloneCounts) {
  SlaveControllerConfiguration configuration = testing::controller_of("tmc8670", "silicon");
  configuration.mii.phy_addresses = {7, 9};
  TestBus other(2, configuration);
  EXPECT_EQ(other.broadcast_read(0x0000, 1).working_counter, 2U);
}

class LastRule final : public base::EventSink {
 public:
  void on_event(const base::Event& event) override { sentence = base::to_sentence(event); }
  std::string sentence;
};

TEST_F(Mii, RefusedCommandsExplainThemselves) {
  LastRule sink;
  slave.set_event_reporter(base::EventReporter(&sink, 0));
  bus.write(0, 0x0510, bytes({0x00, 0x02}));
  EXPECT_EQ(sink.sentence,
            "PHY write refused: bit 0 of register 0510h (write enable) was not set in the same "
            "frame; write 0201h as the command");
  bus.write(0, 0x0510, bytes({0x00, 0x03}));
  EXPECT_EQ(sink.sentence, "MII management command 3 is none of 0 (idle), 1 (read), 2 (write)");
}

}  // namespace
}  // namespace stator::ethercat
