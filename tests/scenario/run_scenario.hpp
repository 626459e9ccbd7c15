// Reads the text of a scenario, runs it, and gives its result, its first failure or its errors.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/scenario/runner.hpp"
#include "stator/scenario/scenario_file.hpp"

namespace stator::tests {

inline constexpr const char* kModule = "product = \"tmcm-3315\"\n";
inline constexpr const char* kDrive = "product = \"tmcc160\"\n";

/// Reads the text of a scenario, which must be without error, and runs it.
inline scenario::ScenarioResult run_text(const std::string& text) {
  const scenario::ScenarioRead read =
      scenario::parse_scenario(text, "test.toml", devices::products());
  for (const settings::Problem& error : read.errors) {
    ADD_FAILURE() << error.what();
  }
  return scenario::run(read.scenario);
}

/// What its first step that fails says; "passed" if none does.
inline std::string failure_of(const std::string& text) {
  const scenario::ScenarioResult result = run_text(text);
  const scenario::StepResult* failed = result.failed_step();
  return failed != nullptr ? failed->text : std::string(to_text(result.status)) + result.error;
}

/// All errors of a scenario that cannot be read, a line each.
inline std::string errors_of(const std::string& text) {
  std::string lines;
  for (const settings::Problem& error :
       scenario::parse_scenario(text, "test.toml", devices::products()).errors) {
    lines += std::string(error.what()) + "\n";
  }
  return lines;
}

}  // namespace stator::tests
