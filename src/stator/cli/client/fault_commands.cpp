// stator faults, inject, clear: what can go wrong, and lets it.

#include <algorithm>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/client/fault_keys.hpp"
#include "stator/cli/client/rack_client.hpp"
#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/devices/catalogue/fault_consequences.hpp"
#include "stator/rack/faults/fault_kinds.hpp"
#include "stator/web/api/fault_api.hpp"

namespace stator::cli {

namespace {

void print_keys(std::span<const rack::FaultParameter> keys, std::string_view prefix = "") {
  for (const rack::FaultParameter& key : keys) {
    const std::string note = key.needed                  ? " (needed)"
                             : key.default_value.empty() ? ""
                                                         : fmt::format(" ({})", key.default_value);
    fmt::print("  {:22} {}{}\n", fmt::format("{}{}", prefix, key.name), key.summary, note);
  }
}

/// Of the products that this program has.
std::vector<product::FaultConsequence> consequences() {
  std::vector<product::FaultConsequence> all;
  std::ranges::copy_if(devices::fault_consequences(), std::back_inserter(all),
                       [](const product::FaultConsequence& each) {
                         return catalogue().find(std::string(each.product)) != nullptr;
                       });
  return all;
}

void print_consequences(std::string_view kind) {
  bool begun = false;
  for (const product::FaultConsequence& each : consequences()) {
    if (each.kind == kind) {
      fmt::print("{}  {:22} {}\n", begun ? "" : "\nWhat its master sees:\n", each.product,
                 each.consequence);
      begun = true;
    }
  }
}

void print_kind(const rack::FaultKind& kind) {
  fmt::print("{}, of {}: {}.\n{}\n\n", kind.name, with_article(kind.scope), kind.summary,
             kind.effect);
  print_keys(rack::target_keys(kind.scope));
  print_keys(kind.parameters);
  print_keys(rack::common_fault_keys());
  print_keys(rack::milestone_keys(), "when.");
  print_consequences(kind.name);
}

struct FaultsOptions {
  std::string kind;
  std::string format = "text";
};

/// All kinds, or the one of that name, as the web server tells them, and what they come to with the
/// products.
nlohmann::ordered_json json_of_kinds(const std::string& kind) {
  nlohmann::ordered_json all = web::fault_kinds_json();
  nlohmann::ordered_json shown = nlohmann::ordered_json::array();
  for (nlohmann::ordered_json& each : all["kinds"]) {
    if (!kind.empty() && each["name"] != kind) {
      continue;
    }
    each["products"] = nlohmann::ordered_json::object();
    for (const product::FaultConsequence& known : consequences()) {
      if (each["name"] == known.kind) {
        each["products"][std::string(known.product)] = known.consequence;
      }
    }
    shown.push_back(std::move(each));
  }
  all["kinds"] = std::move(shown);
  return all;
}

void run_faults(const FaultsOptions& options) {
  if (options.format == "markdown") {
    fmt::print("{}", rack::fault_kinds_markdown(consequences()));
    return;
  }
  if (!options.kind.empty()) {
    static_cast<void>(fault_of_words(options.kind, {}));  // says what is wrong with the name
  }
  if (options.format == "json") {
    fmt::print("{}\n", json_of_kinds(options.kind).dump(2));
    return;
  }
  if (!options.kind.empty()) {
    print_kind(*rack::find_fault_kind(options.kind));
    return;
  }
  fmt::print("{:18} {:8} {}\n", "KIND", "OF A", "WHAT HAPPENS");
  for (const rack::FaultKind& kind : rack::fault_kinds()) {
    fmt::print("{:18} {:8} {}\n", kind.name, to_text(kind.scope), kind.summary);
  }
}

void add_faults(CLI::App& app) {
  auto options = std::make_shared<FaultsOptions>();
  CLI::App* command = app.add_subcommand("faults", "List what can go wrong on demand");
  command->add_option("kind", options->kind, "Only this kind, with its keys")
      ->check(names(Names::fault_kind));
  command->add_option("--format", options->format, "text, markdown or json")
      ->check(one_of({"text", "markdown", "json"}))
      ->capture_default_str();
  command->callback([options] { run_faults(*options); });
}

struct InjectOptions {
  RackClientOptions client;
  std::string kind;
  std::string device;
  std::vector<std::string> words;
};

void add_inject(CLI::App& app) {
  auto options = std::make_shared<InjectOptions>();
  CLI::App* command =
      app.add_subcommand("inject", "Let something go wrong in a rack that is running");
  add_client_options(*command, options->client);
  command->add_option("kind", options->kind, "What: \"stator faults\" lists all")
      ->required()
      ->check(names(Names::fault_kind));
  command->add_option("--device", options->device, "Name of the device");
  command
      ->add_option("keys", options->words,
                   "KEY=VALUE, as in a [[fault]] of a rack file; \"stator faults KIND\" lists "
                   "them")
      ->check(names(Names::fault_key));
  command->footer(
      "Examples:\n"
      "  stator inject ethercat-drop --device gantry count=5\n"
      "  stator inject link-down --device gantry port=1 for=200ms when.cycles=1000\n"
      "  stator inject mailbox-abort --device gantry code=0x06020000 object=6060:00 count=1\n"
      "The rack must have been started with --http; its token is in STATOR_TOKEN or --http-token.");
  command->callback([options] {
    std::vector<std::string> words = options->words;
    if (!options->device.empty()) {
      words.push_back("device=" + options->device);
    }
    const nlohmann::json fault = fault_of_words(options->kind, words);
    const auto created = RackClient(options->client).post("/api/v1/faults", fault);
    fmt::print("fault {}\n", created.value("id", std::uint64_t{0}));
  });
}

struct ClearOptions {
  RackClientOptions client;
  std::vector<std::uint64_t> ids;
  bool all = false;
};

void add_clear(CLI::App& app) {
  auto options = std::make_shared<ClearOptions>();
  CLI::App* command = app.add_subcommand("clear", "End faults of a rack that is running");
  add_client_options(*command, options->client);
  command->add_option("id", options->ids, "Numbers of faults: \"stator status\" lists them");
  command->add_flag("--all", options->all, "All of them");
  command->callback([options] {
    if (options->all == !options->ids.empty()) {
      throw Failure("say which faults to clear: numbers of \"stator status\", or --all");
    }
    RackClient client(options->client);
    if (options->all) {
      const auto cleared = client.remove("/api/v1/faults");
      fmt::print("{} cleared\n", cleared.value("cleared", std::uint64_t{0}));
      return;
    }
    for (const std::uint64_t id : options->ids) {
      client.remove(fmt::format("/api/v1/faults/{}", id));
      fmt::print("fault {} cleared\n", id);
    }
  });
}

}  // namespace

void add_fault_commands(CLI::App& app) {
  add_faults(app);
  add_inject(app);
  add_clear(app);
}

}  // namespace stator::cli
