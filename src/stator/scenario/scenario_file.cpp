#include "stator/scenario/scenario_file.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/file/rack_file_steps.hpp"
#include "stator/rack/file/system_files.hpp"
#include "stator/rack/file/table_reader.hpp"
#include "stator/scenario/step_kinds.hpp"
#include "stator/settings/words.hpp"

namespace stator::scenario {

namespace {

using namespace base::literals;
using rack::TableReader;

std::set<std::string> product_types(const product::Catalogue& catalogue) {
  std::set<std::string> types;
  for (const auto& product : catalogue.products()) {
    types.insert(product->identity().type);
  }
  return types;
}

/// The rack under test: a rack file, a product as it leaves its box, or tables of a rack file.
rack::RackConfiguration read_scenario_rack(TableReader& root, const product::Catalogue& catalogue,
                                           rack::Changes changes) {
  const auto product = root.choice(
      {"product", "Instead of a rack: one device as it leaves its box"}, product_types(catalogue));
  if (product) {
    return rack::load_single_device(*product, catalogue, changes);
  }
  if (root.is_table("rack")) {
    auto section = root.section("rack");
    return rack::read_rack(*section, catalogue);
  }
  const auto file = root.text({"rack", "A rack file, or a table with the keys of one"});
  if (!file) {
    root.missing("rack",
                 "a scenario needs a rack file (\"rack\"), a device (\"product\"), or a "
                 "table [rack]");
  }
  return rack::load_rack_file(rack::system_files().beside(root.file(), *file), catalogue, changes);
}

const StepKind* find_kind(const std::string& name) {
  const auto found = std::ranges::find(step_kinds(), name, &StepKind::name);
  return found != step_kinds().end() ? &*found : nullptr;
}

std::set<std::string> kind_names() {
  const std::vector<std::string>& events = rack::EventSectionReader::action_names();
  std::set<std::string> names(events.begin(), events.end());
  for (const StepKind& kind : step_kinds()) {
    names.insert(std::string(kind.name));
  }
  return names;
}

Step read_step(TableReader& section, StepReader& reader) {
  Step step;
  step.line = section.line();
  const auto note = section.text({"note", "What the step is there for, for reports"});
  const std::set<std::string> names = kind_names();
  const bool selected =
      section.select({"do", "What the step does"}, names,
                     "it must be one of: " + settings::joined(names), [&](const std::string& name) {
                       step.kind = name;
                       const StepKind* kind = find_kind(name);
                       ReadStep read = kind != nullptr ? kind->read(section, reader)
                                                       : read_rack_event(section, reader, name);
                       step.looks = kind != nullptr && kind->looks;
                       step.title = note.value_or(read.title);
                       step.action = std::move(read.action);
                       section.finish();
                     });
  if (!selected) {
    TableReader::abandon();
  }
  return step;
}

void read_scenario(TableReader& root, const product::Catalogue& catalogue, rack::Changes changes,
                   Scenario& scenario) {
  scenario.name = root.text({"name", "What the scenario shows, for lists and reports"})
                      .value_or(std::filesystem::path(scenario.file).stem().string());
  root.text({"summary", "What it is good for, for reports"}, scenario.summary);
  std::optional<rack::RackConfiguration> rack;
  root.attempt([&] { rack = read_scenario_rack(root, catalogue, changes); });
  if (rack) {
    scenario.rack = std::move(*rack);
  }
  root.duration({"cycle", "Simulated time per bus cycle, instead of the rack's"}, 50_us, 1_s,
                scenario.rack.cycle);
  root.duration({"limit", "Simulated time after which the scenario has failed"}, 1_ms, kLongestStep,
                scenario.limit);
  root.texts({"plot", "Signals that a report draws, names with * as wild card"}, scenario.plots);
  if (rack) {
    StepReader reader(scenario.rack);
    for (TableReader& step :
         root.sections({"step", "What is done and looked at, one after the other"})) {
      step.attempt([&] { scenario.steps.push_back(read_step(step, reader)); });
    }
    if (root.sections("step").empty()) {
      root.refuse("step", "a scenario needs at least one [[step]]");
    }
    root.finish();
  }
}

/// Makes the changes of the scenario's own keys, and of a rack that stands in it; returns those of
/// a rack that stands elsewhere.
std::vector<std::string> apply_own_changes(rack::Changes changes, settings::Value& tree,
                                           settings::Problems& problems) {
  constexpr std::array<std::string_view, 8> kOwnKeys{"name",  "summary", "product", "rack",
                                                     "cycle", "limit",   "plot",    "step"};
  std::vector<std::string> own;
  std::vector<std::string> others;
  for (const std::string& change : changes) {
    const bool is_own =
        std::ranges::find(kOwnKeys, change.substr(0, change.find_first_of(".[="))) !=
        kOwnKeys.end();
    (is_own ? own : others).push_back(change);
  }
  rack::apply_changes(own, tree, problems);
  auto* const root = tree.find<settings::Table>();
  const auto rack = root->find("rack");
  if (rack != root->end() && rack->second.is<settings::Table>()) {
    rack::apply_changes(others, rack->second, problems);
    others.clear();
  }
  return others;
}

}  // namespace

ScenarioRead parse_scenario(std::string_view text, const std::string& name,
                            const product::Catalogue& catalogue, rack::Changes changes) {
  ScenarioRead read;
  read.scenario.file = name;
  settings::Problems problems;
  problems.everything = true;
  try {
    settings::Value tree = rack::parse_rack_tree(text, name);
    const auto of_rack = apply_own_changes(changes, tree, problems);
    const settings::Reading reading{problems, &rack::system_files(), name};
    TableReader root(reading, "the scenario", tree);
    root.attempt([&] { read_scenario(root, catalogue, of_rack, read.scenario); });
  } catch (const rack::RackFileError& error) {
    problems.list.push_back(error.problem());
  }
  read.errors = std::move(problems.list);
  return read;
}

ScenarioRead read_scenario_file(const std::string& path, const product::Catalogue& catalogue,
                                rack::Changes changes) {
  try {
    return parse_scenario(rack::read_rack_text(path, "scenario file"), path, catalogue, changes);
  } catch (const rack::RackFileError& error) {
    ScenarioRead read;
    read.scenario.file = path;
    read.scenario.name = std::filesystem::path(path).stem().string();
    read.errors.push_back(error.problem());
    return read;
  }
}

}  // namespace stator::scenario
