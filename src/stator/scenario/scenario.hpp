#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/rack/core/rack_configuration.hpp"

namespace stator::bench {
class Bench;
}

namespace stator::scenario {

/// What a step came to.
struct Outcome {
  bool passed = true;
  std::string text{};  ///< what was seen; of a step that failed also what was expected
};
[[nodiscard]] inline Outcome pass(std::string seen = {}) {
  return {true, std::move(seen)};
}
[[nodiscard]] inline Outcome fail(std::string text) {
  return {false, std::move(text)};
}

/// What a step does and looks at. May throw bench::TimeLimitReached.
using Action = std::function<Outcome(bench::Bench&)>;

/// One [[step]] of a scenario.
struct Step {
  std::uint32_t line = 0;  ///< of the scenario file, from 1
  std::string kind;        ///< the word behind `do`
  std::string title;       ///< its note, else what it does in words
  bool looks = false;      ///< it only looks, so expectations do not count from it
  Action action;
};

/// A rack, what a master does, what goes wrong, and what must be seen of it.
struct Scenario {
  std::string file;  ///< as it was named
  std::string name;
  std::string summary;
  rack::RackConfiguration rack;
  /// Simulated time after which a scenario that is not at its end has failed.
  base::SimDuration limit{60'000'000'000};
  std::vector<std::string> plots;  ///< signals drawn in a report; names with * as wild card
  std::vector<Step> steps;
};

}  // namespace stator::scenario
