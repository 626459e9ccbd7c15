#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "replay/random_sessions/random_rack.hpp"
#include "stator/base/random.hpp"
#include "stator/can/port.hpp"
#include "stator/master/frame_port.hpp"
#include "stator/rack/core/bus_port.hpp"
#include "stator/rack/core/command.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/signal_tap.hpp"
#include "stator/rack/observe/traffic_tap.hpp"
#include "stator/rack/world/clock.hpp"

namespace stator::tests {

/// What the threads of a runner do to a rack with masters at all its networks, a web page and
/// people, in one thread and by chance: each piece that a thread does while it holds the rack comes
/// whole, between two of them may be those of any other. No clock: time is as the seed has it.
class LiveRun {
 public:
  /// `rack` was built from `configuration`; it stands at `start`.
  LiveRun(rack::Rack& rack, const rack::RackConfiguration& configuration, std::uint64_t seed,
          base::SimTime start = {});
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;
  /// Takes ports and taps away.
  ~LiveRun();

  /// Goes on for `length`.
  void run(base::SimDuration length);

  [[nodiscard]] base::SimTime now() const { return real_ ? now_ : clock_.now(); }
  /// Names that were given to moments.
  [[nodiscard]] const std::vector<std::string>& marks() const { return marks_; }

 private:
  class SegmentPort;

  [[nodiscard]] bool chance(double probability) { return random_.uniform() < probability; }
  [[nodiscard]] bool over() const { return now() >= end_; }
  void pass(std::uint64_t most_microseconds);
  void others();
  void one_other();
  void catch_up();

  void serve_segment(std::size_t segment);
  void master_session(std::size_t segment);
  void random_frame(std::size_t segment);
  std::optional<std::size_t> exchange(std::size_t segment, std::span<std::byte> frame);
  void release(std::size_t segment);
  void change_carrier();

  void talk_on_bus(std::size_t bus);
  void drain(std::size_t bus);
  [[nodiscard]] can::Frame random_can_frame();

  void talk_on_line(std::size_t line);
  void put_bytes(std::size_t line, std::span<const std::byte> bytes);

  void tasks();
  void access_object();
  void change_taps();

  rack::Rack& rack_;
  const rack::RackConfiguration& configuration_;
  base::Random random_;
  bool real_;
  base::SimTime now_;
  rack::LockstepClock clock_;
  base::SimTime end_;
  std::vector<DeviceFacts> facts_;
  std::vector<product::Signal> signals_;
  std::vector<std::vector<std::unique_ptr<rack::BusPort>>> ports_;  ///< by bus
  std::vector<std::unique_ptr<rack::SignalTap>> taps_;
  rack::TrafficTap traffic_{1024};
  bool inside_ = false;                     ///< others() was called by what it called
  std::vector<std::size_t> bytes_in_step_;  ///< by line, lockstep
  std::vector<std::byte> last_frame_;
  std::vector<std::string> marks_;
};

}  // namespace stator::tests
