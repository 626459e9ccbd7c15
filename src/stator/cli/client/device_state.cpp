#include "stator/cli/client/device_state.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace stator::cli {

namespace {

char small_letter(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

std::string state_of_device(const nlohmann::json& device) {
  const nlohmann::json& network = device.at("network_state");
  if (network.is_null()) {
    return device.at("powered").get<bool>() ? "on" : "off";
  }
  std::string state = network;
  std::ranges::transform(state, state.begin(), small_letter);
  return state;
}

}  // namespace stator::cli
