// The recipes in racks/recipes: each is loaded and run until all of its faults are over, and the
// rack works after that.

#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "source_paths.hpp"
#include "stator/bench/local_can_port.hpp"
#include "stator/bench/local_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/faults/faults.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;

constexpr base::SimTime kLimit{120_s};

std::vector<std::string> recipes() {
  std::vector<std::string> paths;
  for (const auto& entry :
       std::filesystem::directory_iterator(STATOR_SOURCE_DIR "/racks/recipes")) {
    paths.push_back(entry.path().string());
  }
  std::ranges::sort(paths);
  return paths;
}

bool over(Rack& rack, base::SimTime now) {
  return std::ranges::all_of(
      rack.faults(now), [](const FaultStatus& fault) { return fault.state == FaultState::done; });
}

/// A patient master: whatever goes wrong, it begins anew. Its first axis moves, so that positions
/// are passed.
void run_segment(Rack& rack, const RackConfiguration& configuration) {
  bench::LocalPort port(rack, 0, configuration.cycle, configuration.step);
  const std::size_t slaves = configuration.segments.front().devices.size();
  const auto start = [&](master::Master& master) {
    return master.scan() && master.slaves().size() == slaves && master.configure_process_data() &&
           master.go_operational();
  };
  while (port.now() < kLimit && !over(rack, port.now())) {
    master::Master master(port);
    if (!start(master)) {
      continue;
    }
    master::Cia402Client axis(master, 0, 0);
    if (axis.set_mode(master::OperationMode::profile_position) && axis.enable()) {
      static_cast<void>(axis.start_move(
          {.target = 200'000, .velocity = 51'200, .acceleration = 51'200, .deceleration = 51'200}));
    }
    bool healthy = true;
    while (healthy && port.now() < kLimit && !over(rack, port.now())) {
      healthy = static_cast<bool>(master.run_cycle());
      const auto state = rack.network_state({0, 0, NetworkKind::segment});
      healthy = healthy && state == dictionary::NetworkState::operational;
    }
  }
  EXPECT_TRUE(over(rack, port.now()));
  master::Master master(port);
  EXPECT_TRUE(start(master)) << "everything works again";
}

void run_bus(Rack& rack, const RackConfiguration& configuration) {
  bench::LocalCanPort port(rack, 0, configuration.cycle, configuration.step);
  const auto answered = [&port] {
    while (port.receive()) {
    }
    port.send(can::data_frame(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}));
    const auto answer = port.receive();
    return answer && answer->frame.identifier == 0x585;
  };
  while (port.now() < kLimit && !over(rack, port.now())) {
    static_cast<void>(answered());
    port.wait(10_ms);
  }
  EXPECT_TRUE(over(rack, port.now()));
  port.wait(2_s);
  EXPECT_TRUE(answered()) << "the node takes part again";
}

class Host {
 public:
  explicit Host(Rack& rack) : rack_(rack) {
    rack_.connect_line(0, SerialLine::Output::bind<&Host::hear>(*this));
  }
  bool answered() {
    heard_.clear();
    const tmcl::Telegram telegram =
        tmcl::encode(tmcl::Request{.address = 3, .command = 136, .type = 1});
    rack_.put(0, telegram, now);
    now += 100_ms;
    rack_.advance(now);
    unsigned sum = 0;
    for (std::size_t i = 0; i + 1 < heard_.size(); ++i) {
      sum += std::to_integer<unsigned>(heard_[i]);
    }
    return heard_.size() == telegram.size() && std::byte(sum & 0xFFU) == heard_.back();
  }
  base::SimTime now{1_s};

 private:
  void hear(std::span<const std::byte> bytes) {
    heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  }
  Rack& rack_;
  std::vector<std::byte> heard_;
};

void run_line(Rack& rack) {
  Host host(rack);
  while (host.now < kLimit && !over(rack, host.now)) {
    static_cast<void>(host.answered());
  }
  EXPECT_TRUE(over(rack, host.now));
  static_cast<void>(host.answered());
  EXPECT_TRUE(host.answered()) << "without faults the module answers";
}

class Recipes : public ::testing::TestWithParam<std::string> {};

TEST_P(Recipes, RunToTheirEndAndLeaveARackThatWorks) {
  RackConfiguration configuration = load_rack_file(GetParam(), devices::products());
  ASSERT_FALSE(configuration.faults.empty());
  EventLog log;
  Rack rack(configuration, log);
  if (!configuration.segments.empty()) {
    run_segment(rack, configuration);
  } else if (rack.line_count() != 0) {
    run_line(rack);
  } else {
    run_bus(rack, configuration);
  }
  for (const FaultStatus& fault : rack.faults(kLimit)) {
    EXPECT_TRUE(fault.begun) << fault.kind << " never began";
  }
}

INSTANTIATE_TEST_SUITE_P(All, Recipes, ::testing::ValuesIn(recipes()), [](const auto& test) {
  std::string name = std::filesystem::path(test.param).stem().string();
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace stator::rack
