#include "stator/scenario/scenario_file.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/toml/rack_file_steps.hpp"
#include "stator/rack/toml/toml_section.hpp"
#include "stator/scenario/step_kinds.hpp"

namespace stator::scenario {

namespace {

using namespace base::literals;
using rack::TomlSection;

/// A path in a scenario file is relative to it.
std::string beside(const std::string& file, const std::string& path) {
  return (std::filesystem::path(file).parent_path() / path).lexically_normal().string();
}

std::set<std::string> product_types(const product::Catalogue& catalogue) {
  std::set<std::string> types;
  for (const auto& product : catalogue.products()) {
    types.insert(product->identity().type);
  }
  return types;
}

/// The rack under test: a rack file, a product as it leaves its box, or tables of a rack file.
rack::RackConfiguration read_scenario_rack(TomlSection& root, const product::Catalogue& catalogue) {
  const auto product = root.choice(
      {"product", "Instead of a rack: one device as it leaves its box"}, product_types(catalogue));
  if (product) {
    return rack::single_device_rack(*product, catalogue);
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
  return rack::load_rack_file(beside(root.file(), *file), catalogue);
}

const StepKind* find_kind(const std::string& name) {
  const auto found = std::ranges::find(step_kinds(), name, &StepKind::name);
  return found != step_kinds().end() ? &*found : nullptr;
}

std::set<std::string> kind_names() {
  std::set<std::string> names = rack::EventSectionReader::action_names();
  for (const StepKind& kind : step_kinds()) {
    names.insert(std::string(kind.name));
  }
  return names;
}

Step read_step(TomlSection& section, StepReader& reader) {
  Step step;
  step.line = section.line();
  const auto note = section.text({"note", "What the step is there for, for reports"});
  const auto name = section.selector({"do", "What the step does"}, kind_names());
  if (!name) {
    section.missing("do", fmt::format("it must be one of: {}", fmt::join(kind_names(), ", ")));
  }
  step.kind = *name;
  const StepKind* kind = find_kind(*name);
  ReadStep read =
      kind != nullptr ? kind->read(section, reader) : read_rack_event(section, reader, *name);
  step.looks = kind != nullptr && kind->looks;
  step.title = note.value_or(read.title);
  step.action = std::move(read.action);
  section.finish();
  return step;
}

void read_scenario(TomlSection& root, const product::Catalogue& catalogue, Scenario& scenario) {
  scenario.name = root.text({"name", "What the scenario shows, for lists and reports"})
                      .value_or(std::filesystem::path(scenario.file).stem().string());
  root.text({"summary", "What it is good for, for reports"}, scenario.summary);
  std::optional<rack::RackConfiguration> rack;
  root.attempt([&] { rack = read_scenario_rack(root, catalogue); });
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
    for (TomlSection& step :
         root.sections({"step", "What is done and looked at, one after the other"})) {
      step.attempt([&] { scenario.steps.push_back(read_step(step, reader)); });
    }
    if (root.sections("step").empty()) {
      root.refuse("step", "a scenario needs at least one [[step]]");
    }
    root.finish();
  }
}

}  // namespace

ScenarioRead parse_scenario(std::string_view text, const std::string& name,
                            const product::Catalogue& catalogue) {
  ScenarioRead read;
  read.scenario.file = name;
  rack::RackFileErrors errors;
  try {
    const toml::table table = rack::parse_toml(text, name);
    TomlSection root(name, "the scenario", table, &errors);
    root.attempt([&] { read_scenario(root, catalogue, read.scenario); });
  } catch (const rack::RackFileError& error) {
    errors.list.push_back(error);
  }
  read.errors = std::move(errors.list);
  return read;
}

ScenarioRead read_scenario_file(const std::string& path, const product::Catalogue& catalogue) {
  try {
    return parse_scenario(rack::read_rack_text(path, "scenario file"), path, catalogue);
  } catch (const rack::RackFileError& error) {
    ScenarioRead read;
    read.scenario.file = path;
    read.scenario.name = std::filesystem::path(path).stem().string();
    read.errors.push_back(error);
    return read;
  }
}

}  // namespace stator::scenario
