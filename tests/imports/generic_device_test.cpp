// Devices of files in a rack: they reach Operational, drives move, terminals have inputs and
// outputs.
#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
#include "source_paths.hpp"
#include "stator/bench/bench.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/imports/resolvers.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/product/device/ethercat_device.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/file/rack_file_error.hpp"
#include "stator/rack/world/rack_event.hpp"

namespace stator::imports {
namespace {

using namespace base::literals;
using ::testing::HasSubstr;

std::string file(const std::string& name) {
  return std::string(STATOR_SOURCE_DIR) + "/examples/device_files/" + name;
}

const product::Catalogue& catalogue() {
  static const product::Catalogue made = [] {
    product::Catalogue all = devices::products();
    add_resolvers(all);
    return all;
  }();
  return made;
}

/// A rack with one segment or bus of these types.
rack::RackConfiguration rack_of(const std::string& network, const std::vector<std::string>& types) {
  std::string text = "[[" + network + "]]\n" + (network == "bus" ? "name = \"can0\"\n" : "");
  int number = 0;
  for (const std::string& type : types) {
    text += "[[" + network + ".device]]\ntype = \"" + type + "\"\nname = \"device" +
            std::to_string(number++) + "\"\n";
  }
  return rack::parse_rack_file(text, "test.toml", catalogue());
}

/// Moves so many revolutions and says where the shaft is afterwards.
double moved_by(bench::Bench& bench, const std::string& device, std::int32_t target) {
  const auto port = bench.drive(*bench.find(device));
  EXPECT_TRUE(port) << port.error().text;
  if (!port) {
    return 0.0;
  }
  master::Cia402Client drive(**port);
  const auto mode = drive.set_mode(master::OperationMode::profile_position);
  EXPECT_TRUE(mode) << mode.error().text;
  const auto enabled = drive.enable();
  EXPECT_TRUE(enabled) << enabled.error().text;
  const auto started = drive.start_move({.target = target});
  EXPECT_TRUE(started) << started.error().text;
  const auto reached = drive.wait_for_target(10_s);
  EXPECT_TRUE(reached) << reached.error().text;
  bench.pass(200_ms);  // the last part of the way within the position window
  const auto actual = drive.position_actual();
  EXPECT_NEAR(actual.value(), target, 20);
  return bench.signal(device + ".axis0.shaft_position").read();
}

TEST(GenericSlave, OfADriveMovesTenRevolutionsInItsOwnUnits) {
  bench::Bench bench(rack_of("segment", {"esi:" + file("servo_drive.xml")}));
  const auto operational = bench.go_operational();
  ASSERT_TRUE(operational) << operational.error().text;
  EXPECT_NEAR(moved_by(bench, "device0", 100'000), 10.0, 0.01);
}

TEST(GenericSlave, ModesThat6502hDoesNotHaveAreRefused) {
  bench::Bench bench(rack_of("segment", {"esi:" + file("servo_drive.xml")}));
  ASSERT_TRUE(bench.take_to(ethercat::AlState::pre_operational, 0));
  const rack::DeviceAddress device = *bench.find("device0");
  const auto write = [&](std::uint8_t mode) {
    const std::array bytes{std::byte{mode}};
    return bench.download(device, {0x6060, 0}, bytes).has_value();
  };
  EXPECT_TRUE(write(1));
  EXPECT_TRUE(write(3));
  EXPECT_FALSE(write(4)) << "profile torque";
  EXPECT_FALSE(write(10)) << "cyclic synchronous torque";
  EXPECT_TRUE(write(8));
}

/// The file with a text in it replaced, in a folder of the test.
std::string changed(const tests::TemporaryDirectory& directory, const std::string& name,
                    const std::string& from, const std::string& to) {
  std::ifstream original(file(name), std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(original), {}};
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  const std::string path = directory.path() + "/" + name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

TEST(GenericSlave, AModeThatNobodyCanWriteIsTheOneItIsIn) {
  const tests::TemporaryDirectory directory;
  const std::string path =
      changed(directory, "servo_drive.xml",
              "<Info><DefaultData>08</DefaultData></Info><Flags><Access>rw</Access><PdoMapping>R",
              "<Flags><Access>ro</Access><PdoMapping>R");
  const auto imported = import_product("esi:" + path);
  ASSERT_TRUE(imported) << imported.error().text;
  EXPECT_TRUE(std::ranges::any_of(imported->report.notes,
                                  [](const auto& note) { return note.rule == "drive-mode"; }));
  bench::Bench bench(rack_of("segment", {"esi:" + path}));
  ASSERT_TRUE(bench.take_to(ethercat::AlState::pre_operational, 0));
  const rack::DeviceAddress device = *bench.find("device0");
  using Bytes = std::vector<std::byte>;
  EXPECT_EQ(bench.upload(device, {0x6060, 0}).value(), Bytes{std::byte{8}});
  EXPECT_EQ(bench.upload(device, {0x6061, 0}).value(), Bytes{std::byte{8}});
  EXPECT_FALSE(bench.download(device, {0x6060, 0}, Bytes{std::byte{6}}));
}

TEST(GenericSlave, AnEepromTooSmallForItsFileGrows) {
  const tests::TemporaryDirectory directory;
  const std::string name(2'500, 'n');
  const std::string path = changed(directory, "servo_drive.xml", "<Name>Not the default</Name>",
                                   "<Name>" + name.substr(0, 250) + "</Name>");
  std::string text;
  {
    std::ifstream original(path, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(original), {});
  }
  // Ten further PDOs with names of 250 letters do not fit into 2,048 bytes.
  std::string pdos;
  for (int i = 0; i < 10; ++i) {
    pdos += fmt::format(
        "<RxPdo><Index>#x{:04X}</Index><Name>{}{}</Name><Entry><Index>#x2001</Index>"
        "<SubIndex>0</SubIndex><BitLen>16</BitLen><Name>Some parameter</Name>"
        "<DataType>INT</DataType></Entry></RxPdo>",
        0x1610 + i, i, name.substr(0, 249));
  }
  text.insert(text.find("<RxPdo>"), pdos);
  std::ofstream(path, std::ios::binary) << text;
  const auto imported = import_product("esi:" + path);
  ASSERT_TRUE(imported) << imported.error().text;
  const auto made = imported->product->defaults().make();
  const auto image = dynamic_cast<product::EtherCatDevice&>(*made).sii_image();
  EXPECT_EQ(image.size(), 4'096U);
  EXPECT_EQ(ethercat::parse_sii_image(image)->size_kbit, 32);
}

TEST(GenericSlave, StoresOtherObjectsWithTheirRange) {
  bench::Bench bench(rack_of("segment", {"esi:" + file("servo_drive.xml")}));
  ASSERT_TRUE(bench.take_to(ethercat::AlState::pre_operational, 0));
  const rack::DeviceAddress device = *bench.find("device0");
  using Bytes = std::vector<std::byte>;
  EXPECT_EQ(bench.upload(device, {0x2001, 0}).value(), (Bytes{std::byte{3}, std::byte{0}}));
  EXPECT_FALSE(bench.download(device, {0x2001, 0}, Bytes{std::byte{11}, std::byte{0}}));
  EXPECT_TRUE(bench.download(device, {0x2001, 0}, Bytes{std::byte{7}, std::byte{0}}));
  EXPECT_EQ(bench.upload(device, {0x2001, 0}).value(), (Bytes{std::byte{7}, std::byte{0}}));
}

TEST(GenericTerminal, InputsAndOutputsPassBitByBit) {
  const std::string terminals = "esi:" + file("terminals.xml");
  bench::Bench bench(rack_of("segment", {terminals + "#COUPLER", terminals + "#DI-4",
                                         terminals + "#DO-2", terminals + "#BITS"}));
  const auto operational = bench.go_operational();
  ASSERT_TRUE(operational) << operational.error().text;
  const auto scanned = bench.scanned(0);
  ASSERT_TRUE(scanned);
  master::Master& master = **scanned;
  ASSERT_EQ(master.inputs(1).size(), 1U);
  ASSERT_EQ(master.outputs(2).size(), 1U);
  ASSERT_EQ(master.inputs(3).size(), 3U);

  bench.rack().apply(
      rack::InputEvent{.device = *bench.find("device1"), .input = "input_6020_01", .value = 1.0},
      bench.now());
  bench.cycle();
  bench.cycle();
  EXPECT_EQ(master.inputs(1)[0], std::byte{0b0100});

  master.outputs(2)[0] = std::byte{0b10};
  bench.cycle();
  bench.cycle();
  EXPECT_EQ(bench.signal("device2.output_7000_01").read(), 0.0);
  EXPECT_EQ(bench.signal("device2.output_7010_01").read(), 1.0);
  ASSERT_TRUE(bench.take_to(ethercat::AlState::safe_operational, 0));
  EXPECT_EQ(bench.signal("device2.output_7010_01").read(), 0.0) << "outside of Operational";
}

TEST(GenericTerminal, BitsAtTheIndicesOfADriveAreNoDrive) {
  const rack::RackConfiguration rack =
      rack_of("segment", {"esi:" + file("terminals.xml") + "#BITS"});
  product::Setup setup = rack.segments[0].devices[0].setup;
  EXPECT_TRUE(setup.axes().empty());
}

TEST(GenericNode, OfADriveMovesByItsFeedConstant) {
  bench::Bench bench(rack_of("bus", {"eds:" + file("can_drive.eds")}));
  const auto operational = bench.go_operational();
  ASSERT_TRUE(operational) << operational.error().text;
  EXPECT_NEAR(moved_by(bench, "device0", 36'000), 10.0, 0.01);
}

TEST(Resolvers, SayWhatIsWrongAndWhere) {
  const auto message_of = [](const std::string& type) -> std::string {
    try {
      static_cast<void>(rack_of("segment", {type}));
    } catch (const rack::RackFileError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(message_of("esi:" + file("nosuch.xml")), HasSubstr("cannot read"));
  EXPECT_THAT(message_of("esi:" + file("terminals.xml")), HasSubstr("DI-4"));
  EXPECT_THAT(message_of("esi:" + file("terminals.xml") + "#NONE"), HasSubstr("DI-4"));
  EXPECT_THAT(message_of("esi:" + file("can_drive.eds")), HasSubstr("[not-xml]"));
  EXPECT_THAT(message_of("eds:" + file("can_drive.eds")), HasSubstr("a CAN bus"));
}

}  // namespace
}  // namespace stator::imports
