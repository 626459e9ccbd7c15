// What a rack file says of a TMC8670.

#include <array>
#include <cstdint>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "stator/devices/tmc8670/keys.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/formats/toml/toml.hpp"
#include "stator/settings/reader.hpp"

namespace stator::devices {
namespace {

Tmc8670Configuration read_chip(const char* text, settings::Problems& problems) {
  const auto table = formats::parse_toml(text, "rack.toml");
  const settings::Reading reading{problems, nullptr, "rack.toml"};
  settings::Reader reader(reading, "[[segment.device]] number 1", *table);
  Tmc8670Configuration configuration;
  settings::read_section(kTmc8670Keys, reader, configuration);
  return configuration;
}

Tmc8670Configuration chip_with(const char* text) {
  settings::Problems problems;
  Tmc8670Configuration configuration = read_chip(text, problems);
  EXPECT_TRUE(problems.list.empty()) << text << ": " << problems.list.front().text();
  return configuration;
}

std::string refusal_of(const char* text) {
  settings::Problems problems;
  read_chip(text, problems);
  return problems.list.empty() ? "accepted" : problems.list.front().text();
}

TEST(Tmc8670Section, AnEmptyTableIsTheChipWithAMotorThatFitsItsObjects) {
  const Tmc8670Configuration configuration = chip_with("");
  const auto& motor = std::get<plant::ThreePhaseMotorParameters>(configuration.axis.motor);
  EXPECT_EQ(motor.pole_pairs, 4);
  EXPECT_EQ(configuration.axis.encoders[0].counts_per_revolution, 65'536);
  EXPECT_TRUE(configuration.axis.home_switch.level_if_not_fitted) << "pull-ups";
  EXPECT_EQ(configuration.controller, "document");
  EXPECT_TRUE(configuration.objects.empty());
}

TEST(Tmc8670Section, KeysOfTheWorldReachTheirPlaces) {
  const Tmc8670Configuration configuration = chip_with(R"(
    alias = 7
    serial_number = 99
    controller = "silicon"
    clock_deviation_ppb = -20000
    [axis]
    supply_voltage = 36
    inverter = { model = "switched", dead_time = 2e-7 }
    converter = { bits = 12, current_u = { gain = -500, noise = 3 }, voltage = { gain = 900 } }
    encoder = { counts_per_revolution = 4000 }
    encoder_2 = { counts_per_revolution = 1000, reversed = true }
    encoder_disturbance = { eccentricity = 0.1, missed_edges = 1e-6 }
    analog_encoder = { periods_per_revolution = 512, track_2 = { amplitude = 15000 } }
    halls = { offset = 10 }
    left_switch = { pressed_to = -1 }
    noise_seed = 5
  )");
  EXPECT_EQ(configuration.coe.station_alias, 7);
  EXPECT_EQ(configuration.serial_number, 99U);
  EXPECT_EQ(configuration.controller, "silicon");
  EXPECT_EQ(configuration.clock_deviation_ppb, -20'000);
  const plant::PwmAxisParameters& axis = configuration.axis;
  EXPECT_EQ(axis.supply_voltage, 36.0);
  EXPECT_EQ(axis.inverter_model, plant::InverterModel::switched);
  EXPECT_EQ(axis.inverter.dead_time, 2e-7);
  EXPECT_EQ(axis.converter.bits, 12);
  EXPECT_EQ(axis.converter.currents[0].gain, -500.0);
  EXPECT_EQ(axis.converter.currents[0].noise, 3.0);
  EXPECT_EQ(axis.converter.currents[1].gain, 1000.0);
  EXPECT_EQ(axis.converter.voltage.gain, 900.0);
  EXPECT_EQ(axis.encoders[0].counts_per_revolution, 4000);
  EXPECT_TRUE(axis.encoders[1].reversed);
  EXPECT_NEAR(axis.encoder_disturbances[0].eccentricity, 0.00174533, 1e-8);
  EXPECT_EQ(axis.encoder_disturbances[0].missed_edge_probability, 1e-6);
  EXPECT_EQ(axis.analog_encoder.tracks, 2U);
  EXPECT_EQ(axis.analog_encoder.periods_per_revolution, 512);
  EXPECT_EQ(axis.analog_encoder.track[1].amplitude, 15'000.0);
  EXPECT_NEAR(axis.halls.offset, 0.174533, 1e-6);
  EXPECT_TRUE(axis.left_switch.fitted);
  EXPECT_EQ(axis.noise_seed, 5U);
}

TEST(Tmc8670Section, StrapsAreThoseOfTheBoard) {
  const Tmc8670Configuration plain = chip_with("");
  EXPECT_EQ(plain.tx_shift, (std::array<std::uint8_t, 2>{0, 0}));
  EXPECT_FALSE(plain.link_polarity);
  EXPECT_FALSE(plain.host_controls_time);
  const Tmc8670Configuration strapped = chip_with(R"(
    tx_shift = [0, 2]
    link_polarity = "high"
    phy_link_polarity = "high"
    host_controls_time = true
  )");
  EXPECT_EQ(strapped.tx_shift, (std::array<std::uint8_t, 2>{0, 2}));
  EXPECT_TRUE(strapped.link_polarity);
  EXPECT_TRUE(strapped.phy_link_active_high[0] && strapped.phy_link_active_high[1]);
  EXPECT_TRUE(strapped.host_controls_time);
  EXPECT_FALSE(strapped.phy_addresses.has_value());
  EXPECT_EQ(chip_with("phy_addresses = [0, 5]").phy_addresses, (std::array<std::uint8_t, 2>{0, 5}));
  const Tmc8670Configuration automatic =
      chip_with("tx_shift = 'automatic'\ntx_clock_phase = [0, 15]");
  EXPECT_FALSE(automatic.tx_shift.has_value());
  EXPECT_EQ(automatic.tx_clock_phase, (std::array<std::uint8_t, 2>{0, 15}));
  for (const char* wrong :
       {"tx_shift = [0, 4]", "tx_shift = [1]", "tx_shift = 2", "tx_shift = ['a', 'b']",
        "tx_shift = 'manual'", "tx_clock_phase = [0, 31]", "link_polarity = 'medium'",
        "phy_addresses = [0, 32]"}) {
    EXPECT_NE(refusal_of(wrong), "accepted") << wrong;
  }
}

TEST(Tmc8670Section, EveryKindOfMotorIsKnown) {
  const auto motor = [](const char* text) { return chip_with(text).axis.motor; };
  EXPECT_EQ(
      std::get<plant::ThreePhaseMotorParameters>(motor("axis.motor = 'EC45-flat-70W'")).pole_pairs,
      8);
  EXPECT_EQ(
      std::get<plant::StepperMotorParameters>(motor("axis.motor = 'QSH5718-55-30-098'")).pole_pairs,
      50);
  const auto direct = std::get<plant::DcMotorParameters>(
      motor("axis = { motor = 'dc', motor_data = { resistance = 2, torque_constant = 0.05 } }"));
  EXPECT_EQ(direct.resistance, 2.0);
  EXPECT_EQ(direct.torque_constant, 0.05);
  const std::string unknown = refusal_of("axis.motor = 'QBL4208-61-04'");
  EXPECT_NE(unknown.find("QBL4208-61-04-013"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("dc"), std::string::npos) << unknown;
}

TEST(Tmc8670Section, ObjectsGetOtherDefaults) {
  const Tmc8670Configuration configuration = chip_with(R"(
    objects = { "2030:03" = 312, "6065h" = 1000, "2013:1" = -5 }
  )");
  ASSERT_EQ(configuration.objects.size(), 3U);
  Tmc8670 device(configuration);
  const dictionary::Dictionary& dictionary = device.dictionary();
  EXPECT_EQ(dictionary.find(0x2030, 3)->value(), 312U);
  EXPECT_EQ(dictionary.find(0x6065, 0)->value(), 1000U);
  EXPECT_EQ(dictionary.find(0x2013, 1)->signed_value(), -5);
  device.set_power(false, {});
  device.set_power(true, {});
  EXPECT_EQ(dictionary.find(0x2030, 3)->value(), 312U);
}

TEST(Tmc8670Section, ObjectsThatDoNotExistOrDoNotTakeTheValueAreRefusedWithTheirLine) {
  struct Case {
    const char* text;
    const char* reason;
  };
  for (const Case& c :
       {Case{"objects = { \"2999:01\" = 1 }", "no such object"},
        Case{"objects = { \"torque\" = 1 }", "names no object"},
        Case{"objects = { \"2030:\" = 1 }", "names no object"},
        Case{"objects = { \"2000:01\" = 4 }", "cannot be 4"},
        Case{"objects = { \"6041\" = 1 }", "cannot be 1"},
        Case{"objects = { \"1008\" = 1 }", "it is a text"},
        Case{"objects = { \"2000:02\" = 70000 }", "does not fit UNSIGNED16"},
        Case{"objects = { \"2030:03\" = \"P\" }", "rack.toml"},
        Case{"\n\nobjects = { \"2999:01\" = 1 }", "3"}, Case{"axis = { gain = 1 }", "unknown key"},
        Case{"axis = { converter = { bits = 17 } }", "bits"},
        Case{"controller = 'gold'", "gold"}}) {
    const std::string said = refusal_of(c.text);
    EXPECT_NE(said.find(c.reason), std::string::npos) << c.text << ": " << said;
  }
}

TEST(Tmc8670Section, ThePwmFrequencyIsTheChipsAndNoKeyOfTheInverter) {
  const std::string said =
      refusal_of("[axis.inverter]\non_resistance = 0.02\npwm_frequency = 50e3");
  EXPECT_NE(said.find("the chip makes the PWM"), std::string::npos) << said;
  EXPECT_NE(said.find("2001:01"), std::string::npos) << said;
  EXPECT_NE(said.find("3:"), std::string::npos) << said;
}

TEST(Tmc8670Section, DeadTimeIsAtMostATenthOfThePeriodTheChipIsDeliveredWith) {
  const auto dead_time = [](const char* text) { return chip_with(text).axis.inverter.dead_time; };
  EXPECT_EQ(dead_time("axis.inverter.dead_time = 4e-6"), 4e-6) << "25 kHz";
  EXPECT_NE(refusal_of("axis.inverter.dead_time = 4.1e-6").find("PWM period, 4e-06 s"),
            std::string::npos);
  // 50 kHz by object, wherever it stands in the file.
  EXPECT_EQ(dead_time("axis.inverter.dead_time = 2e-6\nobjects = { \"2001:01\" = 1999 }"), 2e-6);
  EXPECT_NE(refusal_of("axis.inverter.dead_time = 2.1e-6\nobjects = { \"2001:1\" = 1999 }")
                .find("PWM period, 2e-06 s"),
            std::string::npos);
}

}  // namespace
}  // namespace stator::devices
