#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "stator/cli/client/http_client.hpp"

namespace stator::cli {

/// What is going on in a running rack, as its web server tells it.
struct RackOverview {
  struct Network {
    std::string name;
    std::string kind;
    std::uint64_t received = 0;
    std::optional<double> rate{};  ///< frames or bytes per second of simulated time
    std::uint64_t overruns = 0;
    std::int64_t worst_lag_ns = 0;
  };
  struct Device {
    std::string name;
    std::string product;
    std::string network;
    std::string state;
  };
  /// A value of an axis with its unit.
  struct Value {
    double value = 0.0;
    std::string unit;
  };
  struct Axis {
    std::string name;   ///< "gantry.axis0"
    std::string state;  ///< of CiA 402; empty for drives without it
    std::optional<Value> position{};
    std::optional<Value> velocity{};
    std::optional<Value> current{};
    std::optional<Value> load{};
    std::optional<Value> temperature{};
  };
  struct Event {
    std::uint64_t number = 0;
    std::int64_t time_ns = 0;
    std::string device;
    std::string severity;
    std::string text;
  };

  std::string url;
  std::string run;  ///< another: the rack was started again, or went back to a snapshot
  std::string clock;
  std::int64_t time_ns = 0;
  std::size_t signals = 0;
  std::vector<Network> networks;
  std::vector<Device> devices;
  std::vector<Axis> axes;
  std::vector<Event> events;  ///< oldest first
};

/// Asks a rack again and again, and works out from two answers what the rates are.
class RackObserver {
 public:
  explicit RackObserver(HttpClient& client) : client_(client) {}

  /// Throws Failure if there is no answer.
  [[nodiscard]] const RackOverview& look();

 private:
  void begin(const std::string& run);
  void read_rack();
  void read_devices();
  void read_axes();
  void read_events();
  void choose_signals(const nlohmann::json& signals);

  HttpClient& client_;
  RackOverview overview_;
  std::string signals_;  ///< patterns of those that are shown
};

/// The axes among signals as GET /api/v1/signals lists them, in the order of their names there.
[[nodiscard]] std::vector<RackOverview::Axis> axes_of(const nlohmann::json& signals);

}  // namespace stator::cli
