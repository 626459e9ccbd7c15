#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/event_text.hpp"
#include "stator/product/catalogue/fault_consequence.hpp"
#include "stator/product/device/input.hpp"

namespace stator::rack {

class FaultEffect;
struct FaultConfiguration;
struct FaultSite;

/// What a fault hits; says which keys name the target.
enum class FaultScope : std::uint8_t {
  port,    ///< a cable at an EtherCAT port, or that of a CAN device: `device`, `port`
  device,  ///< `device`
  bus,     ///< frames of a CAN bus: `bus`, or `device` for those that device sends
  axis,    ///< something around an axis: `device`, `axis`
  line,    ///< a serial line: `line`, or `device` for the one that device is at
};
[[nodiscard]] std::string_view to_text(FaultScope scope);
/// With its article, e.g. "an axis".
[[nodiscard]] std::string with_article(FaultScope scope);

/// The devices a fault can hit.
enum class FaultReach : std::uint8_t {
  any,
  ethercat,           ///< an EtherCAT slave
  ethercat_firmware,  ///< one with firmware of its own
  can,                ///< a device on a CAN bus
};

enum class FaultValueType : std::uint8_t { whole, number, duration, text, choice };
[[nodiscard]] std::string_view to_text(FaultValueType type);

/// A key of a fault. Rack file, command line, REST and documentation follow from it.
struct FaultParameter {
  std::string_view name;
  FaultValueType type = FaultValueType::whole;
  std::string_view unit{};
  double minimum = 0.0;  ///< of numbers; of durations in seconds
  double maximum = 0.0;
  std::string_view default_value{};  ///< as in a rack file without quotes; empty: none
  bool needed = false;
  std::string_view choices{};  ///< of a choice: words separated by spaces
  std::string_view summary{};
};

/// Why a fault cannot happen, and the key that is to blame.
struct FaultProblem {
  std::string key;
  std::string text;
};

/// A kind of fault, declared once. Those of the house are fault_kinds(); a program may inject one
/// of its own.
struct FaultKind {
  base::StaticText name;
  /// Makes what a fault of this kind does. Throws std::runtime_error for what is not there.
  std::unique_ptr<FaultEffect> (*make)(const FaultSite& site, const FaultConfiguration& fault);
  /// Why a fault cannot happen to a device with these inputs; null: there is no such reason.
  std::vector<FaultProblem> (*problems)(const FaultConfiguration& fault,
                                        std::span<const product::InputRange> inputs) = nullptr;
  FaultScope scope;
  FaultReach reach = FaultReach::any;
  /// What `count` counts and `probability` applies to; empty: neither is possible.
  std::string_view counted{};
  bool momentary = false;   ///< it is over as soon as it has begun
  bool of_mailbox = false;  ///< it hits mailbox requests, including the one during which it begins
  std::span<const FaultParameter> parameters{};
  std::string_view summary;
  std::string_view effect;  ///< what the master sees

  [[nodiscard]] const FaultParameter* find(std::string_view parameter) const;
};

/// All kinds, in the order people should see them.
[[nodiscard]] std::span<const FaultKind> fault_kinds();
/// Null: there is none of that name.
[[nodiscard]] const FaultKind* find_fault_kind(std::string_view name);

/// Keys that faults of every kind have: name, begin, end; with a count those of chance.
[[nodiscard]] std::span<const FaultParameter> common_fault_keys();
/// Keys of the table `when`.
[[nodiscard]] std::span<const FaultParameter> milestone_keys();
/// Keys that name the target of a fault of that scope.
[[nodiscard]] std::span<const FaultParameter> target_keys(FaultScope scope);

/// The page docs/faults.md, with what each kind comes to with the products of `consequences`.
[[nodiscard]] std::string fault_kinds_markdown(
    std::span<const product::FaultConsequence> consequences);

}  // namespace stator::rack
