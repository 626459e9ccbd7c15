// Serial lines and the devices on them in rack files.

#include "stator/rack/file/serial_section.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "source_paths.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using testing::ElementsAre;
using testing::HasSubstr;

std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(parse_rack_file(text, "test.toml", devices::products()));
  } catch (const RackFileError& error) {
    return error.what();
  }
  return "accepted";
}

std::string module_with_usb(const std::string& usb) {
  return "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\nusb = \"" + usb + "\"\n";
}

std::string device() {
  return "[[device]]\ntype = \"tmcc160\"\nserial = \"pty:/tmp/a\"\n";
}

TEST(SerialSection, MistakesOfALineAreExplained) {
  EXPECT_THAT(refusal_of(module_with_usb("/dev/ttyUSB0")),
              HasSubstr("write pty:PATH or tcp:[ADDRESS:]PORT"));
  EXPECT_THAT(refusal_of(module_with_usb("pty:")), HasSubstr("write pty:PATH"));
  EXPECT_THAT(refusal_of(module_with_usb("tcp:host:1")), HasSubstr("IPv4 address"));
  EXPECT_THAT(refusal_of(module_with_usb("tcp:70000")), HasSubstr("port from 1 to 65535"));
  EXPECT_EQ(refusal_of(module_with_usb("tcp:4001")), "accepted");
}

TEST(SerialSection, DevicesOnSerialLinesOnlyAreOnNoBus) {
  const RackConfiguration configuration =
      parse_rack_file(device() + "[[bus]]\n[[bus.device]]\ntype = \"tmcc160\"\nname = \"b\"\n", "t",
                      devices::products());
  ASSERT_EQ(configuration.buses.size(), 2U);
  EXPECT_TRUE(configuration.buses[0].wire);
  EXPECT_FALSE(configuration.buses[1].wire);
  EXPECT_THAT(configuration.buses[1].devices[0].serial,
              ElementsAre(SerialConnection{"serial", "pty:/tmp/a"}));
  EventLog log;
  Rack rack(configuration, log);
  EXPECT_EQ(rack.line_count(), 1U);
  EXPECT_FALSE(rack.bus(1).bus().connected(rack.bus(1).member_of(0)));
}

TEST(SerialSection, ADeviceWithoutAnyLineIsRefused) {
  EXPECT_THAT(refusal_of("[[device]]\ntype = \"tmcc160\"\n"),
              HasSubstr("\"tmcc160\" cannot be reached: a [[device]] needs a serial line"));
  EXPECT_THAT(refusal_of("[[device]]\ntype = \"tmcm-3315\"\n"), HasSubstr("tmcm-3315"));
}

TEST(SerialSection, ItsNameIsUniqueAndItHasNoCable) {
  EXPECT_THAT(refusal_of(device() + device()), HasSubstr("given twice"));
  const std::string event = "[[event]]\nat = \"1s\"\ndevice = \"tmcc160\"\naction = ";
  EXPECT_THAT(refusal_of(device() + event + "\"break\"\n"), HasSubstr("serial lines only"));
  EXPECT_THAT(refusal_of(device() + event + "\"bus-off\"\n"), HasSubstr("on no CAN bus"));
  EXPECT_EQ(refusal_of(device() + event + "\"power-off\"\n"), "accepted");
}

TEST(SerialSection, OnlyRs485AndRs422ShareALine) {
  const auto module = [](const std::string& name, const std::string& interface) {
    return "[[device]]\ntype = \"tmcm-142\"\nname = \"" + name + "\"\n" + interface +
           " = \"tcp:4001\"\n";
  };
  EXPECT_EQ(refusal_of(module("a", "rs485") + module("b", "rs485")), "accepted");
  EXPECT_THAT(refusal_of(module("a", "rs485") + module("b", "usb")),
              HasSubstr("the line \"tcp:4001\" of b.usb is named 2 times; only rs485 and rs422"));
  EXPECT_THAT(refusal_of(module("a", "rs232") + module("b", "rs232")), HasSubstr("a.rs232"));
}

TEST(SerialSection, RacksWithSerialLinesCanBeBuilt) {
  for (const char* name : {"tmcl-module", "rs485-line"}) {
    const RackConfiguration configuration = load_rack_file(
        STATOR_SOURCE_DIR "/racks/" + std::string(name) + ".toml", devices::products());
    EventLog log;
    const Rack rack(configuration, log);
    EXPECT_EQ(rack.line_count(), 1U) << name;
  }
}

TEST(SerialSection, ALineHasSettingsOfItsOwn) {
  const RackConfiguration configuration = parse_rack_file(device() + R"(
[[line]]
link = "pty:/tmp/a"
pacing = true
wait = "adaptive"
spin_time = "50us"
cpu = 1
)",
                                                          "t", devices::products());
  ASSERT_EQ(configuration.lines.size(), 1U);
  const SerialLineConfiguration& line = configuration.lines[0];
  EXPECT_EQ(line.link, "pty:/tmp/a");
  EXPECT_TRUE(line.pacing);
  EXPECT_EQ(line.wait, link::WaitMode::adaptive);
  EXPECT_EQ(line.spin_time, 50_us);
  EXPECT_EQ(line.cpu, 1U);
}

TEST(SerialSection, ALineThatNobodyNamesOrThatIsThereTwiceIsRefused) {
  EXPECT_THAT(refusal_of(device() + "[[line]]\nlink = \"pty:/tmp/b\"\n"),
              HasSubstr("which no device names; the lines are: pty:/tmp/a"));
  EXPECT_THAT(refusal_of(device() + "[[line]]\npacing = true\n"), HasSubstr("\"link\" is missing"));
  const std::string line = "[[line]]\nlink = \"pty:/tmp/a\"\n";
  EXPECT_THAT(refusal_of(device() + line + line), HasSubstr("two [[line]] tables"));
}

}  // namespace
}  // namespace stator::rack
