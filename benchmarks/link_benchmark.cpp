#include <array>
#include <stdexcept>

#include <benchmark/benchmark.h>

#include "veth_echo.hpp"

// Round trips per second over a veth pair: a bare echo, which is what the machine can do at best,
// against the same through RawEthernetLink, in turns in the same run. The counter `ratio` is what
// the link keeps of the bare echo's rate. Stated limit: 0.85 for a rack, so the link must be above.

namespace stator::benchmarks {
namespace {

constexpr std::size_t kRounds = 9;
constexpr std::size_t kRoundTrips = 5'000;

std::vector<std::byte> short_frame(std::size_t length) {
  std::vector<std::byte> frame(length);
  std::fill_n(frame.begin(), 6, std::byte{0xFF});
  frame[6] = std::byte{0x02};
  frame[12] = std::byte{0x88};
  frame[13] = std::byte{0xA4};
  return frame;
}

bool send_back(std::span<std::byte> frame) {
  frame[6] |= std::byte{0x02};
  return true;
}

void round_trips(benchmark::State& state, Placement placement) {
  const std::vector<std::byte> frame = short_frame(static_cast<std::size_t>(state.range(0)));
  const std::array<Peer, 2> peers{bare_echo, link_echo(send_back)};
  for ([[maybe_unused]] auto iteration : state) {
    try {
      const auto rates = compare(peers, placement, frame, kRounds, kRoundTrips);
      state.counters["bare_per_s"] = rates[0];
      state.counters["link_per_s"] = rates[1];
      state.counters["ratio"] = rates[1] / rates[0];
    } catch (const std::runtime_error& error) {
      state.SkipWithError(error.what());
      break;
    }
  }
}

BENCHMARK_CAPTURE(round_trips, block_same_core, Placement::block_same_core)
    ->Arg(60)
    ->Arg(1514)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(round_trips, spin_other_core, Placement::spin_other_core)
    ->Arg(60)
    ->Arg(1514)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stator::benchmarks
