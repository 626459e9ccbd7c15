// What a rack keeps of its round trips per second while somebody looks at it through its web
// server, against the same rack that nobody looks at, in turns in the same run. Bus and master have
// one processor, the server and who looks another, so that what is measured is the rack's own work
// for them. Stated limit for a page of the dashboard: 0.95. Needs the right to create network
// namespaces and two processors.

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

#include "cyclic_rack.hpp"
#include "stator/web/server/server.hpp"
#include "veth_echo.hpp"
#include "web/http_client.hpp"

namespace stator::benchmarks {
namespace {

constexpr std::size_t kRounds = 7;
/// Some seconds: the watcher has to connect first, and a page asks 2.5 times a second.
constexpr std::size_t kRoundTrips = 500'000;
constexpr unsigned kProcessorOfWatcher = 1;

/// What somebody looks at.
struct Watch {
  const char* subscription;  ///< of the stream of signals
  bool page;  ///< also what a device's page of the dashboard asks for again and again
};

/// The page of a device: its signals, its panel and two objects.
constexpr Watch kPage{R"({"signals": ["tmcm-3315.axis0.*"], "period": "50ms", "events": true})",
                      true};
/// The oscilloscope: ten signals as fast as there are any.
constexpr Watch kScope{R"({"signals": ["tmcm-3315.axis0.position_*", "tmcm-3315.axis0.velocity_*",)"
                       R"( "tmcm-3315.axis0.following_error", "tmcm-3315.axis0.shaft_*",)"
                       R"( "tmcm-3315.axis0.coil_*", "tmcm-3315.axis0.torque"],)"
                       R"( "period": "50us", "format": "binary"})",
                       false};

void watch(const Watch& watch, std::uint16_t port, const std::atomic<bool>& stop) {
  web::HttpClient stream(port);
  const web::Answer upgraded =
      stream.request("GET", "/api/v1/signals", "", web::HttpClient::upgrade_fields());
  if (upgraded.status != 101) {
    throw std::runtime_error("the server does not stream: " + upgraded.body);
  }
  stream.send_frame(1, watch.subscription);
  web::HttpClient pages(port);
  auto next_look = std::chrono::steady_clock::now();
  while (!stop) {
    if (!stream.receive_frame()) {
      throw std::runtime_error("the stream of signals has ended");
    }
    if (watch.page && std::chrono::steady_clock::now() >= next_look) {
      next_look += std::chrono::milliseconds(400);
      for (const char* path : {"panel", "objects/6041/00", "objects/6061/00"}) {
        if (pages.request("GET", "/api/v1/devices/tmcm-3315/" + std::string(path)).status != 200) {
          throw std::runtime_error(std::string("no answer to a request for ") + path);
        }
      }
    }
  }
}

Peer watched_rack_peer(const Watch& wanted) {
  return [wanted](const PeerEnd& end) {
    CyclicRack rack(1, end);
    if (std::system("ip link set lo up") != 0) {  // NOLINT(concurrency-mt-unsafe): one thread
      throw std::runtime_error("the namespace has no loopback interface");
    }
    std::optional<web::Server> server;
    std::atomic<bool> watched{false};
    std::thread watcher([&] {
      // The server's thread inherits this.
      static_cast<void>(link::pin_this_thread(kProcessorOfWatcher));
      server.emplace(web::ServerConfiguration{.address = {"127.0.0.1", 0}, .token = {}},
                     rack.rack(), rack.configuration(), rack.log(), rack.runner());
      server->start();
      watch(wanted, server->address().port, end.stop);
      watched = true;
    });
    rack.run(watched);
    watcher.join();
    server.reset();
  };
}

void watched_round_trips(benchmark::State& state, const Watch& wanted) {
  for ([[maybe_unused]] auto iteration : state) {
    try {
      const std::vector<std::byte> frame = cyclic_frame(1);
      const std::array<Peer, 2> peers{rack_peer(1), watched_rack_peer(wanted)};
      const auto rates = compare(peers, Placement::block_same_core, frame, kRounds, kRoundTrips);
      state.counters["unwatched_per_s"] = rates[0];
      state.counters["watched_per_s"] = rates[1];
      state.counters["ratio"] = rates[1] / rates[0];
    } catch (const std::runtime_error& error) {
      state.SkipWithError(error.what());
      break;
    }
  }
}

BENCHMARK_CAPTURE(watched_round_trips, page, kPage)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(watched_round_trips, scope, kScope)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stator::benchmarks
