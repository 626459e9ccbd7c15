#include "stator/web/api/snapshot_job.hpp"

#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "stator/product/device/device.hpp"
#include "stator/web/api/snapshot.hpp"
#include "stator/web/json_text.hpp"
#include "stator/web/network_state.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

std::string_view state_name(const Snapshot::DeviceState& state) {
  if (!state.powered) {
    return "off";
  }
  switch (state.network_state) {
    case dictionary::NetworkState::operational:
      return "operational";
    case dictionary::NetworkState::safe_operational:
      return "safe-operational";
    case dictionary::NetworkState::pre_operational:
      break;
  }
  return "pre-operational or below";
}

Json device_json(const DeviceRecord& device, const Snapshot::DeviceState& state) {
  const std::string_view network_state = network_state_text(state.powered, state.network_status);
  return {
      {"name", device.name},
      {"product", device.product},
      {"network", device.network},
      {"powered", state.powered},
      {"state", state_name(state)},
      {"network_state", network_state.empty() ? Json(nullptr) : Json(network_state)},
      {"objects", device.objects == nullptr ? std::size_t{0} : device.objects->entries().size()},
      {"inputs", device.inputs->size()},
      {"per_revolution", device.motion_units ? Json{{"position", device.motion_units->position},
                                                    {"velocity", device.motion_units->velocity}}
                                             : Json(nullptr)}};
}

/// What can be read of the rack at one moment.
class SnapshotJob final : public LookJob {
 public:
  SnapshotJob(const State& state, Operation operation, std::vector<std::size_t> signals,
              std::size_t device)
      : state_(state),
        operation_(operation),
        chosen_(std::move(signals)),
        device_(device),
        snapshot_(state) {}

  bool look(const rack::View& rack, base::SimTime now) override {
    snapshot_.time = now;
    snapshot_.lost = state_.lost_in_task();
    state_.read_networks(snapshot_.networks);
    for (std::size_t i = 0; i < snapshot_.devices.size(); ++i) {
      const rack::DeviceAddress address = state_.devices()[i].address;
      snapshot_.devices[i] = {rack.powered(address), rack.network_state(address),
                              rack.device(address).network_status()};
    }
    for (const std::size_t i : chosen_) {
      snapshot_.signals[i] = state_.signals()[i].read();
    }
    return true;
  }

  Response response() override {
    switch (operation_) {
      case Operation::health:
        return {.content_type = "text/plain; charset=utf-8", .body = "ok\n"};
      case Operation::metrics:
        return {.content_type = "application/openmetrics-text; version=1.0.0; charset=utf-8",
                .body = openmetrics(state_, snapshot_)};
      case Operation::rack:
        return json_response(rack());
      case Operation::devices:
        return json_response({{"devices", devices()}});
      case Operation::device:
        return json_response(device_json(state_.devices()[device_], snapshot_.devices[device_]));
      default:
        return json_response(signals());
    }
  }

 private:
  Json rack() {
    Json networks = Json::array();
    for (const NetworkRecord& network : snapshot_.networks) {
      networks.push_back({{"name", network.name},
                          {"kind", network.kind},
                          {"received", network.frames},
                          {"overruns", network.overruns},
                          {"worst_lag_ns", network.worst_lag_ns}});
    }
    return {{"run", state_.run()},
            {"clock", state_.clock()},
            {"time_ns", snapshot_.time.nanoseconds()},
            {"lost_ns", snapshot_.lost.nanoseconds()},
            {"networks", networks},
            {"devices", state_.devices().size()},
            {"signals", state_.signals().size()}};
  }

  Json devices() {
    Json all = Json::array();
    for (std::size_t i = 0; i < snapshot_.devices.size(); ++i) {
      all.push_back(device_json(state_.devices()[i], snapshot_.devices[i]));
    }
    return all;
  }

  Json signals() {
    Json all = Json::array();
    for (const std::size_t i : chosen_) {
      const product::Signal& signal = state_.signals()[i];
      all.push_back(
          {{"name", signal.name}, {"unit", signal.unit}, {"value", finite(snapshot_.signals[i])}});
    }
    return {{"time_ns", snapshot_.time.nanoseconds()}, {"signals", all}};
  }

  const State& state_;
  Operation operation_;
  std::vector<std::size_t> chosen_;  ///< signals to read
  std::size_t device_;
  Snapshot snapshot_;
};

}  // namespace

std::unique_ptr<Job> make_snapshot_job(const State& state, Operation operation,
                                       std::vector<std::size_t> signals, std::size_t device) {
  return std::make_unique<SnapshotJob>(state, operation, std::move(signals), device);
}

}  // namespace stator::web
