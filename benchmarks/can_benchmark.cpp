// Frames per second through a CAN bus in process, SDO round trips of a client in process, and the
// real-time factor of 32 TMCC160 with a SYNC every millisecond in lockstep on one core. Stated
// limits: 50,000 round trips per second, 20 times real time; `of_gate` is the share of the limit
// that is reached, 1 and more is good.

#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "stator/bench/local_can_port.hpp"
#include "stator/can/bus.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::benchmarks {
namespace {

using namespace base::literals;

constexpr double kRoundTripGate = 50'000.0;
constexpr double kRealTimeGate = 20.0;
constexpr unsigned kDrives = 32;

/// A port sends, `nodes` nodes hear everything, another port takes everything.
void frames_through_the_bus(benchmark::State& state, std::optional<std::uint32_t> bit_rate) {
  std::vector<std::unique_ptr<can::Controller>> nodes;
  can::Port sender;
  can::Port listener;
  can::Bus bus({.bit_rate = bit_rate});
  bus.add(sender);
  bus.add(listener);
  for (std::int64_t i = 0; i < state.range(0); ++i) {
    nodes.push_back(std::make_unique<can::Controller>());
    nodes.back()->filter().accept_none();
    nodes.back()->filter().accept(0x601U + static_cast<std::uint32_t>(i));
    bus.add(*nodes.back());
  }
  base::SimTime now;
  std::uint32_t count = 0;
  for ([[maybe_unused]] auto iteration : state) {
    sender.put(can::data_frame(0x601U + count++ % 32U, {1, 2, 3, 4, 5, 6, 7, 8}));
    do {
      now += 200_us;
      bus.advance(now);
    } while (!bus.idle());
    for (const auto& node : nodes) {
      while (node->take()) {
      }
    }
    benchmark::DoNotOptimize(listener.take());
  }
  state.SetItemsProcessed(state.iterations());
}

BENCHMARK_CAPTURE(frames_through_the_bus, unlimited, std::nullopt)->Arg(1)->Arg(32);
BENCHMARK_CAPTURE(frames_through_the_bus, paced, 1'000'000U)->Arg(1)->Arg(32);

/// A rack with `drives` TMCC160 on an unlimited bus that have reported their boot-up.
class Drives {
 public:
  explicit Drives(unsigned drives)
      : configuration_(make(drives)), rack_(configuration_, log_), port_(rack_, 0, 1_ms, 1_us) {
    port_.wait(1_s);
    drain();
  }

  can::Frame request(unsigned node, const can::Frame& frame) {
    port_.send(frame);
    for (int i = 0; i < 1000; ++i) {
      while (const auto entry = port_.receive()) {
        if (entry->frame.identifier == 0x580U + node) {
          return entry->frame;
        }
      }
      port_.wait(1_ms);
    }
    throw std::runtime_error("node " + std::to_string(node) + " does not answer");
  }
  /// Writes an object of one to four bytes.
  void write(unsigned node, unsigned index, unsigned subindex, std::uint32_t value,
             unsigned length) {
    const unsigned command = 0x23U | (4U - length) << 2U;
    const can::Frame answer =
        request(node, can::data_frame(0x600U + node,
                                      {command, index & 0xFFU, index >> 8U, subindex, value & 0xFFU,
                                       value >> 8U & 0xFFU, value >> 16U & 0xFFU, value >> 24U}));
    if (answer.data[0] != std::byte{0x60}) {
      throw std::runtime_error("write to " + std::to_string(index) + " refused");
    }
  }
  void sync() { port_.send(can::data_frame(0x80, {})); }
  void start_nodes() { port_.send(can::data_frame(0x000, {1, 0})); }
  std::size_t drain() {
    std::size_t frames = 0;
    while (port_.receive()) {
      ++frames;
    }
    return frames;
  }
  [[nodiscard]] base::SimTime now() const { return port_.now(); }

 private:
  static rack::RackConfiguration make(unsigned drives) {
    rack::RackConfiguration configuration =
        rack::single_device_rack("tmcc160", devices::products());
    rack::BusConfiguration& bus = configuration.buses.front();
    bus.bit_rate = std::nullopt;
    const rack::DeviceConfiguration first = bus.devices.front();
    bus.devices.clear();
    for (unsigned i = 1; i <= drives; ++i) {
      rack::DeviceConfiguration& device = bus.devices.emplace_back(first);
      device.name = "drive-" + std::to_string(i);
      device.setup.as<devices::Tmcc160Configuration>().node_id = static_cast<std::uint8_t>(i);
    }
    return configuration;
  }

  rack::EventLog log_;
  rack::RackConfiguration configuration_;
  rack::Rack rack_;
  bench::LocalCanPort port_;
};

void sdo_round_trips(benchmark::State& state) {
  Drives drives(1);
  const can::Frame upload = can::data_frame(0x601, {0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  const auto begin = std::chrono::steady_clock::now();
  for ([[maybe_unused]] auto iteration : state) {
    benchmark::DoNotOptimize(drives.request(1, upload));
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const double rate = static_cast<double>(state.iterations()) / took.count();
  state.counters["per_s"] = rate;
  state.counters["of_gate"] = rate / kRoundTripGate;
}
BENCHMARK(sdo_round_trips);

/// Lets every drive turn in profile velocity mode.
void turn(Drives& drives) {
  for (unsigned node = 1; node <= kDrives; ++node) {
    drives.write(node, 0x6060, 0, 3, 1);
    for (const std::uint32_t controlword : {0x06U, 0x07U, 0x0FU}) {
      drives.write(node, 0x6040, 0, controlword, 2);
      drives.sync();
      drives.sync();
    }
    drives.write(node, 0x60FF, 0, 500, 4);
  }
}

void lockstep(benchmark::State& state, bool turning) {
  try {
    Drives drives(kDrives);
    drives.start_nodes();
    if (turning) {
      turn(drives);
    }
    drives.drain();
    std::size_t frames = 0;
    std::size_t cycles = 0;
    for ([[maybe_unused]] auto iteration : state) {
      drives.sync();
      frames += drives.drain();
      ++cycles;
    }
    // Rates are of the processor time spent: the gate is for one core of its own.
    using benchmark::Counter;
    const double simulated = static_cast<double>(cycles) * 1e-3;  // s
    state.counters["real_time_factor"] = Counter(simulated, Counter::kIsRate);
    state.counters["of_gate"] = Counter(simulated / kRealTimeGate, Counter::kIsRate);
    state.counters["frames_per_cycle"] = static_cast<double>(frames) / static_cast<double>(cycles);
  } catch (const std::runtime_error& error) {
    state.SkipWithError(error.what());
  }
}
BENCHMARK_CAPTURE(lockstep, switched_off, false)->Iterations(2000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(lockstep, turning, true)->Iterations(2000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace stator::benchmarks
