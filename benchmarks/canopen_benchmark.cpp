// Cost of a CANopen node: requests go from a client's port over an unlimited bus into the node's
// controller, and its answers back. "of_limit" of a round trip is its rate in parts of the least
// that is allowed, 50,000 per second; that of a block upload of 10,240 bytes is its time in parts
// of the most, 20 ms. A frame that is none of the node's business is measured for a node on its
// own.

#include <array>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>

#include "stator/base/byte_order.hpp"
#include "stator/can/bus.hpp"
#include "stator/canopen/nmt/node.hpp"

namespace {

using namespace stator;
using canopen::Node;
using dictionary::EntryDeclaration;

constexpr double kRoundTrips = 50'000;  // per second, at least
constexpr double kBlockUpload = 20e-3;  // s, at most
constexpr std::size_t kBlockBytes = 10'240;
constexpr std::uint32_t kRequest = 0x601;

constexpr auto kObjects = std::to_array<EntryDeclaration>({
    {.index = 0x1000, .name = "Device type", .access = dictionary::Access::constant},
    {.index = 0x1021,
     .name = "Store EDS",
     .object_code = dictionary::ObjectCode::domain_object,
     .type = dictionary::DataType::domain,
     .access = dictionary::Access::read_only},
    {.index = 0x607A, .name = "Target position", .type = dictionary::DataType::integer32},
});

/// A booted node and a client on one bus.
class Network {
 public:
  Network() {
    dictionary_.add(kObjects);
    dictionary_.finish();
    dictionary_.find(0x1021, 0)->set_text(std::string(kBlockBytes, 'e'));
    node_ = std::make_unique<Node>(dictionary_, controller_, base::EventReporter());
    bus_.add(controller_);
    bus_.add(port_);
    node_->power_on(now_);
    now_ += base::SimDuration(1'000'000'000);
    node_->advance(now_);
    settle();
    while (port_.take()) {
    }
  }

  /// Sends one frame and lets bus and node do all that follows from it.
  void send(const can::Frame& frame) {
    now_ +=
        base::SimDuration(1'000);  // an unlimited bus carries only so many frames at one instant
    port_.put(frame);
    settle();
  }
  std::optional<can::TimedFrame> take() { return port_.take(); }
  Node& node() { return *node_; }
  [[nodiscard]] base::SimTime now() const { return now_; }

 private:
  void settle() {
    while (!bus_.idle()) {
      bus_.advance(now_);
      while (const auto frame = controller_.take()) {
        node_->receive(*frame, now_);
      }
    }
  }

  dictionary::Dictionary dictionary_;
  can::Controller controller_;
  can::Port port_;
  can::Bus bus_;
  std::unique_ptr<Node> node_;
  base::SimTime now_;
};

void round_trips(benchmark::State& state, const can::Frame& request, std::byte answer) {
  Network network;
  for (auto _ : state) {
    network.send(request);
    const auto reply = network.take();
    if (!reply || reply->frame.data[0] != answer) {
      state.SkipWithError("no answer");
      break;
    }
  }
  state.counters["of_limit"] = benchmark::Counter(
      static_cast<double>(state.iterations()) / kRoundTrips, benchmark::Counter::kIsRate);
}

void expedited_upload(benchmark::State& state) {
  round_trips(state, can::data_frame(kRequest, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}), std::byte{0x43});
}
BENCHMARK(expedited_upload);

void expedited_download(benchmark::State& state) {
  round_trips(state, can::data_frame(kRequest, {0x23, 0x7A, 0x60, 0, 1, 2, 3, 4}), std::byte{0x60});
}
BENCHMARK(expedited_download);

/// The client's side of a block upload, without losses; the bytes it got.
std::size_t block_upload(Network& network) {
  network.send(can::data_frame(kRequest, {0xA4, 0x21, 0x10, 0, 127, 0, 0, 0}));
  network.take();
  network.send(can::data_frame(kRequest, {0xA3, 0, 0, 0, 0, 0, 0, 0}));
  std::size_t bytes = 0;
  while (true) {
    unsigned segments = 0;
    bool last = false;
    while (const auto segment = network.take()) {
      ++segments;
      last = std::to_integer<unsigned>(segment->frame.data[0]) >> 7 != 0;
    }
    if (segments == 0) {
      return 0;
    }
    bytes += segments * 7;
    network.send(can::data_frame(kRequest, {0xA2, segments, 127, 0, 0, 0, 0, 0}));
    if (last) {
      const auto end = network.take();
      network.send(can::data_frame(kRequest, {0xA1, 0, 0, 0, 0, 0, 0, 0}));
      return end ? bytes - ((std::to_integer<unsigned>(end->frame.data[0]) >> 2) & 7) : 0;
    }
  }
}

void block_upload_of_10240_bytes(benchmark::State& state) {
  Network network;
  for (auto _ : state) {
    if (block_upload(network) != kBlockBytes) {
      state.SkipWithError("the upload failed");
      break;
    }
  }
  state.counters["of_limit"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * kBlockUpload,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(block_upload_of_10240_bytes);

void frame_for_somebody_else(benchmark::State& state) {
  Network network;
  const can::Frame frame = can::data_frame(0x18A, {1, 2, 3, 4, 5, 6, 7, 8});
  for (auto _ : state) {
    network.node().receive(frame, network.now());
  }
}
BENCHMARK(frame_for_somebody_else);

}  // namespace
