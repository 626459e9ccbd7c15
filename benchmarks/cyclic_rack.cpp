#include "cyclic_rack.hpp"

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "rack/text_log.hpp"
#include "stator/bench/local_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/master/master.hpp"
#include "stator/rack/core/device_making.hpp"

namespace stator::benchmarks {

namespace {

rack::RackConfiguration line_of(std::size_t modules) {
  rack::RackConfiguration configuration =
      rack::single_device_rack("tmcm-3315", devices::products());
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
  bench::LocalPort port(rack, 0, configuration.cycle, configuration.step);
  CycleRecorder recorder(port);
  master::Master master(recorder);
  require(master.scan());
  require(master.configure_process_data());
  require(master.go_operational());
  recorder.forget();
  require(master.exchange_process_data());
  return recorder.frame();
}

}  // namespace

CyclicRack::CyclicRack(std::size_t modules, const PeerEnd& end)
    : configuration_(line_of(modules)), rack_(configuration_, log_) {
  configuration_.segments.front().link = {link::LinkKind::raw_ethernet, end.interface, 0};
  configuration_.segments.front().wait = end.wait;
  bring_to_operational(rack_, configuration_);
  runner_.emplace(rack_, configuration_, tests::no_log());
}

void CyclicRack::run(const std::atomic<bool>& stop) {
  runner_->start();
  while (!stop) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  runner_->stop();
}

Peer rack_peer(std::size_t modules) {
  return [modules](const PeerEnd& end) { CyclicRack(modules, end).run(end.stop); };
}

std::vector<std::byte> cyclic_frame(std::size_t modules) {
  const rack::RackConfiguration configuration = line_of(modules);
  rack::EventLog log;
  rack::Rack rack(configuration, log);
  return bring_to_operational(rack, configuration);
}

}  // namespace stator::benchmarks
