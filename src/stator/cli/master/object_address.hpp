#pragma once

#include <string>

#include "stator/master/sdo_types.hpp"

namespace stator::cli {

/// Reads "6041", "6041h", "6041:00", "6041h:00" or "0x6041:0"; all numbers are hexadecimal. Throws
/// Failure naming the form it expects.
[[nodiscard]] master::ObjectAddress parse_object_address(const std::string& text);

}  // namespace stator::cli
