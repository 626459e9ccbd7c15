#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/product/device/indicator.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// The rack at one moment. Everything has its room before a task fills it.
struct Snapshot {
  struct DeviceState {
    bool powered = false;
    dictionary::NetworkState network_state = dictionary::NetworkState::pre_operational;
    product::NetworkStatus network_status{};
  };

  explicit Snapshot(const State& state)
      : networks(state.networks()),
        devices(state.devices().size()),
        signals(state.signals().size()) {}

  base::SimTime time;
  base::SimDuration lost;  ///< that the machine was too slow for
  std::vector<NetworkRecord> networks;
  std::vector<DeviceState> devices;
  std::vector<double> signals;
};

/// The snapshot and the server's own counters as OpenMetrics text.
[[nodiscard]] std::string openmetrics(const State& state, const Snapshot& snapshot);

}  // namespace stator::web
