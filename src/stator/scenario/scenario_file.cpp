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
#include "stator/rack/file/rack_file_description.hpp"
#include "stator/rack/file/rack_file_steps.hpp"
#include "stator/rack/file/system_files.hpp"
#include "stator/rack/file/table_reader.hpp"
#include "stator/scenario/step_kinds.hpp"
#include "stator/settings/key.hpp"
#include "stator/settings/words.hpp"

namespace stator::scenario {

namespace {

using namespace base::literals;
using rack::TableReader;
using settings::KeyWords;
using settings::Reader;

/// A scenario file as it is read, key after key: what a key refers to stands above it.
struct File {
  const product::Catalogue* catalogue = nullptr;
  rack::Changes changes{};  ///< of a rack that is not in this file
  Scenario scenario{};
  std::optional<std::string> product{};
  bool has_rack = false;  ///< it was read, or is there already
  std::optional<base::SimDuration> cycle{};
};

void read_product(const KeyWords& key, Reader& reader, File& file) {
  if (file.has_rack) {
    return;
  }
  std::set<std::string> types;
  for (const auto& product : file.catalogue->products()) {
    types.insert(product->identity().type);
  }
  file.product = reader.choice(key, types);
}

/// Reads the rack from a table of the scenario file that has the keys of a rack file.
void read_rack_table(const KeyWords& key, Reader& reader, File& file) {
  auto below = reader.section(key);
  if (reader.describes()) {
    below->note_kind_of_file(rack::kRackFileKind);
    return;
  }
  TableReader table(std::move(*below));
  file.has_rack =
      table.attempt([&] { file.scenario.rack = rack::read_rack(table, *file.catalogue); });
}

/// Reads the rack from the file at `path`, or makes one of the product alone.
void load_rack(Reader& reader, File& file, const std::optional<std::string>& path) {
  try {
    file.scenario.rack =
        path ? rack::load_rack_file(rack::system_files().beside(reader.file(), *path),
                                    *file.catalogue, file.changes)
             : rack::load_single_device(*file.product, *file.catalogue, file.changes);
    file.has_rack = true;
  } catch (const rack::RackFileError& error) {
    reader.problems().list.push_back(error.problem());
  }
}

/// The rack under test: a product as it leaves its box, a rack file, or tables of one.
void read_rack(const KeyWords& key, Reader& reader, File& file) {
  if (file.has_rack) {
    return;
  }
  if (file.product) {
    load_rack(reader, file, std::nullopt);
    return;
  }
  reader.either(
      reader.is_table(key.name),
      [&] {
        if (const auto path = reader.text(key)) {
          load_rack(reader, file, path);
        } else if (!reader.describes()) {
          reader.refuse_missing(key.name,
                                "a scenario needs a rack file (\"rack\"), a device (\"product\"), "
                                "or a table [rack]");
        }
      },
      [&] { read_rack_table(key, reader, file); });
}

Step read_step(TableReader& section, StepReader& reader) {
  Step step;
  step.line = section.line();
  const auto note = section.text({"note", "What the step is there for, for reports"});
  const std::vector<std::string> names = step_names();
  const bool selected =
      section.select({"do", "What the step does"}, names,
                     "it must be one of: " + settings::joined({names.begin(), names.end()}),
                     [&](const std::string& name) {
                       step.kind = name;
                       const auto kind = std::ranges::find(step_kinds(), name, &StepKind::name);
                       const bool is_kind = kind != step_kinds().end();
                       ReadStep read = is_kind ? kind->read(section, reader)
                                               : read_rack_event(section, reader, name);
                       step.looks = is_kind && kind->looks;
                       step.title = note.value_or(read.title);
                       step.action = std::move(read.action);
                       section.finish();
                     });
  if (!selected) {
    TableReader::abandon();
  }
  return step;
}

void read_steps(const KeyWords& key, Reader& reader, File& file) {
  if (!file.has_rack && !reader.describes()) {
    return;
  }
  StepReader steps(file.scenario.rack);
  std::vector<Reader> tables = reader.sections(key);
  for (Reader& each : tables) {
    TableReader table(std::move(each));
    table.attempt([&] { file.scenario.steps.push_back(read_step(table, steps)); });
  }
  if (tables.empty()) {
    reader.refuse(key.name, "a scenario needs at least one [[step]]");
  }
}

constexpr std::array kFileRows{
    settings::text<&File::scenario, &Scenario::name>(
        "name", "What the scenario shows, for lists and reports"),
    settings::text<&File::scenario, &Scenario::summary>("summary",
                                                        "What it is good for, for reports"),
    settings::custom<File, read_product>("product",
                                         "Instead of a rack: one device as it leaves its box"),
    settings::custom<File, read_rack>("rack", "A rack file, or a table with the keys of one"),
    settings::duration<&File::cycle>("cycle", {50_us, 1_s},
                                     "Simulated time per bus cycle, instead of the rack's"),
    settings::duration<&File::scenario, &Scenario::limit>(
        "limit", {1_ms, kLongestStep}, "Simulated time after which the scenario has failed"),
    settings::texts<&File::scenario, &Scenario::plots>(
        "plot", "Signals that a report draws, names with * as wild card"),
    settings::custom<File, read_steps>("step", "What is done and looked at, one after the other")};
constexpr settings::Section<File> kFileKeys{kFileRows};

/// Makes the changes of the scenario's own keys, and of a rack in the scenario file; returns those
/// of a rack in a file of its own.
std::vector<std::string> apply_own_changes(rack::Changes changes, settings::Value& tree,
                                           settings::Problems& problems) {
  std::vector<std::string> own;
  std::vector<std::string> others;
  for (const std::string& change : changes) {
    const std::string key = change.substr(0, change.find_first_of(".[="));
    const bool is_own =
        std::ranges::find(kFileRows, key, &settings::Key<File>::name) != kFileRows.end();
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

void read_file(const settings::Value& tree, const std::string& name, File& file,
               settings::Problems& problems) {
  file.scenario.file = name;
  file.scenario.name = std::filesystem::path(name).stem().string();
  try {
    const settings::Reading reading{problems, &rack::system_files(), name};
    Reader root(reading, "the scenario", tree);
    settings::read_keys(kFileKeys, root, file);
    file.scenario.rack.cycle = file.cycle.value_or(file.scenario.rack.cycle);
    if (file.has_rack) {
      root.finish();
    }
  } catch (const rack::RackFileError& error) {
    problems.list.push_back(error.problem());
  }
}

/// A scenario file of which nothing was read.
ScenarioRead unread(const std::string& file, const rack::RackFileError& error) {
  ScenarioRead read;
  read.scenario.file = file;
  read.errors.push_back(error.problem());
  return read;
}

}  // namespace

settings::TableDescription describe_scenario_file(const product::Catalogue& catalogue) {
  const settings::Value nothing{settings::Table{}};
  settings::TableDescription description;
  settings::Problems problems;  // of tables that are not there
  const settings::Reading reading{problems};
  Reader root(reading, "the scenario", nothing, &description);
  File file{.catalogue = &catalogue};
  settings::read_keys(kFileKeys, root, file);
  return description;
}

ScenarioRead parse_scenario(std::string_view text, const std::string& name,
                            const product::Catalogue& catalogue, rack::Changes changes) {
  try {
    return read_scenario_tree(rack::parse_rack_tree(text, name), name, catalogue, changes);
  } catch (const rack::RackFileError& error) {
    return unread(name, error);
  }
}

ScenarioRead read_scenario_tree(settings::Value tree, const std::string& name,
                                const product::Catalogue& catalogue, rack::Changes changes) {
  File file{.catalogue = &catalogue};
  settings::Problems problems;
  problems.everything = true;
  const auto of_rack = apply_own_changes(changes, tree, problems);
  file.changes = of_rack;
  read_file(tree, name, file, problems);
  return {std::move(file.scenario), std::move(problems.list)};
}

ScenarioRead read_scenario_tree(settings::Value tree, const std::string& name,
                                const rack::RackConfiguration& configuration,
                                rack::Changes changes) {
  File file{.has_rack = true};
  file.scenario.rack = configuration;
  settings::Problems problems;
  problems.everything = true;
  auto* const root = tree.find<settings::Table>();
  for (const char* const key : {"rack", "product", "cycle"}) {
    root->erase(key);
  }
  for (const std::string& change : apply_own_changes(changes, tree, problems)) {
    problems.list.emplace_back(
        fmt::format("--set {}: the rack is there already, so only keys of the scenario can be "
                    "changed; build the rack with this change",
                    change));
  }
  read_file(tree, name, file, problems);
  return {std::move(file.scenario), std::move(problems.list)};
}

ScenarioRead read_scenario_file(const std::string& path, const product::Catalogue& catalogue,
                                rack::Changes changes) {
  try {
    return parse_scenario(rack::read_rack_text(path, "scenario file"), path, catalogue, changes);
  } catch (const rack::RackFileError& error) {
    ScenarioRead read = unread(path, error);
    read.scenario.name = std::filesystem::path(path).stem().string();
    return read;
  }
}

}  // namespace stator::scenario
