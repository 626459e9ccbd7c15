#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/base/csv.hpp"
#include "stator/cli/cells.hpp"
#include "stator/cli/commands.hpp"
#include "stator/cli/describe/conformance_data.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/settings/words.hpp"

namespace stator::cli {

namespace {

/// Simplified and left out are for good, for the reasons in the notes; open is still to come.
constexpr std::array<std::string_view, 4> kStatuses{"done", "simplified", "left-out", "open"};

constexpr std::string_view kMeaning =
    "Simplified and left out are for good, for the reasons in the notes; open is still to come.";

/// A requirement of a device's document, and what became of it.
struct Conformance {
  std::string id;
  std::string block;
  std::string status;  ///< one of kStatuses
  std::string requirement;
  std::string source;  ///< places in the document
  std::string tests;   ///< separated by semicolons
  std::string note;
};

struct ConformanceOptions {
  std::string device;
  std::string status;
  std::string format = "text";
};

std::vector<Conformance> rows_of(const ConformanceTables& tables) {
  std::map<std::string, std::vector<std::string>> outcomes;
  for (const std::string_view line : tables.outcomes.subspan(1)) {
    std::vector<std::string> cells = csv_fields(line);
    cells.resize(4);
    outcomes[cells[0]] = std::move(cells);
  }
  std::vector<Conformance> rows;
  for (const std::string_view line : tables.requirements.subspan(1)) {
    std::vector<std::string> cells = csv_fields(line);
    cells.resize(4);
    const std::vector<std::string>& outcome = outcomes.at(cells[0]);
    rows.push_back({cells[0], cells[1], outcome[1], cells[2], cells[3], outcome[2], outcome[3]});
  }
  return rows;
}

std::size_t count(const std::vector<Conformance>& rows, std::string_view status) {
  return static_cast<std::size_t>(std::ranges::count(rows, status, &Conformance::status));
}

const ConformanceTables& tables_of(const std::string& device) {
  std::set<std::string> names;
  for (const ConformanceTables& tables : conformance_tables()) {
    if (tables.device == device) {
      return tables;
    }
    names.emplace(tables.device);
  }
  const std::string guess = settings::closest_match(device, names);
  throw Failure(fmt::format("there is no product \"{}\"{}; the products are: {}", device,
                            guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                            fmt::join(names, ", ")));
}

/// How many requirements of each device became what.
void print_summary(const std::string& format) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  if (format == "text") {
    fmt::print("{:12}  {:>12}  {:>6}  {:>10}  {:>8}  {:>4}\n", "DEVICE", "REQUIREMENTS", "DONE",
               "SIMPLIFIED", "LEFT OUT", "OPEN");
  } else if (format == "csv") {
    fmt::print("device,requirements,done,simplified,left-out,open\n");
  }
  for (const ConformanceTables& tables : conformance_tables()) {
    const std::vector<Conformance> rows = rows_of(tables);
    const std::size_t done = count(rows, "done");
    const std::size_t simplified = count(rows, "simplified");
    const std::size_t left_out = count(rows, "left-out");
    const std::size_t open = count(rows, "open");
    if (format == "text") {
      fmt::print("{:12}  {:12}  {:6}  {:10}  {:8}  {:4}\n", tables.device, rows.size(), done,
                 simplified, left_out, open);
    } else if (format == "csv") {
      fmt::print("{},{},{},{},{},{}\n", tables.device, rows.size(), done, simplified, left_out,
                 open);
    } else {
      list.push_back({{"device", tables.device},
                      {"requirements", rows.size()},
                      {"done", done},
                      {"simplified", simplified},
                      {"left-out", left_out},
                      {"open", open}});
    }
  }
  if (format == "json") {
    fmt::print("{}\n", list.dump(2));
  } else if (format == "text") {
    fmt::print("\n{}\n", kMeaning);
  }
}

void print_text(const std::string& device, const std::vector<Conformance>& all,
                const std::vector<Conformance>& shown) {
  fmt::print("{}: {} requirements: {} done, {} open; for good: {} simplified, {} left out\n",
             device, all.size(), count(all, "done"), count(all, "open"), count(all, "simplified"),
             count(all, "left-out"));
  std::string block;
  for (const Conformance& row : shown) {
    if (row.block != block) {
      block = row.block;
      fmt::print("\n{}\n", block);
    }
    fmt::print("  {:14}  {:10}  {} ({})\n", row.id, row.status, row.requirement, row.source);
    if (!row.note.empty()) {
      fmt::print("  {:14}  {:10}  -> {}\n", "", "", row.note);
    }
  }
}

void print_csv(const std::vector<Conformance>& rows) {
  fmt::print("id,block,status,requirement,source,tests,note\n");
  for (const Conformance& row : rows) {
    std::string line;
    for (const std::string* cell :
         {&row.id, &row.block, &row.status, &row.requirement, &row.source, &row.tests, &row.note}) {
      if (cell != &row.id) {
        line += ',';
      }
      base::append_csv_field(line, *cell);
    }
    fmt::print("{}\n", line);
  }
}

void print_json(const std::vector<Conformance>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Conformance& row : rows) {
    nlohmann::ordered_json tests = nlohmann::ordered_json::array();
    std::string_view rest = row.tests;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(';'), rest.size());
      tests.push_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    list.push_back({{"id", row.id},
                    {"block", row.block},
                    {"status", row.status},
                    {"requirement", row.requirement},
                    {"source", row.source},
                    {"tests", std::move(tests)},
                    {"note", row.note}});
  }
  fmt::print("{}\n", list.dump(2));
}

void print_conformance(const ConformanceOptions& options) {
  if (options.device.empty()) {
    if (!options.status.empty()) {
      throw Failure("--status needs a device; without one only numbers are shown");
    }
    print_summary(options.format);
    return;
  }
  const std::vector<Conformance> all = rows_of(tables_of(options.device));
  std::vector<Conformance> shown;
  std::ranges::copy_if(all, std::back_inserter(shown), [&options](const Conformance& row) {
    return options.status.empty() || row.status == options.status;
  });
  if (options.format == "csv") {
    print_csv(shown);
  } else if (options.format == "json") {
    print_json(shown);
  } else {
    print_text(options.device, all, shown);
  }
}

}  // namespace

void add_conformance_command(CLI::App& app) {
  auto options = std::make_shared<ConformanceOptions>();
  CLI::App* command = app.add_subcommand(
      "conformance",
      "Tell which requirements of a product's document are done, simplified or left out for good, "
      "or open, and which tests show it");
  command
      ->add_option("device", options->device,
                   "Product, see \"stator devices\"; without one: numbers of all")
      ->check(names(Names::product));
  command->add_option("--status", options->status, "Only those: done, simplified, left-out or open")
      ->check(one_of(std::vector<std::string>(kStatuses.begin(), kStatuses.end())));
  command->add_option("--format", options->format, "text, csv or json")
      ->check(one_of({"text", "csv", "json"}))
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  stator conformance\n"
      "  stator conformance tmcm-3315 --status simplified\n"
      "  stator conformance tmcc160 --format csv > conformance.csv");
  command->callback([options] { print_conformance(*options); });
}

}  // namespace stator::cli
