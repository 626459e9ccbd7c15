// Round trips per second of a complete rack in Operational (link, slave controllers, slave
// software, drives, motors) against a bare echo of the same frame over the same kind of veth pair,
// in turns in the same run. The counter `ratio` is what the rack keeps of the bare echo's rate;
// stated limit for one slave: 0.85 in both placements. Needs the right to create network
// namespaces.

#include <array>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include "master/master.hpp"
#include "rack/local_port.hpp"
#include "rack/product_catalogue.hpp"
#include "rack/runner.hpp"
#include "veth_echo.hpp"

namespace stator::bench {
namespace {

constexpr std::size_t kRounds = 9;
constexpr std::size_t kRoundTrips = 5'000;

rack::RackConfiguration line_of(std::size_t modules) {
  rack::RackConfiguration configuration = rack::single_device_rack("tmcm-3315");
  auto& devices = configuration.segments.front().devices;
  for (std::size_t i = 1; i < modules; ++i) {
    devices.push_back(devices.front());
    devices.back().name = "module-" + std::to_string(i);
  }
  return configuration;
}

/// Keeps the first frame of the latest bus cycle that a master sends through it.
class CycleRecorder final : public master::FramePort {
 public:
  explicit CycleRecorder(master::FramePort& port) : port_(port) {}

  master::Result<std::size_t> exchange(std::span<const std::byte> frame, std::span<std::byte> reply,
                                       base::SimDuration timeout) override {
    if (frame_.empty() && !frame.empty()) {
      frame_.assign(frame.begin(), frame.end());
    }
    return port_.exchange(frame, reply, timeout);
  }
  void wait(base::SimDuration duration) override { port_.wait(duration); }
  [[nodiscard]] base::SimTime now() override { return port_.now(); }

  void forget() { frame_.clear(); }
  [[nodiscard]] const std::vector<std::byte>& frame() const { return frame_; }

 private:
  master::FramePort& port_;
  std::vector<std::byte> frame_;
};

void require(const master::Result<void>& result) {
  if (!result) {
    throw std::runtime_error(result.error().text);
  }
}

/// Brings every module to Operational and returns the cyclic frame of the first of them.
std::vector<std::byte> bring_to_operational(rack::Rack& rack,
                                            const rack::RackConfiguration& configuration) {
  rack::LocalPort port(rack, 0, configuration.cycle, configuration.step);
  CycleRecorder recorder(port);
  master::Master master(recorder);
  require(master.scan());
  require(master.configure_process_data());
  require(master.go_operational());
  recorder.forget();
  require(master.exchange_process_data());
  return recorder.frame();
}

/// The rack as the far end of the cable, run as `stator run` runs it.
Peer rack_peer(std::size_t modules) {
  return [modules](const PeerEnd& end) {
    rack::RackConfiguration configuration = line_of(modules);
    configuration.segments.front().link = {link::LinkKind::raw_ethernet, end.interface, 0};
    configuration.segments.front().wait = end.wait;
    rack::EventLog log;
    rack::Rack rack(configuration, log);
    bring_to_operational(rack, configuration);
    rack::Runner runner(rack, configuration, spdlog::null_logger_mt("bench"));
    spdlog::drop("bench");
    runner.start();
    while (!end.stop) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    runner.stop();
  };
}

std::vector<std::byte> cyclic_frame(std::size_t modules) {
  const rack::RackConfiguration configuration = line_of(modules);
  rack::EventLog log;
  rack::Rack rack(configuration, log);
  return bring_to_operational(rack, configuration);
}

void round_trips(benchmark::State& state, Placement placement) {
  const auto modules = static_cast<std::size_t>(state.range(0));
  for ([[maybe_unused]] auto iteration : state) {
    try {
      const std::vector<std::byte> frame = cyclic_frame(modules);
      const std::array<Peer, 2> peers{bare_echo, rack_peer(modules)};
      const auto rates = compare(peers, placement, frame, kRounds, kRoundTrips);
      state.counters["bare_per_s"] = rates[0];
      state.counters["rack_per_s"] = rates[1];
      state.counters["ratio"] = rates[1] / rates[0];
    } catch (const std::runtime_error& error) {
      state.SkipWithError(error.what());
      break;
    }
  }
}

BENCHMARK_CAPTURE(round_trips, block_same_core, Placement::block_same_core)
    ->Arg(1)
    ->Arg(10)
    ->Arg(50)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(round_trips, spin_other_core, Placement::spin_other_core)
    ->Arg(1)
    ->Arg(10)
    ->Arg(50)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stator::bench
