// stator test: runs scenarios and reports them as text, JUnit XML or HTML.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/base/name_pattern.hpp"
#include "stator/cli/commands.hpp"
#include "stator/cli/describe/key_reference.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/files.hpp"
#include "stator/cli/option_values.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/progress.hpp"
#include "stator/scenario/event_names.hpp"
#include "stator/scenario/report.hpp"
#include "stator/scenario/runner.hpp"
#include "stator/scenario/scenario_file.hpp"
#include "stator/scenario/step_kinds.hpp"
#include "stator/settings/words.hpp"

namespace stator::cli {

namespace {

using scenario::ScenarioResult;
using scenario::Status;

struct TestOptions {
  std::vector<std::string> paths;
  std::vector<std::string> changes;
  std::string filter = "*";
  std::string junit;
  std::string html;
  bool list = false;
  bool steps = false;
  bool events = false;
  bool verbose = false;
  std::string format = "text";
  KeyOptions keys;
};

constexpr FileKind kScenarioFiles{
    .plural = "scenario files",
    .title = scenario::kScenarioFileTitle,
    .name = "scenario",
    .head =
        "# Keys of a scenario file\n"
        "\n"
        "Every key with the values it takes and what it is when it is left out; made from the "
        "code that reads\n"
        "scenario files by `stator test --reference`. What scenarios are for and what steps do "
        "is told in\n"
        "[scenarios](how-to/scenarios.md). Editors that know JSON schemas check and complete "
        "scenarios by\n"
        "[scenario.schema.json](scenario.schema.json) ([how](rack-file.md#in-an-editor)).\n",
    .describe = scenario::describe_scenario_file};

/// The files, and of folders all that end in .toml, by name.
std::vector<std::string> scenario_files(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      if (entry.path().extension() == ".toml") {
        found.push_back(entry.path().string());
      }
    }
    if (found.empty()) {
      throw Failure(
          fmt::format("{}: no scenario is in this folder; their names end in .toml", path));
    }
    std::ranges::sort(found);
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

ScenarioResult run_read(const scenario::ScenarioRead& read) {
  const auto start = std::chrono::steady_clock::now();
  ScenarioResult result = read.errors.empty() ? scenario::run(read.scenario)
                                              : scenario::unreadable(read.scenario, read.errors);
  result.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

void print_steps(const ScenarioResult& result) {
  for (const scenario::StepResult& step : result.steps) {
    fmt::print("  {:7}  {:12.6f} s  {}:{}: {}{}{}\n", to_text(step.status), step.begin.seconds(),
               step.kind, step.line, step.title, step.text.empty() ? "" : "; ", step.text);
  }
}

void print(const ScenarioResult& result, bool verbose) {
  fmt::print("{:7} {} ({:.3f} s simulated in {:.2f} s)\n", to_text(result.status), result.name,
             result.end.seconds(), result.wall_seconds);
  if (!result.error.empty()) {
    fmt::print("{}\n", result.error);
  }
  if (verbose) {
    print_steps(result);
  }
  if (const scenario::StepResult* failed = result.failed_step()) {
    fmt::print("  {}:{}: {}: {}\n  {}\n", result.file, failed->line, failed->kind, failed->title,
               failed->text);
    for (const std::string& line : result.events) {
      fmt::print("  {}\n", line);
    }
  }
}

using Json = nlohmann::ordered_json;

void print_list(const Json& list) {
  fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

void print_step_kinds(bool as_json) {
  const std::vector<std::string>& actions = rack::EventSectionReader::action_names();
  if (as_json) {
    Json list = Json::array();
    for (const scenario::StepKind& kind : scenario::step_kinds()) {
      list.push_back({{"name", kind.name}, {"summary", kind.summary}});
    }
    for (const std::string& action : actions) {
      list.push_back({{"name", action}, {"summary", "as the action of an [[event]]"}});
    }
    print_list(list);
    return;
  }
  for (const scenario::StepKind& kind : scenario::step_kinds()) {
    fmt::print("{:20} {}\n", kind.name, kind.summary);
  }
  fmt::print("{:20} as the actions of an [[event]] of a rack file\n",
             settings::joined({actions.begin(), actions.end()}));
}

void print_events(bool as_json) {
  const auto names = scenario::event_names();
  if (as_json) {
    print_list(Json(std::vector<std::string>(names.begin(), names.end())));
  } else {
    fmt::print("{}\n", fmt::join(names, "\n"));
  }
}

/// Names and files of the scenarios, nothing run.
void print_scenarios(const TestOptions& options, bool as_json) {
  Json list = Json::array();
  for (const std::string& file : scenario_files(options.paths)) {
    const scenario::ScenarioRead read =
        scenario::read_scenario_file(file, catalogue(), options.changes);
    if (!base::matches(options.filter, read.scenario.name)) {
      continue;
    }
    list.push_back({{"name", read.scenario.name}, {"file", file}});
    if (!as_json) {
      fmt::print("{}  {}\n", read.scenario.name, file);
    }
  }
  if (as_json) {
    print_list(list);
  }
}

void test(const TestOptions& options) {
  const bool as_json = options.format == "json";
  if (options.steps) {
    print_step_kinds(as_json);
    return;
  }
  if (options.events) {
    print_events(as_json);
    return;
  }
  if (options.keys.print(catalogue())) {
    return;
  }
  if (options.paths.empty()) {
    throw Failure("there is nothing to run; name a scenario file or a folder of them");
  }
  if (options.list) {
    print_scenarios(options, as_json);
    return;
  }
  std::vector<ScenarioResult> results;
  const std::vector<std::string> files = scenario_files(options.paths);
  Progress progress("testing");
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string& file = files[i];
    progress.reached(static_cast<double>(i) / static_cast<double>(files.size()));
    const scenario::ScenarioRead read =
        scenario::read_scenario_file(file, catalogue(), options.changes);
    if (!base::matches(options.filter, read.scenario.name)) {
      continue;
    }
    results.push_back(run_read(read));
    progress.clear();
    print(results.back(), options.verbose);
    static_cast<void>(std::fflush(stdout));
  }
  if (!options.junit.empty()) {
    write_file(options.junit, scenario::junit_report(results));
  }
  if (!options.html.empty()) {
    write_file(options.html, scenario::html_report(results));
  }
  const auto passed = static_cast<std::size_t>(
      std::ranges::count(results, Status::passed, &ScenarioResult::status));
  fmt::print("{} of {} scenarios passed\n", passed, results.size());
  if (results.empty()) {
    throw Failure(fmt::format("no scenario is named like \"{}\"", options.filter));
  }
  if (passed != results.size()) {
    throw Failure(fmt::format("{} failed", results.size() - passed));
  }
}

}  // namespace

void add_test_command(CLI::App& app) {
  auto options = std::make_shared<TestOptions>();
  CLI::App* command = app.add_subcommand(
      "test", "Run scenarios: a rack, what a master does, faults, and what must be seen");
  CLI::Option* files =
      command->add_option("files", options->paths, "Scenario files, or folders of them")
          ->check(names(Names::scenario_file));
  add_set_option(*command, options->changes);
  command->add_option("--filter", options->filter, "Only scenarios with such names; * and ?");
  command->add_flag("--list", options->list, "Print names and files only");
  command->add_flag("--steps", options->steps, "Print the kinds of steps there are");
  command->add_flag("--events", options->events, "Print the names of the events there are");
  options->keys.add(*command, files, kScenarioFiles);
  command->add_option("--format", options->format, "Of these lists: text or json")
      ->check(one_of({"text", "json"}))
      ->capture_default_str();
  command->add_flag("--verbose,-v", options->verbose, "Print every step");
  command->add_option("--junit", options->junit, "Write the results as JUnit XML to this file")
      ->check(names(Names::file));
  command->add_option("--html", options->html, "Write them as a page to this file")
      ->check(names(Names::file));
  command->callback([options] { test(*options); });
}

}  // namespace stator::cli
