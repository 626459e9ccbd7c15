#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/file/changes.hpp"
#include "stator/scenario/scenario.hpp"
#include "stator/settings/description.hpp"
#include "stator/settings/problem.hpp"
#include "stator/settings/value.hpp"

namespace stator::scenario {

/// What reading a scenario file has shown.
struct ScenarioRead {
  Scenario scenario;                      ///< of use only without errors
  std::vector<settings::Problem> errors;  ///< with file, line, reason and remedy
};

/// Of the schema.
inline constexpr std::string_view kScenarioFileTitle = "Scenario file of Stator";

/// All keys of a scenario file for racks of devices of `catalogue`. Those of a rack in it are told
/// to be those of a rack file.
[[nodiscard]] settings::TableDescription describe_scenario_file(
    const product::Catalogue& catalogue);

/// Reads a scenario file (docs/how-to/scenarios.md) and the rack it names, of devices of
/// `catalogue`, and tells all that is wrong with them. Files named in it are relative to it.
/// `changes` are made before: a path that begins with a key of the scenario ("step[3].target=0") is
/// the scenario's, others are the rack's. Does not throw.
[[nodiscard]] ScenarioRead read_scenario_file(const std::string& path,
                                              const product::Catalogue& catalogue,
                                              rack::Changes changes = {});
/// The same for the text of a scenario file; `name` stands for the file in messages.
[[nodiscard]] ScenarioRead parse_scenario(std::string_view text, const std::string& name,
                                          const product::Catalogue& catalogue,
                                          rack::Changes changes = {});
/// The same for a tree, whoever made it; problems of it name the file `name` where it is not empty.
[[nodiscard]] ScenarioRead read_scenario_tree(settings::Value tree, const std::string& name,
                                              const product::Catalogue& catalogue,
                                              rack::Changes changes = {});
/// The same for the rack `configuration`, which is there already: what the tree says of a rack, its
/// keys "rack", "product" and "cycle", is not read, and changes of a rack are problems.
[[nodiscard]] ScenarioRead read_scenario_tree(settings::Value tree, const std::string& name,
                                              const rack::RackConfiguration& configuration,
                                              rack::Changes changes = {});

}  // namespace stator::scenario
