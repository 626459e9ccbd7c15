#include "stator/cli/client/device_state.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace stator::cli {

namespace {

constexpr std::string_view kAnyLowState = "pre-operational or below";
constexpr const char* kWithoutStates = "on";

char small_letter(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

std::string state_of_device(const nlohmann::json& device, const GetJson& get) {
  std::string state = device.at("state");
  if (state != kAnyLowState) {
    return state;
  }
  const nlohmann::json panel =
      get(fmt::format("/api/v1/devices/{}/panel", device.at("name").get<std::string>()));
  const nlohmann::json& network = panel.at("network");
  if (network.is_null()) {
    return kWithoutStates;
  }
  state = network.at("state");
  std::ranges::transform(state, state.begin(), small_letter);
  return state;
}

}  // namespace stator::cli
