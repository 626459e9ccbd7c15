#pragma once

#include <cstdint>
#include <string>

#include "stator/master/sdo_types.hpp"

namespace stator::master {

/// `number` in hexadecimal with at least `digits` digits and the field's suffix, e.g. "6041h".
[[nodiscard]] std::string hexadecimal(std::uint64_t number, int digits);

/// How people name an object, e.g. "6041h:00".
[[nodiscard]] std::string to_text(const ObjectAddress& object);

}  // namespace stator::master
