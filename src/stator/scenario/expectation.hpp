// Expectations: steps that act on nothing and check what is seen, at once, within a time, or for a
// time.
#pragma once

#include <array>
#include <functional>
#include <string>

#include "stator/base/sim_time.hpp"
#include "stator/bench/bench.hpp"
#include "stator/master/master.hpp"
#include "stator/scenario/step_reader.hpp"
#include "stator/settings/key.hpp"

namespace stator::scenario {

/// What one look has shown.
struct Look {
  bool met = false;
  std::string seen;
};
using Probe = std::function<Look(bench::Bench&)>;

/// When what is expected must be so.
struct Timing {
  base::SimDuration within;  ///< it must become so in this time; 0: it must be so at once
  base::SimDuration hold;    ///< from then on it must be so for this time
};
inline constexpr std::array kTimingRows{
    settings::duration<&Timing::within>("within", kStepTimes,
                                        "It must become so within this time; without it: at once"),
    settings::duration<&Timing::hold>("for", kStepTimes,
                                      "From then on it must stay so for this time")};
inline constexpr settings::Section<Timing> kTimingKeys{kTimingRows};

/// The key "absent" of steps that expect something that comes.
template <auto... Path>
constexpr auto absent_key() {
  return settings::boolean<Path...>("absent", "It must not be there");
}

/// The step that looks with `probe` when `timing` says. `expected` is what it looks for, in words.
[[nodiscard]] ReadStep expectation(const std::string& expected, const Timing& timing,
                                   const Probe& probe);

/// The master could not look, for the reason it tells.
template <typename T>
Look not_seen(const master::Result<T>& result) {
  return {false, result.error().text};
}

}  // namespace stator::scenario
