#pragma once

#include <string_view>

#include "stator/product/device/indicator.hpp"

namespace stator::web {

/// The state of a device in the word of its own network, "off" without supply; empty: its network
/// has no states.
[[nodiscard]] inline std::string_view network_state_text(bool powered,
                                                         const product::NetworkStatus& status) {
  if (status.machine.empty()) {
    return {};
  }
  return powered ? status.state : "off";
}

}  // namespace stator::web
