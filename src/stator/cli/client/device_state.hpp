#pragma once

#include <functional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace stator::cli {

/// Gets a path of a rack's web server.
using GetJson = std::function<nlohmann::json(const std::string& target)>;

/// The state of a device as GET /api/v1/devices lists it, in the word of its own network: that list
/// has one for all below Safe-Operational, and this asks once more for a device that is there.
/// "on" of a device whose network has no states.
[[nodiscard]] std::string state_of_device(const nlohmann::json& device, const GetJson& get);

}  // namespace stator::cli
