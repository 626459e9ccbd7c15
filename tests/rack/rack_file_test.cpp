// Where each key of a rack file arrives, and how an error names place, expectation and likely word.
#include "stator/rack/file/rack_file.hpp"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "source_paths.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/settings/words.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kMinimal = R"(
[[segment]]
[[segment.device]]
type = "tmcm-3315"
)";

std::string refusal_of(const std::string& text) {
  try {
    (void)parse_rack_file(text, "test.toml", devices::products());
  } catch (const RackFileError& error) {
    return error.what();
  }
  return "accepted";
}

const devices::Tmcm3315Configuration& module_of(const RackConfiguration& rack) {
  return rack.segments.at(0).devices.at(0).setup.as<devices::Tmcm3315Configuration>();
}

TEST(RackFile, AMinimalFileGetsTheDocumentedDefaults) {
  const RackConfiguration rack = parse_rack_file(kMinimal, "test.toml", devices::products());
  EXPECT_EQ(rack.clock, ClockKind::real);
  EXPECT_EQ(rack.cycle, 1_ms);
  ASSERT_EQ(rack.segments.size(), 1U);
  EXPECT_TRUE(rack.segments[0].link.in_process());
  EXPECT_EQ(rack.segments[0].devices[0].name, "tmcm-3315");
  EXPECT_FALSE(rack.record.has_value());
}

TEST(RackFile, KeysOfEepromFirmwareAndBus_ArriveAtTheDevice) {
  const RackConfiguration rack = parse_rack_file(R"(
state = "kept"
[[segment]]
[[segment.device]]
type = "tmcm-3315"
emergencies = false
require_outputs = true
identification = 5
firmware_erase_time = "200ms"
home_offset_is_position = true
firmware = "1.07"
)",
                                                 "test.toml", devices::products());
  EXPECT_EQ(rack.state, "kept");
  EXPECT_FALSE(module_of(rack).coe.emergencies);
  EXPECT_TRUE(module_of(rack).coe.require_outputs);
  EXPECT_EQ(module_of(rack).coe.identification, 5);
  EXPECT_EQ(module_of(rack).coe.firmware_erase_time, 200_ms);
  EXPECT_TRUE(module_of(rack).home_offset_is_position);
  EXPECT_EQ(module_of(rack).firmware, devices::tmcm_3315::FirmwareVersion::v1_07);
  const RackConfiguration plain = parse_rack_file(kMinimal, "test.toml", devices::products());
  EXPECT_EQ(plain.state, "");
  EXPECT_TRUE(module_of(plain).coe.emergencies);
  EXPECT_FALSE(module_of(plain).coe.require_outputs);
  EXPECT_FALSE(module_of(plain).coe.identification);
  EXPECT_EQ(module_of(plain).coe.firmware_erase_time, 0_ms);
  EXPECT_FALSE(module_of(plain).home_offset_is_position);
  EXPECT_EQ(module_of(plain).firmware, devices::tmcm_3315::FirmwareVersion::v1_09);
}

TEST(RackFile, BrakeAndOpenInputsArriveWhereTheyBelong) {
  const RackConfiguration rack = parse_rack_file(std::string(kMinimal) + R"(
[[segment.device.axis]]
load.brake_torque = 1.5
brake = { output = 3, pull_in = 0.6, closed_by_current = true, release_time = "40ms", apply_time = "25ms" }
open_inputs_high = true
left_switch.pressed_to = -1.0
[[segment.device.axis]]
)",
                                                 "test.toml", devices::products());
  const plant::StepperAxisParameters& axis = module_of(rack).axes[0];
  EXPECT_EQ(axis.brake.output, 3);
  EXPECT_EQ(axis.brake.pull_in_duty, 0.6);
  EXPECT_TRUE(axis.brake.closed_by_current);
  EXPECT_EQ(axis.brake.release_time, 40_ms);
  EXPECT_EQ(axis.brake.apply_time, 25_ms);
  EXPECT_FALSE(axis.left_switch.level(0.0)) << "a switch is fitted here";
  EXPECT_TRUE(axis.right_switch.level(0.0));
  EXPECT_TRUE(axis.home_switch.level(0.0));
  EXPECT_FALSE(module_of(rack).axes[1].right_switch.level(0.0));
}

TEST(RackFile, EveryKeyArrivesWhereItBelongs) {
  const RackConfiguration rack = parse_rack_file(R"(
clock = "lockstep"
cycle = "2ms"
step = "100us"
[record]
file = "run.csv"
period = "250us"
signals = ["gantry.axis0.*"]
[[segment]]
link = "ethercat:eth7"
wait = "adaptive"
spin_time = "50us"
cpu = 1
capture = "run.pcap"
[[segment.device]]
type = "tmcm-3315"
name = "gantry"
alias = 17
[[segment.device.axis]]
motor = "QSH5718-79-30-163"
supply_voltage = 36
initial_position = 0.25
load.inertia = 4e-5
load.constant_torque = -0.2
ambient_temperature = 40
supply = { capacitance = 470e-6, source_resistance = 0.3, brake_chopper_voltage = 30, brake_chopper_resistance = 15 }
motor_thermal = { winding_capacity = 30, housing_capacity = 300, winding_to_housing = 2, housing_to_ambient = 5 }
driver = { on_resistance = 0.1, chip_capacity = 0.2, board_capacity = 6, chip_to_board = 9, board_to_ambient = 30 }
encoder.counts_per_revolution = 4000
encoder.index_active_low = true
left_switch.pressed_to = -2.0
home_switch = { pressed_from = 0.0, pressed_to = 0.5, normally_closed = true }
)",
                                                 "test.toml", devices::products());
  EXPECT_EQ(rack.clock, ClockKind::lockstep);
  EXPECT_EQ(rack.cycle, 2_ms);
  EXPECT_EQ(rack.step, 100_us);
  ASSERT_TRUE(rack.record.has_value());
  EXPECT_EQ(rack.record->period, 250_us);
  EXPECT_THAT(rack.record->signals, ::testing::ElementsAre("gantry.axis0.*"));
  const SegmentConfiguration& segment = rack.segments.at(0);
  EXPECT_EQ(segment.link, (link::LinkAddress{link::LinkKind::raw_ethernet, "eth7", 0}));
  EXPECT_EQ(segment.wait, link::WaitMode::adaptive);
  EXPECT_EQ(segment.spin_time, 50_us);
  EXPECT_EQ(segment.cpu, 1U);
  EXPECT_EQ(segment.capture, "run.pcap");
  EXPECT_EQ(segment.devices.at(0).name, "gantry");
  const auto& module = module_of(rack);
  EXPECT_EQ(module.coe.station_alias, 17);
  const plant::StepperAxisParameters& axis = module.axes[0];
  EXPECT_DOUBLE_EQ(axis.motor.resistance, 0.8);
  EXPECT_DOUBLE_EQ(axis.motor.inductance, 3.2e-3);
  EXPECT_DOUBLE_EQ(axis.supply_voltage, 36.0);
  EXPECT_DOUBLE_EQ(axis.initial_revolutions, 0.25);
  EXPECT_DOUBLE_EQ(axis.load.inertia, 4e-5);
  EXPECT_DOUBLE_EQ(axis.load.constant_torque, -0.2);
  EXPECT_DOUBLE_EQ(axis.ambient_temperature, 40.0);
  EXPECT_DOUBLE_EQ(axis.supply.capacitance, 470e-6);
  EXPECT_DOUBLE_EQ(axis.supply.source_resistance, 0.3);
  EXPECT_DOUBLE_EQ(axis.supply.chopper_voltage, 30.0);
  EXPECT_DOUBLE_EQ(axis.supply.chopper_resistance, 15.0);
  EXPECT_DOUBLE_EQ(axis.motor.thermal.inner_capacity, 30.0);
  EXPECT_DOUBLE_EQ(axis.motor.thermal.outer_capacity, 300.0);
  EXPECT_DOUBLE_EQ(axis.motor.thermal.inner_to_outer, 2.0);
  EXPECT_DOUBLE_EQ(axis.motor.thermal.outer_to_ambient, 5.0);
  EXPECT_DOUBLE_EQ(axis.driver.on_resistance, 0.1);
  EXPECT_DOUBLE_EQ(axis.driver.thermal.inner_capacity, 0.2);
  EXPECT_DOUBLE_EQ(axis.driver.thermal.outer_capacity, 6.0);
  EXPECT_DOUBLE_EQ(axis.driver.thermal.inner_to_outer, 9.0);
  EXPECT_DOUBLE_EQ(axis.driver.thermal.outer_to_ambient, 30.0);
  EXPECT_EQ(axis.encoder.counts_per_revolution, 4000);
  EXPECT_TRUE(axis.encoder.index_active_low);
  EXPECT_TRUE(axis.left_switch.fitted);
  EXPECT_DOUBLE_EQ(axis.left_switch.pressed_to, -2.0);
  EXPECT_FALSE(axis.right_switch.fitted);
  EXPECT_TRUE(axis.home_switch.normally_closed);
}

TEST(RackFile, AnUnknownKeyIsNamedWithItsPlaceAndTheLikelyWord) {
  const std::string message = refusal_of(R"([[segment]]
[[segment.device]]
type = "tmcm-3315"
[[segment.device.axis]]
moter = "QSH5718-55-30-098"
)");
  EXPECT_THAT(message, HasSubstr("test.toml:5:"));
  EXPECT_THAT(message, HasSubstr("unknown key \"moter\" (did you mean \"motor\"?)"));
  EXPECT_THAT(message, HasSubstr("supply_voltage"));
}

TEST(RackFile, UnknownKeysAreErrorsInEveryTable) {
  EXPECT_THAT(refusal_of(std::string("colour = 1\n") + kMinimal), HasSubstr("\"colour\""));
  EXPECT_THAT(refusal_of(std::string("[record]\nfile = \"a\"\nfiles = 2\n") + kMinimal),
              HasSubstr("\"files\""));
  EXPECT_THAT(refusal_of("[[segment]]\nlinks = \"x\"\n[[segment.device]]\ntype = \"tmcm-3315\"\n"),
              HasSubstr("\"links\" (did you mean \"link\"?)"));
  EXPECT_THAT(refusal_of(std::string(kMinimal) + "serial = 3\n"), HasSubstr("\"serial\""));
  EXPECT_THAT(refusal_of(std::string(kMinimal) + "[[segment.device.axis]]\nload.mass = 3\n"),
              HasSubstr("\"mass\""));
}

TEST(RackFile, AnUnknownMotorListsThoseThereAre) {
  const std::string message = refusal_of(
      std::string(kMinimal) + "[[segment.device.axis]]\nmotor = \"QSH5718-55-30-099\"\n");
  EXPECT_THAT(message, HasSubstr("did you mean \"QSH5718-55-30-098\"?"));
  EXPECT_THAT(message, HasSubstr("QSH6018-86-28-310"));
}

TEST(RackFile, ValuesOfTheWrongKindOrRangeSayWhatIsExpected) {
  EXPECT_THAT(refusal_of(std::string("cycle = 1\n") + kMinimal), HasSubstr("text in quotes"));
  EXPECT_THAT(refusal_of(std::string("cycle = \"1 hour\"\n") + kMinimal),
              HasSubstr("number with its unit"));
  EXPECT_THAT(refusal_of(std::string("clock = \"fast\"\n") + kMinimal),
              HasSubstr("must be one of: lockstep, real"));
  EXPECT_THAT(
      refusal_of(std::string(kMinimal) + "[[segment.device.axis]]\nsupply_voltage = 4800\n"),
      HasSubstr("must lie in 0 .. 100"));
  EXPECT_THAT(refusal_of(std::string(kMinimal) + "alias = 65536\n"), HasSubstr("0 .. 65535"));
}

TEST(RackFile, FourAxesAreMoreThanTheModuleHas) {
  const std::string axis = "[[segment.device.axis]]\nsupply_voltage = 24\n";
  EXPECT_EQ(refusal_of(kMinimal + axis + axis + axis), "accepted");
  EXPECT_THAT(refusal_of(kMinimal + axis + axis + axis + axis),
              HasSubstr("4 axes are given, the device has 3"));
}

TEST(RackFile, EveryKindOfLinkIsTaken) {
  const auto link_of = [](const std::string& text) {
    return parse_rack_file(
               "[[segment]]\nlink = \"" + text + "\"\n[[segment.device]]\ntype = \"tmcm-3315\"\n",
               "test.toml", devices::products())
        .segments[0]
        .link;
  };
  EXPECT_EQ(link_of("udp:0.0.0.0"), (link::LinkAddress{link::LinkKind::udp, "0.0.0.0", 34980}));
  EXPECT_EQ(link_of("tap:drive0"), (link::LinkAddress{link::LinkKind::tap, "drive0", 0}));
  EXPECT_TRUE(link_of("in-process").in_process());
  EXPECT_THAT(refusal_of("[[segment]]\nlink = \"can:vcan0\"\n"),
              AllOf(HasSubstr("test.toml:2"), HasSubstr("udp:ADDRESS[:PORT]")));
}

TEST(RackFile, EoeIsOffUnlessATapInterfaceIsNamed) {
  const RackConfiguration off = parse_rack_file(kMinimal, "test.toml", devices::products());
  EXPECT_EQ(off.segments[0].devices[0].eoe_interface, "");
  EXPECT_FALSE(module_of(off).coe.ethernet_over_ethercat);

  const RackConfiguration on = parse_rack_file(std::string(kMinimal) + "eoe = \"tap:gantry0\"\n",
                                               "test.toml", devices::products());
  EXPECT_EQ(on.segments[0].devices[0].eoe_interface, "gantry0");
  EXPECT_TRUE(module_of(on).coe.ethernet_over_ethercat);

  for (const char* wrong : {"gantry0", "udp:127.0.0.1", "tap:"}) {
    EXPECT_THAT(refusal_of(std::string(kMinimal) + "eoe = \"" + wrong + "\"\n"),
                HasSubstr("write \"tap:NAME\""))
        << wrong;
  }
}

TEST(RackFile, EoeBelongsToProductsWhoseFirmwareHasAMailbox) {
  const auto with_eoe = [](const std::string& type) {
    return "[[segment]]\n[[segment.device]]\ntype = \"" + type + "\"\neoe = \"tap:eoe0\"\n";
  };
  const RackConfiguration servo =
      parse_rack_file(with_eoe("tmc8670"), "test.toml", devices::products());
  EXPECT_EQ(servo.segments[0].devices[0].eoe_interface, "eoe0");
  EXPECT_TRUE(servo.segments[0]
                  .devices[0]
                  .setup.as<devices::Tmc8670Configuration>()
                  .coe.ethernet_over_ethercat);
  EXPECT_THAT(refusal_of(with_eoe("tmc8461")),
              AllOf(HasSubstr("no firmware of its own"), HasSubstr("tmcm-3315 or tmc8670")));
}

TEST(RackFile, TwoDevicesNeedTwoNames) {
  const std::string device = "[[segment.device]]\ntype = \"tmcm-3315\"\n";
  EXPECT_THAT(refusal_of("[[segment]]\n" + device + device), HasSubstr("is given twice"));
  EXPECT_EQ(refusal_of("[[segment]]\n" + device + device + "name = \"second\"\n"), "accepted");
}

TEST(RackFile, MissingPartsAreNamed) {
  EXPECT_THAT(refusal_of(""), HasSubstr("at least one [[segment]]"));
  EXPECT_THAT(refusal_of("[[segment]]\n"), HasSubstr("at least one [[segment.device]]"));
  EXPECT_THAT(refusal_of("[[segment]]\n[[segment.device]]\nname = \"x\"\n"),
              HasSubstr("\"type\" is missing"));
  EXPECT_THAT(refusal_of(std::string("[record]\nperiod = \"1ms\"\n") + kMinimal),
              HasSubstr("\"file\" is missing"));
}

TEST(RackFile, SyntaxErrorsNameLineAndColumn) {
  EXPECT_THAT(refusal_of("clock = \"real\"\nsegment = [\n"), HasSubstr("test.toml:"));
  EXPECT_THAT(refusal_of("clock = real\n"), HasSubstr("test.toml:1:"));
}

TEST(RackFile, AFileThatDoesNotExistIsNamed) {
  try {
    (void)load_rack_file("/nonexistent/rack.toml", devices::products());
    FAIL() << "a missing file was read";
  } catch (const RackFileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/nonexistent/rack.toml"));
    EXPECT_THAT(error.what(), HasSubstr("No such file or directory"));
  }
}

TEST(RackFile, EveryRackInTheRepositoryIsAccepted) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(STATOR_SOURCE_DIR "/racks")) {
    if (entry.is_directory()) {
      continue;  // recipes have a test of their own
    }
    EXPECT_NO_THROW((void)load_rack_file(entry.path().string(), devices::products()))
        << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace stator::rack
