#pragma once

#include <string>

namespace stator::rack {

/// What has happened to an open `directory` if `path` does not name it any more, as who finds it
/// there: "has been removed since the rack was started"; empty: nothing.
[[nodiscard]] std::string displacement(int directory, const std::string& path);

}  // namespace stator::rack
