#include "stator/rack/sections/tmc8670_section.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
#include "source_paths.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/control/foc/register_fields.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmc8670/product.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/kept/device_storage.hpp"
#include "stator/rack/networks/serial_line.hpp"

namespace stator::rack {
namespace {

devices::Tmc8670Configuration parsed(const char* text) {
  const toml::table table = toml::parse(text);
  TomlSection section("rack.toml", "[[segment.device]] number 1", table);
  devices::Tmc8670Configuration configuration;
  read_tmc8670(section, configuration);
  section.finish();
  return configuration;
}

std::string refusal(const char* text) {
  try {
    parsed(text);
  } catch (const RackFileError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Tmc8670Section, AnEmptyTableIsTheChipWithAMotorThatFitsItsObjects) {
  const devices::Tmc8670Configuration configuration = parsed("");
  const auto& motor = std::get<plant::ThreePhaseMotorParameters>(configuration.axis.motor);
  EXPECT_EQ(motor.pole_pairs, 4);
  EXPECT_EQ(configuration.axis.encoders[0].counts_per_revolution, 65'536);
  EXPECT_TRUE(configuration.axis.home_switch.level_if_not_fitted) << "pull-ups";
  EXPECT_EQ(configuration.controller, "document");
  EXPECT_TRUE(configuration.objects.empty());
}

TEST(Tmc8670Section, KeysOfTheWorldReachTheirPlaces) {
  const devices::Tmc8670Configuration configuration = parsed(R"(
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
  const devices::Tmc8670Configuration plain = parsed("");
  EXPECT_EQ(plain.tx_shift, (std::array<std::uint8_t, 2>{0, 0}));
  EXPECT_FALSE(plain.link_polarity);
  EXPECT_FALSE(plain.host_controls_time);
  const devices::Tmc8670Configuration strapped = parsed(R"(
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
  EXPECT_EQ(parsed("phy_addresses = [0, 5]").phy_addresses, (std::array<std::uint8_t, 2>{0, 5}));
  const devices::Tmc8670Configuration automatic =
      parsed("tx_shift = 'automatic'\ntx_clock_phase = [0, 15]");
  EXPECT_FALSE(automatic.tx_shift.has_value());
  EXPECT_EQ(automatic.tx_clock_phase, (std::array<std::uint8_t, 2>{0, 15}));
  for (const char* wrong :
       {"tx_shift = [0, 4]", "tx_shift = [1]", "tx_shift = 2", "tx_shift = ['a', 'b']",
        "tx_shift = 'manual'", "tx_clock_phase = [0, 31]", "link_polarity = 'medium'",
        "phy_addresses = [0, 32]"}) {
    EXPECT_NE(refusal(wrong), "accepted") << wrong;
  }
}

TEST(Tmc8670Section, EveryKindOfMotorIsKnown) {
  const auto motor = [](const char* text) { return parsed(text).axis.motor; };
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
  const std::string unknown = refusal("axis.motor = 'QBL4208-61-04'");
  EXPECT_NE(unknown.find("QBL4208-61-04-013"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("dc"), std::string::npos) << unknown;
}

TEST(Tmc8670Section, ObjectsGetOtherDefaults) {
  const devices::Tmc8670Configuration configuration = parsed(R"(
    objects = { "2030:03" = 312, "6065h" = 1000, "2013:1" = -5 }
  )");
  ASSERT_EQ(configuration.objects.size(), 3U);
  const auto device = make_ethercat_device({devices::tmc8670_product(), configuration}, {});
  const dictionary::Dictionary& dictionary = device->dictionary();
  EXPECT_EQ(dictionary.find(0x2030, 3)->value(), 312U);
  EXPECT_EQ(dictionary.find(0x6065, 0)->value(), 1000U);
  EXPECT_EQ(dictionary.find(0x2013, 1)->signed_value(), -5);
  device->set_power(false, {});
  device->set_power(true, {});
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
    const std::string said = refusal(c.text);
    EXPECT_NE(said.find(c.reason), std::string::npos) << c.text << ": " << said;
  }
}

TEST(Tmc8670Section, ThePwmFrequencyIsTheChipsAndNoKeyOfTheInverter) {
  const std::string said = refusal("[axis.inverter]\non_resistance = 0.02\npwm_frequency = 50e3");
  EXPECT_NE(said.find("the chip makes the PWM"), std::string::npos) << said;
  EXPECT_NE(said.find("2001:01"), std::string::npos) << said;
  EXPECT_NE(said.find("3:"), std::string::npos) << said;
}

TEST(Tmc8670Section, DeadTimeIsAtMostATenthOfThePeriodTheChipIsDeliveredWith) {
  const auto dead_time = [](const char* text) { return parsed(text).axis.inverter.dead_time; };
  EXPECT_EQ(dead_time("axis.inverter.dead_time = 4e-6"), 4e-6) << "25 kHz";
  EXPECT_NE(refusal("axis.inverter.dead_time = 4.1e-6").find("PWM period, 4e-06 s"),
            std::string::npos);
  // 50 kHz by object, wherever it stands in the file.
  EXPECT_EQ(dead_time("axis.inverter.dead_time = 2e-6\nobjects = { \"2001:01\" = 1999 }"), 2e-6);
  EXPECT_NE(refusal("axis.inverter.dead_time = 2.1e-6\nobjects = { \"2001:1\" = 1999 }")
                .find("PWM period, 2e-06 s"),
            std::string::npos);
}

TEST(Tmc8670Section, TheReadyRackFileIsRead) {
  const RackConfiguration rack =
      load_rack_file(STATOR_SOURCE_DIR "/racks/ethercat-servo.toml", devices::products());
  ASSERT_EQ(rack.segments.size(), 1U);
  const auto& configuration =
      rack.segments[0].devices.at(0).setup.as<devices::Tmc8670Configuration>();
  EXPECT_GT(configuration.objects.size(), 10U);
}

TEST(Tmc8670Storage, StoredParametersLieInTheStateDirectory) {
  const tests::TemporaryDirectory temporary;
  const std::string folder = temporary.path() + "/state";
  const auto write = [](const dictionary::Dictionary& dictionary, std::uint16_t index,
                        std::uint8_t subindex, std::uint32_t value) {
    dictionary::Entry& entry = *dictionary.find(index, subindex);
    std::array<std::byte, 4> bytes{};
    base::store_le(bytes, 0, value);
    EXPECT_TRUE(dictionary.write(entry, std::span(bytes).first(entry.size()), {}));
  };
  {
    devices::Tmc8670 device{devices::Tmc8670Configuration{}};
    DeviceStorage storage(folder);
    storage.attach("servo", device, {});
    write(device.dictionary(), 0x2030, 3, 77);
    write(device.dictionary(), 0x1010, 1, 0x65766173);
    storage.flush({});
  }
  EXPECT_TRUE(std::filesystem::exists(folder + "/servo.parameters"));
  devices::Tmc8670 device{devices::Tmc8670Configuration{}};
  DeviceStorage storage(folder);
  storage.attach("servo", device, {});
  EXPECT_EQ(device.dictionary().find(0x2030, 3)->value(), 77U);
  EXPECT_EQ(device.axis().stage().block().get(control::foc::field("PID_TORQUE_P")), 77);
}

/// What programs at the other end of a line get, and when the last byte came.
struct Listener {
  void hear(std::span<const std::byte> came) {
    bytes.insert(bytes.end(), came.begin(), came.end());
    last = now;
  }
  std::vector<std::byte> bytes;
  base::SimTime now;
  base::SimTime last;
};

TEST(Tmc8670SerialLine, BytesTakeTheTimeOfTheirBits) {
  devices::Tmc8670 device{devices::Tmc8670Configuration{}};
  SerialLine line({.link = "pty:/tmp/foc", .pacing = true});
  ASSERT_TRUE(line.add(device, "hardware-uart"));
  Listener listener;
  line.connect(SerialLine::Output::bind<&Listener::hear>(listener));
  const auto pass_until = [&](base::SimTime end) {
    for (; line.next_deadline() <= end; listener.now = line.next_deadline()) {
      const base::SimTime next = line.next_deadline();
      listener.now = next;
      device.advance(next);
      line.advance(next);
    }
    listener.now = end;
    device.advance(end);
    line.advance(end);
  };
  const auto ask = [&](std::array<std::uint8_t, 5> datagram) {
    listener.bytes.clear();
    const base::SimTime begin = listener.now;
    line.put(std::as_bytes(std::span(datagram)), begin);
    pass_until(begin + base::SimDuration(20'000'000));
    EXPECT_EQ(listener.bytes.size(), 5U);
    return listener.last - begin;
  };
  // Five bytes there and five back, of ten bits each.
  EXPECT_NEAR(ask({0, 0, 0, 0, 0}).seconds(), 100.0 / 9600.0, 1e-6);
  EXPECT_EQ(listener.bytes[2], std::byte{0x36});
  EXPECT_NEAR(ask({0xF9, 0x00, 0x11, 0x52, 0x00}).seconds(), 100.0 / 9600.0, 1e-6)
      << "the reply still comes at the old speed";
  EXPECT_EQ(line.speed(), 115'200U);
  EXPECT_NEAR(ask({0, 0, 0, 0, 0}).seconds(), 100.0 / 115'200.0, 1e-6);
}

}  // namespace
}  // namespace stator::rack
