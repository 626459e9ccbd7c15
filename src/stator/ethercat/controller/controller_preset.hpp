#pragma once

#include <algorithm>
#include <span>
#include <string_view>

#include "stator/ethercat/controller/slave_controller_configuration.hpp"
#include "stator/ethercat/registers/register_table.hpp"

namespace stator::ethercat {

/// A slave controller as it is built into a product, in one reading of the product's documents.
struct ControllerPreset {
  std::string_view name;  ///< which reading, as commands and rack files name it
  std::string_view summary;
  RegisterDocument document = RegisterDocument::controller;
  SlaveControllerConfiguration configuration;
};

/// The preset `name` of a product's, its default, which comes first, if `name` is empty; nullptr if
/// there is none.
[[nodiscard]] constexpr const ControllerPreset* find_preset(
    std::span<const ControllerPreset> presets, std::string_view name = {}) {
  const auto found = std::ranges::find_if(presets, [name](const ControllerPreset& preset) {
    return name.empty() || preset.name == name;
  });
  return found != presets.end() ? &*found : nullptr;
}

}  // namespace stator::ethercat
