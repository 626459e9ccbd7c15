// The keys of a TMCM-142 in a rack file.

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/file/rack_file_error.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using devices::Tmcm142Configuration;
using testing::HasSubstr;

std::string with(const std::string& keys) {
  return "[[device]]\ntype = \"tmcm-142\"\nrs485 = \"pty:/tmp/line\"\n" + keys;
}

Tmcm142Configuration module_with(const std::string& keys) {
  const RackConfiguration configuration =
      parse_rack_file(with(keys), "test.toml", devices::products());
  return configuration.buses.at(0).devices.at(0).setup.as<Tmcm142Configuration>();
}

std::string refusal_of(const std::string& keys) {
  try {
    static_cast<void>(parse_rack_file(with(keys), "test.toml", devices::products()));
  } catch (const RackFileError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Tmcm142Section, EveryKeyReachesTheConfiguration) {
  const Tmcm142Configuration module = module_with(R"(
address = 5
baud_rate = 115200
can_id = 0x123
can_reply_id = 0x7FF
bit_rate = 250
auto_start = true
instruction_time = "5us"
seed = 7
writable_encoder_position = true
eight_input_bits = true
opto_bias = false
dip_switches.address = 3
dip_switches.interface = "rs422"
[device.axis]
motor = "QSH6018-86-28-310"
supply_voltage = 48.0
)");
  EXPECT_EQ(module.tmcl.serial, 5);
  EXPECT_EQ(module.baud_rate, 7);
  EXPECT_EQ(module.tmcl.can, 0x123);
  EXPECT_EQ(module.tmcl.can_reply, 0x7FF);
  EXPECT_EQ(module.can_bit_rate, 6);
  EXPECT_TRUE(module.auto_start);
  EXPECT_EQ(module.instruction_time, 5_us);
  EXPECT_EQ(module.seed, 7U);
  EXPECT_TRUE(module.options.writable_encoder_position);
  EXPECT_TRUE(module.options.eight_input_bits);
  EXPECT_FALSE(module.options.opto_bias);
  EXPECT_EQ(module.dip_switches.address, 3);
  EXPECT_EQ(module.dip_switches.interface, "rs422");
  EXPECT_EQ(module.axis.supply_voltage, 48.0);
}

TEST(Tmcm142Section, WithoutKeysItIsAsDelivered) {
  const Tmcm142Configuration module = module_with("");
  const Tmcm142Configuration delivered;
  EXPECT_EQ(module.tmcl.serial, delivered.tmcl.serial);
  EXPECT_EQ(module.baud_rate, delivered.baud_rate);
  EXPECT_EQ(module.can_bit_rate, delivered.can_bit_rate);
  EXPECT_TRUE(module.program.empty());
}

TEST(Tmcm142Section, MistakesAreExplained) {
  EXPECT_THAT(refusal_of("baud_rate = 4800\n"),
              HasSubstr("\"baud_rate\" is 4800 bit/s; the module knows 9600, 14400"));
  EXPECT_THAT(refusal_of("bit_rate = 800\n"), HasSubstr("the module knows 10, 20, 50"));
  EXPECT_THAT(refusal_of("address = 256\n"), HasSubstr("address"));
  EXPECT_THAT(refusal_of("can_id = 0x800\n"), HasSubstr("can_id"));
  EXPECT_THAT(refusal_of("dip_switches.interface = \"serial\"\n"), HasSubstr("rs232"));
  EXPECT_THAT(refusal_of("node_id = 1\n"), HasSubstr("node_id"));
}

class Tmcm142Program : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const {
    return directory_.path() + "/" + name;
  }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
  }
  [[nodiscard]] std::string key(const std::string& name) const {
    return "program = \"" + path(name) + "\"\n";
  }

 private:
  tests::TemporaryDirectory directory_;
};

TEST_F(Tmcm142Program, ATextIsAssembledAndRuns) {
  write("a.tmc", "SGP 0, 2, 4711\nSTOP\n");
  const RackConfiguration configuration =
      parse_rack_file(with(key("a.tmc") + "auto_start = true\n"), "test.toml", devices::products());
  EventLog log;
  Rack rack(configuration, log);
  rack.advance(base::SimTime(10_ms));
  const auto& module = dynamic_cast<const devices::Tmcm142&>(rack.device({0, 0, NetworkKind::bus}));
  EXPECT_EQ(module.module().read_global_parameter(2, 0), 4711);
}

TEST_F(Tmcm142Program, ItsPathBeginsAtTheRackFile) {
  write("a.tmc", "STOP\n");
  write("rack.toml", with("program = \"a.tmc\"\n"));
  const RackConfiguration configuration = load_rack_file(path("rack.toml"), devices::products());
  const product::Setup& setup = configuration.buses.at(0).devices.at(0).setup;
  EXPECT_EQ(setup.as<Tmcm142Configuration>().program.size(), 1U);
}

TEST_F(Tmcm142Program, AnImageIsTakenAsItIs) {
  write("a.bin", std::string("\x09\x00\x02\x00\x00\x12\x67", 7));
  const Tmcm142Configuration module = module_with(key("a.bin"));
  ASSERT_EQ(module.program.size(), 1U);
  EXPECT_EQ(module.program[0].command, 9);
  EXPECT_EQ(module.program[0].value, 4711);
}

TEST_F(Tmcm142Program, MistakesAreToldWithTheirPlace) {
  EXPECT_THAT(refusal_of(key("none.tmc")), HasSubstr("cannot read the program"));
  write("wrong.tmc", "STOP\n  MPV ABS, 0, 1\n");
  EXPECT_THAT(refusal_of(key("wrong.tmc")), HasSubstr("wrong.tmc:2:3: "));
  write("cut.bin", "12345678");
  EXPECT_THAT(refusal_of(key("cut.bin")), HasSubstr("8 bytes, which is no multiple of 7"));
  write("long.bin", std::string(std::size_t{7} * 2049, '\0'));
  EXPECT_THAT(refusal_of(key("long.bin")), HasSubstr("the program memory holds 2048"));
}

}  // namespace
}  // namespace stator::rack
