#include "stator/web/api/panel_api.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/drive/power/state_description.hpp"
#include "stator/product/device/device.hpp"
#include "stator/web/json_text.hpp"
#include "stator/web/network_state.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

/// A row of an axis on a panel, and the signals it may show, in order of preference: products
/// differ.
struct Shown {
  std::string_view name;
  std::initializer_list<std::string_view> signals;
};

const std::array<Shown, 6> kShown{{
    {"position", {"position_actual"}},
    {"velocity", {"velocity_actual"}},
    {"current", {"current_actual", "quadrature_current", "coil_current_a"}},
    {"load", {"load_torque"}},
    {"temperature", {"winding_temperature"}},
    {"shaft_angle", {"shaft_position"}},
}};

const product::Signal* find_signal(const State& state, std::string_view name) {
  for (const product::Signal& signal : state.signals()) {
    if (signal.name == name) {
      return &signal;
    }
  }
  return nullptr;
}

/// An axis of the device, by the signals it has.
struct Axis {
  std::string name;
  std::int64_t number = 0;
  const product::Signal* statusword = nullptr;  ///< null: it is none of CiA 402
  const product::Signal* mode = nullptr;
  Json signals = Json::object();
  double statusword_value = 0.0;
  double mode_value = 0.0;
};

std::vector<Axis> axes_of(const State& state, const DeviceRecord& device) {
  std::vector<Axis> axes;
  for (std::int64_t number = 0;; ++number) {
    const std::string name = fmt::format("axis{}", number);
    const std::string prefix = device.name + "." + name + ".";
    Axis axis{.name = name, .number = number};
    for (const Shown& shown : kShown) {
      for (const std::string_view signal : shown.signals) {
        if (find_signal(state, prefix + std::string(signal)) != nullptr) {
          axis.signals[std::string(shown.name)] = prefix + std::string(signal);
          break;
        }
      }
    }
    if (axis.signals.empty()) {
      return axes;
    }
    axis.statusword = find_signal(state, prefix + "statusword");
    axis.mode = find_signal(state, prefix + "mode");
    axes.push_back(std::move(axis));
  }
}

class PanelJob final : public LookJob {
 public:
  PanelJob(const State& state, const DeviceRecord& device)
      : state_(state), device_(device), axes_(axes_of(state, device)) {}

  bool look(const rack::View& rack, base::SimTime /*now*/) override {
    const product::Device& device = rack.device(device_.address);
    powered_ = rack.powered(device_.address);
    leds_ = device.indicators();
    network_ = device.network_status();
    program_ = device.tmcl_firmware() != nullptr;
    for (Axis& axis : axes_) {
      axis.statusword_value = axis.statusword != nullptr ? axis.statusword->read() : 0.0;
      axis.mode_value = axis.mode != nullptr ? axis.mode->read() : 0.0;
    }
    return true;
  }

  Response response() override {
    Json axes = Json::array();
    for (const Axis& axis : axes_) {
      axes.push_back(axis_json(axis));
    }
    return json_response({{"name", device_.name},
                          {"powered", powered_},
                          {"leds", leds()},
                          {"network", network()},
                          {"axes", std::move(axes)},
                          {"last_refusal", refusal({})},
                          {"program", program_}});
  }

 private:
  Json leds() const {
    Json all = Json::array();
    for (const product::Indicator& led : leds_) {
      all.push_back({{"name", led.name},
                     {"colour", led.colour == product::Indicator::Colour::red ? "red" : "green"},
                     {"pattern", powered_ ? to_text(led.pattern) : "off"}});
    }
    return all;
  }

  Json network() const {
    if (network_.machine.empty()) {
      return nullptr;
    }
    return {{"machine", network_.machine},
            {"state", network_state_text(powered_, network_)},
            {"status_code", powered_ ? network_.status_code : 0},
            {"status_text", powered_ ? network_.status_text : ""}};
  }

  Json axis_json(const Axis& axis) const {
    Json json{{"name", axis.name},
              {"machine", nullptr},
              {"state", nullptr},
              {"mode", nullptr},
              {"mode_name", nullptr}};
    if (axis.statusword != nullptr) {
      json["machine"] = "cia402";
      const auto state =
          drive::power_state_of(static_cast<std::uint16_t>(std::lround(axis.statusword_value)));
      json["state"] = !powered_ ? "off" : state ? to_text(*state) : "?";
      json["statusword"] = static_cast<std::uint16_t>(std::lround(axis.statusword_value));
    }
    if (axis.mode != nullptr) {
      const auto code = static_cast<std::int8_t>(std::lround(axis.mode_value));
      json["mode"] = code;
      json["mode_name"] = drive::mode_name(code);
    }
    json["signals"] = axis.signals;
    json["last_refusal"] = refusal(axis.number);
    return json;
  }

  Json refusal(std::optional<std::int64_t> axis) const {
    const EventRecord* event = state_.last_refusal(device_.name, axis);
    return event != nullptr ? to_json(*event) : Json(nullptr);
  }

  const State& state_;
  const DeviceRecord& device_;
  std::vector<Axis> axes_;
  bool powered_ = false;
  bool program_ = false;
  product::Indicators leds_;
  product::NetworkStatus network_;
};

}  // namespace

std::unique_ptr<Job> make_panel_job(const State& state, const DeviceRecord& device) {
  return std::make_unique<PanelJob>(state, device);
}

}  // namespace stator::web
