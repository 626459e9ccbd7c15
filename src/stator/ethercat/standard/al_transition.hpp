#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "stator/base/event.hpp"
#include "stator/ethercat/standard/al_state.hpp"

namespace stator::ethercat {

/// One elementary step of the EtherCAT state machine.
struct AlStep {
  AlState from;
  AlState to;

  friend constexpr bool operator==(const AlStep&, const AlStep&) = default;
};

namespace al_step {
inline constexpr AlStep kIP{AlState::init, AlState::pre_operational};
inline constexpr AlStep kPI{AlState::pre_operational, AlState::init};
inline constexpr AlStep kPS{AlState::pre_operational, AlState::safe_operational};
inline constexpr AlStep kSP{AlState::safe_operational, AlState::pre_operational};
inline constexpr AlStep kSO{AlState::safe_operational, AlState::operational};
inline constexpr AlStep kOS{AlState::operational, AlState::safe_operational};
inline constexpr AlStep kIB{AlState::init, AlState::bootstrap};
inline constexpr AlStep kBI{AlState::bootstrap, AlState::init};
}  // namespace al_step

/// A change that a master may request, and the steps it is made of.
struct AlTransition {
  std::string_view name;
  AlState from;
  AlState to;
  std::array<AlStep, 3> steps;
  std::size_t step_count;

  [[nodiscard]] constexpr std::span<const AlStep> path() const {
    return std::span(steps).first(step_count);
  }
};

/// Every change the state machine knows (ETG.1000.6 §6.4.1, figure of the ESM). Any other pair of
/// different states is an invalid requested state change.
inline constexpr std::array<AlTransition, 11> kAlTransitions{{
    {"IP", AlState::init, AlState::pre_operational, {al_step::kIP}, 1},
    {"PI", AlState::pre_operational, AlState::init, {al_step::kPI}, 1},
    {"PS", AlState::pre_operational, AlState::safe_operational, {al_step::kPS}, 1},
    {"SP", AlState::safe_operational, AlState::pre_operational, {al_step::kSP}, 1},
    {"SO", AlState::safe_operational, AlState::operational, {al_step::kSO}, 1},
    {"OS", AlState::operational, AlState::safe_operational, {al_step::kOS}, 1},
    {"OP", AlState::operational, AlState::pre_operational, {al_step::kOS, al_step::kSP}, 2},
    {"OI", AlState::operational, AlState::init, {al_step::kOS, al_step::kSP, al_step::kPI}, 3},
    {"SI", AlState::safe_operational, AlState::init, {al_step::kSP, al_step::kPI}, 2},
    {"IB", AlState::init, AlState::bootstrap, {al_step::kIB}, 1},
    {"BI", AlState::bootstrap, AlState::init, {al_step::kBI}, 1},
}};

[[nodiscard]] constexpr const AlTransition* find_transition(AlState from, AlState to) {
  for (const AlTransition& transition : kAlTransitions) {
    if (transition.from == from && transition.to == to) {
      return &transition;
    }
  }
  return nullptr;
}

/// True for a step that needs the slave's consent; the others always happen.
[[nodiscard]] constexpr bool goes_up(AlStep step) {
  return static_cast<int>(step.to) > static_cast<int>(step.from);
}

/// The state a request names, or empty if the number is none.
[[nodiscard]] constexpr std::optional<AlState> to_al_state(unsigned number) {
  switch (static_cast<AlState>(number)) {
    case AlState::init:
    case AlState::pre_operational:
    case AlState::bootstrap:
    case AlState::safe_operational:
    case AlState::operational:
      return static_cast<AlState>(number);
  }
  return std::nullopt;
}

namespace rules {
/// Arguments: {0} state before, {1} state after.
inline constexpr base::EventRule kAlStateChanged{"al-state-changed", base::Severity::information,
                                                 "state {0} -> {1}"};
}  // namespace rules

}  // namespace stator::ethercat
