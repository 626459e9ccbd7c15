#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stator/rack/observe/traffic_tap.hpp"
#include "stator/web/state.hpp"
#include "stator/web/stream/rack_access.hpp"
#include "stator/web/stream/traffic_map.hpp"

namespace stator::web {

/// A frame as it goes to clients.
struct TrafficFrame {
  std::size_t network = 0;  ///< segments first, then the rack's buses
  std::string words{};      ///< in lower case: all that a filter looks at
  std::string json{};
};

/// A client that gets the decoded frames of the networks.
class TrafficWatcher {
 public:
  TrafficWatcher() = default;
  TrafficWatcher(const TrafficWatcher&) = delete;
  TrafficWatcher& operator=(const TrafficWatcher&) = delete;
  virtual ~TrafficWatcher() = default;

  /// `lost`: frames that came before these and are not among them, whatever their network.
  virtual void show(const std::vector<TrafficFrame>& frames, std::uint64_t lost) = 0;
};

/// Watches the networks for all who want to see them, through one tap, which is in the rack only
/// while there is somebody. Decodes frames so many at a time that the server has time for others.
class TrafficHub : private Waiter {
 public:
  TrafficHub(State& state, RackAccess& access);

  void add(TrafficWatcher& watcher);
  void remove(const TrafficWatcher& watcher);
  /// Names of the networks that can be watched, by number; empty for a bus without wire.
  [[nodiscard]] const std::vector<std::string>& networks() const { return networks_; }

  /// To be called periodically.
  void tick(RackAccess::Clock::time_point now);

 private:
  class WatchJob;

  void answer(Response response) override;
  [[nodiscard]] bool post(std::unique_ptr<Job> job);
  void collect();
  [[nodiscard]] TrafficFrame describe(const rack::TrafficTap::Record& record) const;

  State& state_;
  RackAccess& access_;
  std::vector<std::string> networks_;
  std::vector<TrafficWatcher*> watchers_;
  std::optional<rack::TrafficTap> tap_;  ///< from the first watcher on
  TrafficMap map_;
  bool mapped_ = false;     ///< the map has been read since somebody watches
  bool under_way_ = false;  ///< the rack has a job
  bool inside_ = false;     ///< the rack has the tap
  std::uint64_t lost_ = 0;  ///< by the tap, as told
  RackAccess::Clock::time_point next_collect_;
  RackAccess::Clock::time_point next_map_;
};

}  // namespace stator::web
