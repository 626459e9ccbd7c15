#pragma once

#include <span>
#include <string>

#include "stator/scenario/runner.hpp"

namespace stator::scenario {

/// All results as JUnit XML, which CI systems read: a test suite per scenario, a test case per
/// step. Times are those of the machine for suites and simulated ones for cases, in seconds.
[[nodiscard]] std::string junit_report(std::span<const ScenarioResult> results);

/// All results as one HTML page that needs nothing else: light and dark, curves as SVG.
[[nodiscard]] std::string html_report(std::span<const ScenarioResult> results);

}  // namespace stator::scenario
