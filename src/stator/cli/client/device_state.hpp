#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace stator::cli {

/// The state of a device as GET /api/v1/devices lists it, in the word of its own network: "init",
/// "stopped"; "off" without supply, "on" where its network has no states.
[[nodiscard]] std::string state_of_device(const nlohmann::json& device);

}  // namespace stator::cli
