// stator run --serial

#include "stator/cli/run/serial_lines.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"
#include "source_paths.hpp"
#include "stator/cli/failure.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcm_142/product.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/rack/core/device_making.hpp"

namespace stator {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using tests::Outcome;
using tests::stator;

TEST(SerialLines, ModulesHaveAddressesAndIdentifiersInARowWithoutThatOfReplies) {
  for (unsigned offset = 0; offset < 4; ++offset) {
    product::Setup setup = devices::tmcm_142_product()->defaults();
    cli::count_address(setup, offset);
    const auto& module = setup.as<devices::Tmcm142Configuration>();
    EXPECT_EQ(module.tmcl.serial, 1 + offset);
    EXPECT_EQ(module.tmcl.can, offset == 0 ? 1U : 2 + offset);
    EXPECT_EQ(module.tmcl.can_reply, 2);
  }
  product::Setup setup = devices::tmcm_142_product()->defaults();
  EXPECT_THROW(cli::count_address(setup, 255), cli::Failure);
}

TEST(SerialLines, OneModuleIsOnItsFirstInterfaceAndSeveralShareRs485) {
  rack::RackConfiguration one = rack::single_device_rack("tmcm-142", devices::products());
  cli::connect_serial_lines({"pty:/tmp/a=b", "usb=tcp:4001"}, one);
  EXPECT_THAT(one.buses[0].devices[0].serial,
              ElementsAre(rack::SerialConnection{"rs232", "pty:/tmp/a=b"},
                          rack::SerialConnection{"usb", "tcp:4001"}));
  rack::RackConfiguration two = rack::single_device_rack("tmcm-142", devices::products());
  two.buses[0].devices.push_back(two.buses[0].devices[0]);
  cli::connect_serial_lines({"pty:/tmp/a"}, two);
  for (const rack::DeviceConfiguration& device : two.buses[0].devices) {
    EXPECT_THAT(device.serial, ElementsAre(rack::SerialConnection{"rs485", "pty:/tmp/a"}));
  }
}

TEST(SerialLines, MistakesAreExplained) {
  const auto refusal_of = [](const std::string& options) {
    return stator("run " + options).output;
  };
  EXPECT_THAT(refusal_of("--device tmcm-142 --serial serial=pty:/tmp/x"),
              HasSubstr("no interface \"serial\"; it has rs232, rs485, rs422, usb"));
  EXPECT_THAT(refusal_of("--device tmcm-142 --serial /dev/ttyS0"),
              HasSubstr("write pty:PATH or tcp:[ADDRESS:]PORT"));
  EXPECT_THAT(refusal_of("--device tmcm-142 --count 2 --serial usb=tcp:0"),
              HasSubstr("2 devices cannot share the line of a usb"));
  for (const std::string line : {"tcp:0", "usb=tcp:0"}) {
    EXPECT_THAT(refusal_of("--device tmc8461 --link udp:127.0.0.1 --serial " + line),
                HasSubstr("--serial " + line + ": a tmc8461 has no serial interface"));
  }
  EXPECT_THAT(refusal_of("--device tmcm-142"), HasSubstr("or a serial line with --serial"));
  EXPECT_THAT(refusal_of(STATOR_SOURCE_DIR "/racks/rs485-line.toml --serial tcp:0"),
              HasSubstr("a rack file names the serial lines"));
}

TEST(SerialLines, RunSaysHowProgramsOpenThem) {
  const Outcome outcome = stator("run --device tmcm-142 --count 2 --serial tcp:0 --duration 10ms");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("tmcm-142-2  (TMCM-142, rs485, address 2)"),
                                    HasSubstr("socket_serial_tmcl --port 127.0.0.1:"),
                                    HasSubstr("0 bytes from programs")));
}

}  // namespace
}  // namespace stator
