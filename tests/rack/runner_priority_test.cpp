// The real-time priority of a runner's threads.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include "base/temporary_directory.hpp"
#include "base/wait_for.hpp"
#include "rack/text_log.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/link/ethernet/machine.hpp"
#include "stator/link/ethernet/udp_ethernet_link.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/observe/inheriting_mutex.hpp"
#include "stator/rack/run/runner.hpp"

namespace stator::rack {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr int kPriority = 7;

struct Threads {
  unsigned in_real_time = 0;  ///< with kPriority
  unsigned others = 0;        ///< without any real-time policy
  unsigned strange = 0;
  friend bool operator==(const Threads&, const Threads&) = default;
};

/// Those of this process.
Threads threads() {
  Threads threads;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    const pid_t thread = std::stoi(entry.path().filename().string());
    const int policy = ::sched_getscheduler(thread);
    sched_param parameters{};
    ::sched_getparam(thread, &parameters);
    if (policy == SCHED_OTHER) {
      ++threads.others;
    } else if (policy == (SCHED_FIFO | SCHED_RESET_ON_FORK) &&
               parameters.sched_priority == kPriority) {
      ++threads.in_real_time;
    } else {
      ++threads.strange;
    }
  }
  return threads;
}

class RunnerPriority : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto permitted = link::may_run_in_real_time(kPriority); !permitted) {
      GTEST_SKIP() << permitted.error().text;
    }
  }
  [[nodiscard]] std::shared_ptr<Log> logger() { return tests::log_to(text_); }
  /// A segment, a bus, a serial line, a chip's socket and a state directory.
  [[nodiscard]] RackConfiguration everything() const {
    const auto probe = link::UdpEthernetLink::listen({.address = "127.0.0.1", .port = 0});
    EXPECT_TRUE(probe) << probe.error().text;
    RackConfiguration configuration = single_device_rack("tmc8461", devices::products());
    SegmentConfiguration& segment = configuration.segments.front();
    segment.link = {link::LinkKind::udp, "127.0.0.1",
                    probe ? (*probe)->local_port() : std::uint16_t{}};
    segment.devices.front().host_link = "tcp:0";
    configuration.buses = single_device_rack("tmcm-142", devices::products()).buses;
    BusConfiguration& bus = configuration.buses.front();
    bus.ports = {"slcan-tcp:0"};
    bus.devices.front().serial = {{"rs232", "tcp:0"}};
    configuration.state = directory_.path();
    return configuration;
  }

  tests::TemporaryDirectory directory_;
  std::ostringstream text_;
  EventLog log_;
};

TEST_F(RunnerPriority, ThreadsThatAnswerHaveItAndNoOthers) {
  const unsigned before = threads().others;
  const RackConfiguration configuration = everything();
  Rack rack(configuration, log_);
  Runner runner(rack, configuration, logger(), {}, kPriority);
  const unsigned others = threads().others;
  EXPECT_GT(others, before) << "the thread that writes kept files";
  runner.start();
  const Threads expected{.in_real_time = 4, .others = others};
  EXPECT_TRUE(tests::wait_for([&] { return threads() == expected; }))
      << threads().in_real_time << " in real time, " << threads().others << " others, "
      << threads().strange << " strange";
  runner.stop();
  EXPECT_EQ(text_.str(), "");
}

TEST_F(RunnerPriority, WithoutItNoThreadIsInRealTime) {
  const RackConfiguration configuration = everything();
  Rack rack(configuration, log_);
  Runner runner(rack, configuration, logger());
  const unsigned before = threads().others;
  runner.start();
  EXPECT_EQ(threads(), (Threads{.others = before + 4}));
}

TEST_F(RunnerPriority, AMutexLendsItsHolderThePriorityOfWhoWaits) {
  InheritingMutex mutex;
  std::unique_lock held(mutex);
  const auto priority_of_this_thread = [] {
    // Field 18 of stat(5); behind the name, which is in parentheses, it is the 16th.
    std::ifstream file("/proc/self/task/" + std::to_string(::gettid()) + "/stat");
    std::string text;
    std::getline(file, text);
    std::istringstream fields(text.substr(text.rfind(')') + 2));
    std::string field;
    for (int i = 0; i < 16; ++i) {
      fields >> field;
    }
    return std::stoi(field);
  };
  EXPECT_GE(priority_of_this_thread(), 0);
  std::thread waits([&] {
    EXPECT_TRUE(link::run_in_real_time(kPriority));
    const std::scoped_lock lock(mutex);
  });
  EXPECT_TRUE(tests::wait_for([&] { return priority_of_this_thread() == -kPriority - 1; }));
  held.unlock();
  waits.join();
  EXPECT_GE(priority_of_this_thread(), 0);
}

TEST_F(RunnerPriority, TheWarningOfAnOverrunNamesItUnlessItIsGiven) {
  const RackConfiguration configuration = single_device_rack("tmcm-3315", devices::products());
  Rack rack(configuration, log_);
  const RunningRack without(rack, configuration, logger(), {});
  without.log_overrun(3, base::SimDuration(28'400'000));
  EXPECT_THAT(text_.str(), HasSubstr("overrun 3: the rack was 28.4 ms behind"));
  EXPECT_THAT(text_.str(), HasSubstr("--priority"));
  text_.str("");
  const RunningRack with(rack, configuration, logger(), {}, kPriority);
  with.log_overrun(1, base::SimDuration(28'400'000));
  EXPECT_THAT(text_.str(), HasSubstr("run fewer devices"));
  EXPECT_THAT(text_.str(), Not(HasSubstr("--priority")));
}

}  // namespace
}  // namespace stator::rack
