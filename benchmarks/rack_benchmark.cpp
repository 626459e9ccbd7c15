// Round trips per second of a complete rack in Operational (link, slave controllers, slave
// software, drives, motors) against a bare echo of the same frame over the same kind of veth pair,
// in turns in the same run. The counter `ratio` is what the rack keeps of the bare echo's rate;
// stated limit for one slave: 0.85 in both placements. Needs the right to create network
// namespaces.

#include <array>
#include <stdexcept>
#include <vector>

#include <benchmark/benchmark.h>

#include "cyclic_rack.hpp"
#include "veth_echo.hpp"

namespace stator::benchmarks {
namespace {

constexpr std::size_t kRounds = 9;
constexpr std::size_t kRoundTrips = 5'000;

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
}  // namespace stator::benchmarks
