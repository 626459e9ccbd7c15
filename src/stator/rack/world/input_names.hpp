#pragma once

#include <span>
#include <string>

#include "stator/product/device/input.hpp"

namespace stator::rack {

/// Why an input called `name` cannot be set to `value`: it does not exist, or the value lies
/// outside its range. Empty: it can.
[[nodiscard]] std::string input_problem(std::span<const product::InputRange> inputs,
                                        const std::string& name, double value);

}  // namespace stator::rack
