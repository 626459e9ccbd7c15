#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <vector>

#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/run/runner.hpp"
#include "veth_echo.hpp"

namespace stator::benchmarks {

/// A line of TMCM-3315 in Operational at the far end of a cable, run as `stator run` runs it.
class CyclicRack {
 public:
  /// Throws std::runtime_error with the reason when a module does not get to Operational.
  CyclicRack(std::size_t modules, const PeerEnd& end);

  /// Answers frames until told to stop.
  void run(const std::atomic<bool>& stop);

  [[nodiscard]] const rack::RackConfiguration& configuration() const { return configuration_; }
  [[nodiscard]] rack::EventLog& log() { return log_; }
  [[nodiscard]] rack::Rack& rack() { return rack_; }
  [[nodiscard]] rack::Runner& runner() { return *runner_; }

 private:
  rack::RackConfiguration configuration_;
  rack::EventLog log_;
  rack::Rack rack_;
  std::optional<rack::Runner> runner_;
};

/// Such a rack and nobody who looks at it.
Peer rack_peer(std::size_t modules);

/// The frame with which a master exchanges the process data of the first of `modules`.
std::vector<std::byte> cyclic_frame(std::size_t modules);

}  // namespace stator::benchmarks
