// The rack of `stator demo --http`: that everything in it moves, and that it leaves alone what
// somebody else has taken.
#include "stator/cli/run/show.hpp"

#include <cmath>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
#include "base/wait_for.hpp"
#include "rack/text_log.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/link/ethernet/udp_ethernet_link.hpp"
#include "stator/manual/manual_control.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace stator::cli {
namespace {

using tests::wait_for;

std::string free_udp_port() {
  const auto probe = link::UdpEthernetLink::listen({.address = "127.0.0.1", .port = 0});
  return std::to_string(probe ? (*probe)->local_port() : std::uint16_t{0});
}

/// The show on links of its own.
class ShowTest : public ::testing::Test {
 protected:
  ShowTest() { runner_.start(); }
  ~ShowTest() override {
    control_.stop();
    runner_.stop();
  }

  [[nodiscard]] double value(const std::string& name) {
    const std::scoped_lock lock(runner_.running().mutex);
    for (const product::Signal& signal : rack_.signals()) {
      if (signal.name == name) {
        return signal.read();
      }
    }
    ADD_FAILURE() << "no signal " << name;
    return 0.0;
  }
  [[nodiscard]] rack::DeviceAddress address(const std::string& name) const {
    for (const rack::DeviceAddress each : rack_.addresses()) {
      if (rack_.name_of(each) == name) {
        return each;
      }
    }
    ADD_FAILURE() << "no device " << name;
    return {};
  }

  tests::TemporaryDirectory directory_;
  std::filesystem::path file_ = write_show_rack(directory_.path());
  std::vector<std::string> changes_{"segment[0].link=udp:127.0.0.1:" + free_udp_port(),
                                    "bus[0].ports[0]=slcan:" + directory_.path() + "/can",
                                    "feeder.rs485=pty:" + directory_.path() + "/line"};
  rack::RackConfiguration configuration_ =
      rack::load_rack_file(file_.string(), devices::products(), changes_);
  rack::EventLog log_;
  rack::Rack rack_{configuration_, log_};
  rack::Runner runner_{rack_, configuration_, tests::no_log()};
  manual::ManualControl control_{runner_, configuration_, log_};
};

TEST_F(ShowTest, EverythingMoves) {
  const Show show(control_, runner_, configuration_, file_);
  const auto turns = [&](const std::string& speed, double least) {
    return wait_for([&] { return std::abs(value(speed)) > least; });
  };
  EXPECT_TRUE(turns("gantry.axis0.shaft_speed", 0.5));
  EXPECT_TRUE(turns("gantry.axis1.shaft_speed", 0.5));
  EXPECT_TRUE(turns("gantry.axis2.shaft_speed", 0.2));
  EXPECT_TRUE(turns("servo.axis0.shaft_speed", 4.0));
  EXPECT_TRUE(turns("servo.axis0.load_torque", 0.01));
  EXPECT_TRUE(turns("spindle.axis0.shaft_speed", 2.0));
  EXPECT_TRUE(turns("io.fan.speed", 1'000.0));
  EXPECT_TRUE(turns("io.lamp.brightness", 0.5));
  EXPECT_TRUE(turns("feeder.axis0.shaft_speed", 0.01));
}

TEST_F(ShowTest, LeavesAloneWhatAPersonHasTaken) {
  const rack::DeviceAddress spindle = address("spindle");
  const Show show(control_, runner_, configuration_, file_);
  ASSERT_TRUE(wait_for([&] { return std::abs(value("spindle.axis0.shaft_speed")) > 2.0; }));
  ASSERT_TRUE(control_.command(spindle, 0, {.kind = manual::CommandKind::disable}));
  ASSERT_TRUE(wait_for([&] { return !control_.status(spindle).axes.at(0).status.enabled; }));
  ASSERT_TRUE(wait_for([&] { return std::abs(value("spindle.axis0.shaft_speed")) < 0.01; }));
  EXPECT_FALSE(control_.status(spindle).axes.at(0).status.enabled);
  // The others go on.
  EXPECT_TRUE(wait_for([&] { return std::abs(value("servo.axis0.shaft_speed")) > 4.0; }));
}

}  // namespace
}  // namespace stator::cli
