// What the board around a TMC8670 does to it: supplies of the logic, straps, link pins, partners.

#include <string>

#include "devices/tmc8670_chip.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"

namespace stator::devices {
namespace {

using Bytes = tests::TestBus::Bytes;

class Tmc8670Board : public Tmc8670Chip {
 protected:
  bool answers() { return bus_->answers(); }
  void drive() {
    go_operational();
    write<std::int32_t>(0x60FF, 600);
    enable(3);
    bus_->pass(200_ms);
  }
};

struct Brownout {
  const char* supply;
  double volts;
};
class Tmc8670LogicSupply : public Tmc8670Board, public testing::WithParamInterface<Brownout> {};

TEST_P(Tmc8670LogicSupply, OutsideTheRangeTheChipIsHeldInReset) {
  drive();
  ASSERT_GT(signal("axis0.shaft_speed"), 5.0);
  set_input(GetParam().supply, GetParam().volts);
  bus_->pass(1_ms);
  EXPECT_FALSE(answers());
  EXPECT_EQ(signal("axis0.enable_out"), 0.0);
  EXPECT_EQ(signal("led_link_in"), 0.0);
  ASSERT_FALSE(told_.all.empty());
  EXPECT_NE(told_.all.back().find("held in reset"), std::string::npos) << told_.all.back();
  set_input("supply_3v3", 3.3);
  set_input("supply_1v2", 1.2);
  bus_->pass(1_ms);
  EXPECT_TRUE(answers());
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->read(0x0130, 2), 0), 1U) << "Init";
  EXPECT_EQ(signal("axis0.enable_out"), 0.0) << "all was forgotten";
  drive();
  EXPECT_GT(signal("axis0.shaft_speed"), 5.0);
}

INSTANTIATE_TEST_SUITE_P(Rails, Tmc8670LogicSupply,
                         testing::Values(Brownout{"supply_3v3", 3.14}, Brownout{"supply_3v3", 3.46},
                                         Brownout{"supply_1v2", 1.13},
                                         Brownout{"supply_1v2", 1.27}));

TEST_F(Tmc8670Board, LimitsOfOperationAreWithinTheRange) {
  for (const double volts : {3.15, 3.45}) {
    set_input("supply_3v3", volts);
    EXPECT_TRUE(answers()) << volts;
  }
  for (const double volts : {1.14, 1.26}) {
    set_input("supply_1v2", volts);
    EXPECT_TRUE(answers()) << volts;
  }
  EXPECT_TRUE(told_.all.empty());
}

TEST_F(Tmc8670Board, BeyondTheAbsoluteMaximumTheChipIsDamagedForGood) {
  for (const Brownout& beyond :
       {Brownout{"supply_3v3", 3.64}, {"supply_1v2", 1.33}, {"supply_3v3", -0.31}}) {
    renew();
    told_.all.clear();
    set_input(beyond.supply, beyond.volts);
    ASSERT_EQ(told_.all.size(), 1U);
    EXPECT_NE(told_.all[0].find("damaged"), std::string::npos) << told_.all[0];
    set_input("supply_3v3", 3.3);
    set_input("supply_1v2", 1.2);
    EXPECT_FALSE(answers());
    device_->set_power(false, bus_->now());
    bus_->pass(10_ms);
    device_->set_power(true, bus_->now());
    bus_->pass(10_ms);
    EXPECT_FALSE(answers()) << "no switching on heals it";
  }
  renew();
  EXPECT_TRUE(answers());
}

TEST_F(Tmc8670Board, SwitchedOffNothingHappensToItsLogic) {
  device_->set_power(false, bus_->now());
  set_input("supply_1v2", 2.0);
  set_input("supply_1v2", 1.2);
  device_->set_power(true, bus_->now());
  EXPECT_TRUE(answers());
  device_->set_power(false, bus_->now());
  set_input("supply_1v2", 1.0);
  device_->set_power(true, bus_->now());
  EXPECT_FALSE(answers()) << "a regulator that gives too little";
}

TEST_F(Tmc8670Board, LinkPinsFollowPhysStrapAndInput) {
  EXPECT_EQ(signal("link_pin_in"), 0.0) << "active low by the pull-down";
  EXPECT_EQ(signal("link_pin_out"), 1.0) << "nobody there";
  set_input("link_pin_in", 1.0);
  EXPECT_FALSE(answers());
  set_input("link_pin_in", -1.0);
  EXPECT_TRUE(answers());
  Tmc8670Configuration configuration = tuned_chip();
  configuration.link_polarity = true;
  renew(configuration);
  EXPECT_FALSE(answers()) << "the PHYs are active low";
  set_input("link_pin_in", 1.0);
  EXPECT_TRUE(answers());
  configuration.phy_link_active_high = {true, true};
  renew(configuration);
  EXPECT_TRUE(answers());
  EXPECT_EQ(signal("link_pin_in"), 1.0);
}

TEST_F(Tmc8670Board, PartnersThatAreUnfitTakeTheLink) {
  EXPECT_EQ(bus_->read(0x0518, 1), Bytes{std::byte{0x03}});
  for (const double kind : {1.0, 2.0, 3.0}) {
    set_input("link_partner_in", kind);
    EXPECT_FALSE(answers()) << kind;
    Bytes status(2);
    device_->controller().peek(0x0110, status);
    EXPECT_EQ(base::load_le<std::uint16_t>(status, 0) & 0x0210U, 0U) << "no link";
    set_input("link_partner_in", 0.0);
    EXPECT_TRUE(answers());
  }
}

TEST_F(Tmc8670Board, TransmitShiftOfTheConfigurationDelaysThePort) {
  const auto delays = [this] { return device_->controller().forwarding().transmit_delay; };
  EXPECT_EQ(delays()[0] + delays()[1], base::SimDuration());
  Tmc8670Configuration configuration = tuned_chip();
  configuration.tx_shift = {{1, 3}};
  renew(configuration);
  EXPECT_EQ(delays()[0], base::SimDuration(10));
  EXPECT_EQ(delays()[1], base::SimDuration(30));
  configuration.tx_shift.reset();
  configuration.tx_clock_phase = {0, 12};
  renew(configuration);
  EXPECT_EQ(delays()[0], base::SimDuration());
  EXPECT_EQ(delays()[1], base::SimDuration(20));
}

TEST_F(Tmc8670Board, HostControlledTimeIsRefusedToTheMaster) {
  Bytes time(4, std::byte{1});
  EXPECT_TRUE(bus_->write(0x0910, time));
  Tmc8670Configuration configuration = tuned_chip();
  configuration.host_controls_time = true;
  renew(configuration);
  EXPECT_FALSE(bus_->write(0x0910, time));
}

}  // namespace
}  // namespace stator::devices
