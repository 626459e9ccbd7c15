#include "stator/cli/client/rack_overview.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "stator/cli/client/device_state.hpp"
#include "stator/master/cia402/drive_state.hpp"

namespace stator::cli {

namespace {

using nlohmann::json;
using Axis = RackOverview::Axis;

constexpr std::size_t kEventsKept = 200;

/// A column of the table of axes and the signals it may come from, the best one first.
struct Column {
  std::optional<RackOverview::Value> Axis::*value = nullptr;
  std::array<std::string_view, 3> signals;
};
constexpr std::array kColumns{
    Column{&Axis::position, {"position_actual", "shaft_position", ""}},
    Column{&Axis::velocity, {"velocity_actual", "shaft_speed", ""}},
    Column{&Axis::current, {"current_actual", "quadrature_current", ""}},
    Column{&Axis::load, {"load_torque", "torque", ""}},
    Column{&Axis::temperature, {"winding_temperature", "driver_temperature", ""}},
};
constexpr std::string_view kStatusword = "statusword";
// A stepper motor has two coils; what counts is the length of their vector.
constexpr std::string_view kCoilA = "coil_current_a";
constexpr std::string_view kCoilB = "coil_current_b";

/// "gantry.axis0" and "position_actual"; nothing for a signal that belongs to no axis.
std::optional<std::pair<std::string, std::string>> split(const std::string& signal) {
  const std::size_t dot = signal.rfind('.');
  if (dot == std::string::npos) {
    return std::nullopt;
  }
  const std::string owner = signal.substr(0, dot);
  const std::size_t axis = owner.rfind('.') == std::string::npos ? 0 : owner.rfind('.') + 1;
  if (!std::string_view(owner).substr(axis).starts_with("axis")) {
    return std::nullopt;
  }
  return std::pair{owner, signal.substr(dot + 1)};
}

std::vector<std::string_view> shown_signals() {
  std::vector<std::string_view> names{kStatusword, kCoilA, kCoilB};
  for (const Column& column : kColumns) {
    std::ranges::copy_if(column.signals, std::back_inserter(names),
                         [](std::string_view name) { return !name.empty(); });
  }
  return names;
}

std::string state_of(double statusword) {
  const auto state = master::drive_state(static_cast<std::uint16_t>(statusword));
  return state ? std::string(to_text(*state)) : fmt::format("{:.0f}", statusword);
}

/// The signals of one axis by their last part.
using AxisSignals = std::map<std::string, RackOverview::Value, std::less<>>;

Axis axis_of(const std::string& name, const AxisSignals& signals) {
  Axis axis{name, {}};
  for (const Column& column : kColumns) {
    for (const std::string_view signal : column.signals) {
      if (const auto found = signals.find(signal); found != signals.end()) {
        axis.*column.value = found->second;
        break;
      }
    }
  }
  const auto a = signals.find(kCoilA);
  const auto b = signals.find(kCoilB);
  if (!axis.current && a != signals.end() && b != signals.end()) {
    axis.current = {std::hypot(a->second.value, b->second.value), a->second.unit};
  }
  if (const auto word = signals.find(kStatusword); word != signals.end()) {
    axis.state = state_of(word->second.value);
  }
  return axis;
}

}  // namespace

std::vector<RackOverview::Axis> axes_of(const json& signals) {
  std::vector<std::pair<std::string, AxisSignals>> axes;
  for (const json& signal : signals) {
    const auto parts = split(signal.at("name").get<std::string>());
    if (!parts || !signal.at("value").is_number()) {
      continue;
    }
    auto found = std::ranges::find(axes, parts->first, &std::pair<std::string, AxisSignals>::first);
    if (found == axes.end()) {
      axes.emplace_back(parts->first, AxisSignals{});
      found = std::prev(axes.end());
    }
    found->second[parts->second] = {signal["value"].get<double>(), signal.at("unit")};
  }
  std::vector<Axis> result;
  result.reserve(axes.size());
  for (const auto& [name, values] : axes) {
    result.push_back(axis_of(name, values));
  }
  return result;
}

const RackOverview& RackObserver::look() {
  read_rack();
  read_devices();
  read_axes();
  read_events();
  return overview_;
}

/// What was seen of an earlier run says nothing about this one.
void RackObserver::begin(const std::string& run) {
  choose_signals(client_.json("GET", "/api/v1/signals").at("signals"));
  overview_ = {};
  overview_.url = client_.url();
  overview_.run = run;
}

/// A pattern that matches nothing is an error there, so only those are asked for that do.
void RackObserver::choose_signals(const json& signals) {
  std::vector<std::string> patterns;
  for (const std::string_view name : shown_signals()) {
    const bool exists = std::ranges::any_of(signals, [name](const json& signal) {
      const auto parts = split(signal.at("name").get<std::string>());
      return parts && parts->second == name;
    });
    if (exists) {
      patterns.push_back(fmt::format("*axis*.{}", name));
    }
  }
  signals_ = fmt::format("{}", fmt::join(patterns, ","));
}

void RackObserver::read_rack() {
  const json rack = client_.json("GET", "/api/v1/rack");
  if (const std::string run = rack.at("run"); run != overview_.run) {
    begin(run);
  }
  const std::int64_t time = rack.at("time_ns");
  const double seconds = static_cast<double>(time - overview_.time_ns) * 1e-9;
  std::vector<RackOverview::Network> networks;
  for (const json& network : rack.at("networks")) {
    RackOverview::Network next{network.at("name"), network.at("kind"), network.at("received")};
    next.overruns = network.at("overruns");
    next.worst_lag_ns = network.at("worst_lag_ns");
    const auto before =
        std::ranges::find(overview_.networks, next.name, &RackOverview::Network::name);
    if (before != overview_.networks.end() && seconds > 0.0) {
      next.rate = static_cast<double>(next.received - before->received) / seconds;
    } else if (before != overview_.networks.end()) {
      next.rate = before->rate;  // in lockstep time may stand still
    }
    networks.push_back(std::move(next));
  }
  overview_.networks = std::move(networks);
  overview_.time_ns = time;
  overview_.clock = rack.at("clock");
  overview_.signals = rack.at("signals");
}

void RackObserver::read_devices() {
  overview_.devices.clear();
  const json answer = client_.json("GET", "/api/v1/devices");
  for (const json& device : answer.at("devices")) {
    overview_.devices.push_back(
        {device.at("name"), device.at("product"), device.at("network"), state_of_device(device)});
  }
}

void RackObserver::read_axes() {
  if (!signals_.empty()) {
    overview_.axes = axes_of(
        client_.json("GET", "/api/v1/signals?names=" + url_encoded(signals_)).at("signals"));
  }
}

void RackObserver::read_events() {
  std::vector<RackOverview::Event>& events = overview_.events;
  const std::uint64_t last = events.empty() ? 0 : events.back().number;
  const json answer = client_.json("GET", fmt::format("/api/v1/events?after={}", last));
  for (const json& event : answer.at("events")) {
    events.push_back({event.at("number"), event.at("time_ns"), event.at("device"),
                      event.at("severity"), event.at("text")});
  }
  if (events.size() > kEventsKept) {
    events.erase(events.begin(), events.end() - static_cast<std::ptrdiff_t>(kEventsKept));
  }
}

}  // namespace stator::cli
