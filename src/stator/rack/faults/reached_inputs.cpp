// Which inputs faults of a kind can set: asked of the kind itself with all keys it can have.
#include "stator/rack/faults/reached_inputs.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "stator/rack/faults/surroundings_faults.hpp"

namespace stator::rack {

namespace {

using Keys = std::vector<std::pair<std::string_view, FaultValue>>;

/// What a key can be that decides which inputs are set; empty: it only says how much.
std::vector<FaultValue> alternatives(const FaultParameter& parameter) {
  std::vector<FaultValue> all;
  if (parameter.type == FaultValueType::whole) {
    const auto most = static_cast<std::int64_t>(parameter.maximum);
    for (auto value = static_cast<std::int64_t>(parameter.minimum); value <= most; ++value) {
      all.emplace_back(value);
    }
  }
  for (std::string_view words = parameter.choices; !words.empty();) {
    const std::size_t end = std::min(words.find(' '), words.size());
    all.emplace_back(std::string(words.substr(0, end)));
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return all;
}

/// Every combination of such keys.
std::vector<Keys> combinations(const FaultKind& kind) {
  std::vector<Keys> all(1);
  for (const FaultParameter& parameter : kind.parameters) {
    const std::vector<FaultValue> values = alternatives(parameter);
    if (values.empty()) {
      continue;
    }
    std::vector<Keys> longer;
    for (const Keys& keys : all) {
      for (const FaultValue& value : values) {
        longer.push_back(keys);
        longer.back().emplace_back(parameter.name, value);
      }
    }
    all = std::move(longer);
  }
  return all;
}

/// A fault with these keys at axis 0, of no size.
FaultConfiguration fault_with(const FaultKind& kind, const Keys& keys) {
  FaultConfiguration fault;
  fault.kind = &kind;
  for (const FaultParameter& parameter : kind.parameters) {
    if (parameter.type == FaultValueType::number) {
      fault.values.set(parameter.name, 0.0);
    }
  }
  for (const auto& [name, value] : keys) {
    fault.values.set(name, value);
  }
  return fault;
}

}  // namespace

std::vector<ReachedInput> inputs_reached_by(const FaultKind& kind) {
  constexpr std::string_view kPeripheral = "peripheral";
  std::vector<ReachedInput> inputs;
  const auto kinds = surroundings_fault_kinds();
  if (std::ranges::none_of(kinds, [&](const FaultKind& each) { return each.name == kind.name; })) {
    return inputs;
  }
  const bool has_peripherals = std::ranges::find(kind.parameters, kPeripheral,
                                                 &FaultParameter::name) != kind.parameters.end();
  for (const bool of_peripheral : {false, true}) {
    if (of_peripheral && !has_peripherals) {
      break;
    }
    const std::string owner = std::string(of_peripheral ? kPeripheral : "axis0") + ".";
    for (const Keys& keys : combinations(kind)) {
      FaultConfiguration fault = fault_with(kind, keys);
      if (of_peripheral) {
        fault.values.set(kPeripheral, std::string(kPeripheral));  // called so here
      }
      for (FaultSetting& setting : settings_of(fault, std::nullopt)) {
        std::string name = std::move(setting.input);
        if (name.starts_with(owner)) {
          name.erase(0, owner.size());
        }
        if (std::ranges::none_of(inputs, [&](const ReachedInput& each) {
              return each.name == name && each.of_peripheral == of_peripheral;
            })) {
          inputs.push_back({std::move(name), of_peripheral, keys});
        }
      }
    }
  }
  return inputs;
}

}  // namespace stator::rack
