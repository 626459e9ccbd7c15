// What gives a port its link: cable, PHY and partner, link pin, reset; and when it sends.

#include <array>

#include <gtest/gtest.h>

#include "ethercat/controllers.hpp"
#include "ethercat/master_delays.hpp"
#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using testing::bytes;
using testing::little_endian;
using testing::measure_delays;
using testing::number;
using testing::TestBus;
using testing::zeros;

unsigned reachable(TestBus& bus) {
  return bus.broadcast_read(0x0000, 1).working_counter;
}
unsigned port_status(TestBus& bus, unsigned port) {
  return static_cast<unsigned>(
      number(bus.read(0, static_cast<std::uint16_t>(0x0518 + port), 1).data));
}
unsigned dl_status(TestBus& bus) {
  return static_cast<unsigned>(number(bus.read(0, 0x0110, 2).data));
}
void write_phy(TestBus& bus, unsigned phy, unsigned phy_register, unsigned value) {
  bus.write(0, 0x0514, little_endian(value, 2));
  bus.write(0, 0x0510, bytes({0x01, 0x02, phy, phy_register}));
  bus.wait(SimDuration(100'000));
}
unsigned read_phy(TestBus& bus, unsigned phy, unsigned phy_register) {
  bus.write(0, 0x0510, bytes({0x00, 0x01, phy, phy_register}));
  bus.wait(SimDuration(100'000));
  return static_cast<unsigned>(number(bus.read(0, 0x0514, 2).data));
}

struct PartnerCase {
  LinkPartner partner;
  unsigned abilities;  ///< PHY register 5
  unsigned expansion;  ///< PHY register 6
};

class UnfitPartner : public ::testing::TestWithParam<PartnerCase> {};

TEST_P(UnfitPartner, GivesALinkThatIsInhibitedAndNamesThePartner) {
  TestBus bus(2);
  EXPECT_EQ(port_status(bus, 1), 0x03U);
  bus.slave().set_link_partner(1, GetParam().partner);
  EXPECT_EQ(port_status(bus, 1), 0x15U) << "link, error, partner error, nothing usable";
  EXPECT_EQ(port_status(bus, 0), 0x03U) << "the other port";
  EXPECT_EQ(read_phy(bus, 1, 1) & 0x0004U, 0x0004U) << "physical link";
  EXPECT_EQ(read_phy(bus, 1, 5), GetParam().abilities);
  EXPECT_EQ(read_phy(bus, 1, 6), GetParam().expansion);
  EXPECT_EQ(dl_status(bus), 0x5613U) << "port 1 without link and closed";
  EXPECT_EQ(number(bus.read(0, 0x0311, 1).data), 1U) << "lost link";
  EXPECT_EQ(reachable(bus), 1U);
  bus.slave().set_link_partner(1, LinkPartner::full);
  EXPECT_EQ(port_status(bus, 1), 0x03U);
  EXPECT_EQ(reachable(bus), 2U);
}

INSTANTIATE_TEST_SUITE_P(Kinds, UnfitPartner,
                         ::testing::Values(PartnerCase{LinkPartner::ten_megabit, 0x4061, 1},
                                           PartnerCase{LinkPartner::half_duplex, 0x40A1, 1},
                                           PartnerCase{LinkPartner::fixed, 0x0080, 0}));

TEST(PortLink, OfAnUnfitPartnerTakesNoFramesFromTheOtherEndEither) {
  TestBus bus(2);
  bus.segment().connect(MasterInterface::secondary, {1, 1});
  bus.slave().set_link_partner(1, LinkPartner::half_duplex);
  bus.write(0, 0x0101, bytes({0x08}));  // open without link
  bus.from(MasterInterface::secondary);
  EXPECT_FALSE(bus.broadcast_read(0x0000, 1).returned);
}

TEST(PortLink, WithoutCableShowsNoErrorWhateverThePartner) {
  TestBus bus(1);
  bus.slave().set_link_partner(1, LinkPartner::half_duplex);
  EXPECT_EQ(port_status(bus, 1), 0U);
}

TEST(PortLink, PhyThatIsStrappedNotToNegotiateIsConfiguredAndThatIsShownUntilCleared) {
  SlaveControllerConfiguration configuration;
  configuration.mii.phy_control = {0x3100, 0x2100};
  TestBus bus(0);
  bus.add(configuration);
  bus.add({});
  EXPECT_EQ(port_status(bus, 0), 0x03U);
  EXPECT_EQ(port_status(bus, 1), 0x23U);
  EXPECT_EQ(read_phy(bus, 1, 0), 0x3100U);
  EXPECT_EQ(reachable(bus), 2U);
  EXPECT_EQ(bus.write(0, 0x0518, bytes({0})).working_counter, 1U);
  EXPECT_EQ(port_status(bus, 1), 0x03U);
  bus.slave().power_on_reset();
  EXPECT_EQ(port_status(bus, 1), 0x23U) << "the reset brought the straps back";
}

TEST(PortLink, PhyThatAMasterMisconfiguresIsConfiguredAtTheNextNegotiation) {
  TestBus bus(2);
  write_phy(bus, 1, 4, 0x0081);  // offers 100 Mbit/s half duplex
  EXPECT_EQ(port_status(bus, 1), 0x03U) << "counts from the next negotiation on";
  write_phy(bus, 1, 0, 0x1200);
  EXPECT_EQ(port_status(bus, 1), 0x23U);
  EXPECT_EQ(read_phy(bus, 1, 4), 0x01E1U);
  bus.write(0, 0x051B, bytes({0}));
  write_phy(bus, 1, 0, 0x2100);  // no negotiation
  EXPECT_EQ(port_status(bus, 1), 0x23U);
  EXPECT_EQ(reachable(bus), 2U);
}

/// The TMC8670 without link detection through the management bus: the pin alone counts.
SlaveControllerConfiguration without_detection() {
  return testing::controller_of("tmc8670", "silicon");
}

TEST(PortLink, WithoutDetectionOfAMisconfiguredPhyGoesDownAndNobodyRepairsIt) {
  TestBus bus(2, without_detection());
  EXPECT_EQ(reachable(bus), 2U);
  write_phy(bus, 1, 0, 0x0100);  // 10 Mbit/s full duplex, no negotiation
  EXPECT_EQ(reachable(bus), 1U);
  EXPECT_EQ(read_phy(bus, 1, 1) & 0x0024U, 0x0004U) << "a link, not negotiated";
  EXPECT_EQ(read_phy(bus, 1, 5), 0U);
  EXPECT_EQ(port_status(bus, 1), 0U) << "not shown either";
  write_phy(bus, 1, 0, 0x1900);  // power down
  EXPECT_EQ(read_phy(bus, 1, 1) & 0x0024U, 0U);
  write_phy(bus, 1, 0, 0x1200);
  EXPECT_EQ(reachable(bus), 2U);
}

TEST(LinkPin, IsActiveLowByDefaultAndFollowsThePhy) {
  TestBus bus(1);
  EXPECT_FALSE(bus.slave().link_pin(0)) << "link";
  EXPECT_TRUE(bus.slave().link_pin(1)) << "no link";
  bus.slave().set_link_partner(0, LinkPartner::ten_megabit);
  EXPECT_TRUE(bus.slave().link_pin(0));
}

TEST(LinkPin, HeldHighTakesTheLinkAndHeldLowGivesNoneWithoutAPartner) {
  TestBus bus(2);
  bus.slave().hold_link_pin(1, true);
  EXPECT_EQ(dl_status(bus), 0x5613U);
  EXPECT_EQ(reachable(bus), 1U);
  bus.slave().hold_link_pin(1, std::nullopt);
  EXPECT_EQ(reachable(bus), 2U);
  bus.slave(1).hold_link_pin(1, false);
  EXPECT_FALSE(bus.slave(1).link(1)) << "link detection finds no link in the PHY";
}

TEST(LinkPin, PolarityIsThatOfTheStrapForBothPorts) {
  for (const bool active_high : {false, true}) {
    for (const bool phys_active_high : {false, true}) {
      SlaveControllerConfiguration configuration;
      configuration.link_active_high = active_high;
      configuration.mii.phy_link_active_high = {phys_active_high, phys_active_high};
      SlaveController slave(configuration);
      slave.set_link(0, true);
      slave.set_link(1, true);
      EXPECT_EQ(slave.link_pin(0), phys_active_high);
      EXPECT_EQ(slave.link(0), active_high == phys_active_high);
      EXPECT_EQ(slave.link(1), active_high == phys_active_high);
    }
  }
}

TEST(LinkPin, OfTheWrongPolarityOpensAnEmptyPortWhereFramesGetLost) {
  SlaveControllerConfiguration wrong = without_detection();
  wrong.mii.phy_link_active_high = {false, true};
  TestBus bus(1, wrong);
  EXPECT_TRUE(bus.slave().link(1)) << "the strap says low is a link, the PHY drives low without";
  EXPECT_FALSE(bus.broadcast_read(0x0000, 1).returned);
  EXPECT_EQ(bus.segment().statistics().lost, 1U);
  bus.slave().hold_link_pin(1, true);
  EXPECT_EQ(reachable(bus), 1U);
}

/// Delays of the slaves behind the first as a master measures them.
std::uint32_t measured(const MiiSettings& first, const MiiSettings& second) {
  TestBus bus(0);
  SlaveControllerConfiguration configuration;
  configuration.mii = first;
  bus.add(configuration);
  configuration.mii = second;
  bus.add(configuration, SimDuration(50));
  const auto times = measure_delays(bus);
  return times[0].receive_times[1] - times[0].receive_times[0];
}
MiiSettings shifted(std::uint8_t port0, std::uint8_t port1) {
  MiiSettings settings;
  settings.transmit_shift = {port0, port1};
  return settings;
}

TEST(TransmitShift, EachStepDelaysWhatLeavesThePortBy10ns) {
  const std::uint32_t plain = measured({}, {});
  EXPECT_EQ(plain, 2 * 300U + 2 * 50U);
  for (unsigned steps = 0; steps < 4; ++steps) {
    const auto strap = static_cast<std::uint8_t>(steps);
    EXPECT_EQ(measured(shifted(0, strap), {}), plain + 10 * steps) << "out of the first";
    EXPECT_EQ(measured({}, shifted(strap, 0)), plain + 10 * steps) << "back from the second";
    EXPECT_EQ(measured(shifted(strap, 0), shifted(0, strap)), plain) << "not on this way";
  }
}

TEST(TransmitShift, LengthensTheRoundTripAndTheTimeAtTheNextSlave) {
  const auto arrival = [](const MiiSettings& settings) {
    TestBus bus(0);
    SlaveControllerConfiguration configuration;
    configuration.mii = settings;
    bus.add(configuration);
    bus.add({});
    bus.broadcast_write(0x0900, zeros(4));
    return std::array{number(bus.read(1, 0x0918, 8).data),
                      static_cast<std::uint64_t>(bus.segment().round_trip(60).nanoseconds())};
  };
  const auto plain = arrival({});
  const auto later = arrival(shifted(1, 3));
  EXPECT_EQ(later[0], plain[0] + 30);
  EXPECT_EQ(later[1], plain[1] + 40) << "and 10 ns towards the master";
}

TEST(TransmitShift, AutomaticFindsTheStepsThatTheClocksOfThePhysNeed) {
  const auto delay = [](unsigned phase) {
    MiiSettings settings = shifted(3, 3);
    settings.automatic_transmit_shift = true;
    settings.transmit_clock_phase = {0, static_cast<std::uint8_t>(phase)};
    return transmit_delay(settings, 1).nanoseconds();
  };
  EXPECT_EQ(delay(0), 0) << "the straps are idle";
  EXPECT_EQ(delay(1), 10);
  EXPECT_EQ(delay(10), 10);
  EXPECT_EQ(delay(11), 20);
  EXPECT_EQ(delay(30), 30);
  MiiSettings automatic;
  automatic.automatic_transmit_shift = true;
  automatic.transmit_clock_phase = {0, 15};
  EXPECT_EQ(measured(automatic, {}), measured({}, {}) + 20);
}

TEST(HeldInReset, ChipIsGoneForItsNeighboursAndStartsAnewWhenLetGo) {
  TestBus bus(3);
  bus.write(1, 0x0010, bytes({0x07, 0x00}));
  bus.slave(1).hold_reset(true);
  EXPECT_EQ(reachable(bus), 1U);
  EXPECT_EQ(dl_status(bus), 0x5613U) << "the neighbour's link is down";
  EXPECT_FALSE(bus.slave(2).link(0));
  bus.slave(1).hold_reset(false);
  EXPECT_TRUE(bus.slave(1).take_reset_request());
  EXPECT_EQ(reachable(bus), 3U);
  EXPECT_EQ(number(bus.read(1, 0x0010, 2).data), 0U);
}

TEST(HeldInReset, IsNotEndedByPowerThatComesBack) {
  TestBus bus(2);
  bus.slave(1).hold_reset(true);
  bus.segment().set_power(1, false);
  bus.segment().set_power(1, true);
  EXPECT_EQ(reachable(bus), 1U);
}

}  // namespace
}  // namespace stator::ethercat
