#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "stator/base/sim_time.hpp"
#include "stator/rack/faults/fault_kinds.hpp"
#include "stator/rack/world/device_address.hpp"

namespace stator::rack {

using FaultValue = std::variant<std::int64_t, double, base::SimDuration, std::string>;

/// Values of a fault's parameters by name; those without default that were not given are missing.
class FaultValues {
 public:
  void set(std::string_view name, FaultValue value) {
    values_.insert_or_assign(std::string(name), std::move(value));
  }
  [[nodiscard]] bool has(std::string_view name) const { return values_.contains(name); }
  /// `T` must be that of the parameter's type, and the parameter be there.
  template <typename T>
  [[nodiscard]] const T& get(std::string_view name) const {
    return std::get<T>(values_.find(name)->second);
  }
  [[nodiscard]] std::int64_t whole(std::string_view name) const { return get<std::int64_t>(name); }
  template <typename T>
  [[nodiscard]] std::optional<T> find(std::string_view name) const {
    return has(name) ? std::optional<T>(get<T>(name)) : std::nullopt;
  }

 private:
  std::map<std::string, FaultValue, std::less<>> values_;
};

/// What a fault hits; which members count is up to the scope of its kind.
struct FaultTarget {
  std::optional<DeviceAddress> device{};
  unsigned port = 0;
  unsigned axis = 0;
  std::size_t bus = 0;  ///< of FaultScope::bus without a device
  std::string line{};   ///< of FaultScope::line
  std::string text{};   ///< for people: "gantry port 1", "can0"
};

/// An object of a dictionary that a fault or a milestone names.
struct FaultObject {
  std::uint16_t index = 0;
  std::optional<std::uint8_t> subindex{};

  [[nodiscard]] bool matches(std::uint16_t other_index, std::uint8_t other_subindex) const {
    return index == other_index && subindex.value_or(other_subindex) == other_subindex;
  }
};
/// "6060" or "6060:00"; nothing: it is neither.
[[nodiscard]] std::optional<FaultObject> parse_fault_object(std::string_view text);

/// What a fault waits for.
struct Milestone {
  enum class Kind : std::uint8_t {
    cycles,
    message,
    sdo,
    segment,
    frame,
    network_state,
    power_state,
    signal,
  };
  Kind kind = Kind::cycles;
  DeviceAddress device;
  std::uint64_t count = 1;
  std::optional<FaultObject> object{};
  std::uint32_t identifier = 0;
  std::string state{};   ///< of network_state and power_state
  std::string signal{};  ///< within the device
  double value = 0.0;
};

/// A fault as it is asked for. Of `at`, `after` and `when` there is one at most; without them it
/// begins at once.
struct FaultConfiguration {
  const FaultKind* kind = nullptr;
  std::string name{};
  FaultTarget target{};
  FaultValues values{};
  std::optional<base::SimDuration> at{};  ///< after the rack's power-on
  std::string after{};                    ///< name of another fault
  std::optional<Milestone> when{};
  base::SimDuration wait{};
  std::optional<base::SimDuration> duration{};  ///< without it and `count`: until it is cleared
  std::uint64_t count = 0;                      ///< 0: without end
  double probability = 1.0;
  std::uint64_t seed = 1;
  std::string text{};  ///< the keys it was asked for by, of one that is no part of the rack file
};

}  // namespace stator::rack
