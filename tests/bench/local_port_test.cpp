#include "stator/bench/local_port.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/master/master.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::bench {
namespace {

using namespace base::literals;

/// A rack with `modules` TMCM-3315 and a master on it.
class ModuleBench {
 public:
  explicit ModuleBench(unsigned modules = 1, const std::string& record = "")
      : configuration_(configuration(modules, record)),
        rack_(configuration_, log_),
        port_(rack_, 0, configuration_.cycle, configuration_.step),
        master_(port_) {}

  [[nodiscard]] master::Master& master() { return master_; }
  [[nodiscard]] rack::Rack& rack() { return rack_; }
  [[nodiscard]] LocalPort& port() { return port_; }

  void bring_to_operational() {
    const auto scanned = master_.scan();
    ASSERT_TRUE(scanned) << scanned.error().text;
    const auto configured = master_.configure_process_data();
    ASSERT_TRUE(configured) << configured.error().text;
    const auto operational = master_.go_operational();
    ASSERT_TRUE(operational) << operational.error().text;
  }

  void move(std::size_t position, unsigned axis, std::int32_t target) {
    master::Cia402Client client(master_, position, axis);
    ASSERT_TRUE(client.set_mode(master::OperationMode::profile_position));
    ASSERT_TRUE(client.enable());
    ASSERT_TRUE(client.start_move(
        {.target = target, .velocity = 256'000, .acceleration = 512'000, .deceleration = 512'000}));
    const auto reached = client.wait_for_target(20_s);
    ASSERT_TRUE(reached) << reached.error().text;
  }

  [[nodiscard]] double signal(const std::string& name) {
    for (const product::Signal& candidate : rack_.signals()) {
      if (candidate.name == name) {
        return candidate.read();
      }
    }
    ADD_FAILURE() << "no signal " << name;
    return std::nan("");
  }

 private:
  static rack::RackConfiguration configuration(unsigned modules, const std::string& record) {
    rack::RackConfiguration rack = rack::single_device_rack("tmcm-3315", devices::products());
    auto& devices = rack.segments.front().devices;
    devices.front().name = "m0";
    for (unsigned i = 1; i < modules; ++i) {
      devices.push_back(devices.front());
      devices.back().name = "m" + std::to_string(i);
    }
    if (!record.empty()) {
      rack.record = rack::RecordConfiguration{record, 1_ms, {"*"}};
    }
    return rack;
  }

  rack::EventLog log_;
  rack::RackConfiguration configuration_;
  rack::Rack rack_;
  LocalPort port_;
  master::Master master_;
};

TEST(LocalPort, AMasterFindsEveryModuleOfTheRack) {
  ModuleBench bench(3);
  ASSERT_TRUE(bench.master().scan());
  ASSERT_EQ(bench.master().slaves().size(), 3U);
  EXPECT_EQ(bench.master().slaves()[2].information.name, "TMCM-3315");
}

TEST(LocalPort, TimePassesOnlyWithFramesAndWaits) {
  ModuleBench bench;
  ASSERT_TRUE(bench.master().scan());
  const base::SimTime before = bench.port().now();
  EXPECT_EQ(bench.port().now(), before);
  bench.port().wait(3_ms);
  EXPECT_EQ(bench.port().now() - before, 3_ms);
}

TEST(LocalPort, TenRevolutionsEndWithinOneMicrostepAtTheShaft) {
  ModuleBench bench;
  bench.bring_to_operational();
  bench.move(0, 0, 512'000);
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(bench.master().run_cycle());
  }
  EXPECT_DOUBLE_EQ(bench.signal("m0.axis0.position_actual"), 512'000.0);
  // The rotor's own resting place differs by friction and detent torque, far less than a full step.
  EXPECT_NEAR(bench.signal("m0.axis0.shaft_position"), 10.0, 0.25 / 200.0);
}

TEST(LocalPort, EveryAxisOfEveryModuleMovesOnItsOwn) {
  ModuleBench bench(2);
  bench.bring_to_operational();
  bench.move(1, 2, -51'200);
  EXPECT_DOUBLE_EQ(bench.signal("m1.axis2.position_actual"), -51'200.0);
  for (const char* other : {"m0.axis0", "m0.axis1", "m0.axis2", "m1.axis0", "m1.axis1"}) {
    EXPECT_DOUBLE_EQ(bench.signal(std::string(other) + ".position_actual"), 0.0) << other;
  }
}

std::string recording_of_one_run(const std::string& path) {
  {
    ModuleBench bench(1, path);
    bench.bring_to_operational();
    bench.move(0, 0, 100'000);
  }
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  std::filesystem::remove(path);
  return text.str();
}

TEST(LocalPort, TheSameRunTwiceGivesTheSameRecording) {
  const std::filesystem::path directory(::testing::TempDir());
  const std::string first = recording_of_one_run((directory / "lockstep-1.csv").string());
  const std::string second = recording_of_one_run((directory / "lockstep-2.csv").string());
  EXPECT_GT(first.size(), 100'000U);
  EXPECT_TRUE(first == second) << "two equal runs differ";
}

}  // namespace
}  // namespace stator::bench
