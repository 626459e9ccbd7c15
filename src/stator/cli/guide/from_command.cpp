// stator from: a rack file of the files that describe devices, and what became of each file.
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/files.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/imports/resolvers.hpp"
#include "stator/product/catalogue/product.hpp"

namespace stator::cli {

namespace {

using dictionary::ImportKind;
using Json = nlohmann::ordered_json;

struct FromOptions {
  std::vector<std::string> files;
  std::string device;
  std::string output;
  std::string format = "text";
  bool force = false;
};

/// A file, and the device that was made of it.
struct Taken {
  std::string file;
  std::string type;  ///< as the rack file names it
  std::string name;
  imports::ImportedProduct imported;
};

/// In the order in which the table has them.
constexpr std::array kKinds{
    std::pair{ImportKind::known, std::string_view("known from the file")},
    std::pair{ImportKind::assumed, std::string_view("assumed")},
    std::pair{ImportKind::repaired, std::string_view("repaired")},
    std::pair{ImportKind::left_out, std::string_view("left out")},
};
constexpr std::array<std::string_view, kKinds.size()> kKindWords{"known", "assumed", "repaired",
                                                                 "left-out"};

/// The path of `file` as a rack file at `output` names it.
std::string beside(const std::string& file, const std::string& output) {
  const std::filesystem::path folder = std::filesystem::path(output).parent_path();
  return std::filesystem::proximate(file, folder.empty() ? "." : folder).string();
}

Taken take(const std::string& file, const FromOptions& options) {
  const std::string content = read_file(file);
  const auto kind = imports::kind_of(content);
  if (!kind) {
    throw Failure(
        fmt::format("{} is no file of a device: ESI, EDS, DCF or the image of an EEPROM is", file));
  }
  const std::string prefix = std::string(imports::to_text(*kind)) + ":";
  const std::string which = options.device.empty() ? "" : "#" + options.device;
  auto imported = imports::import_product(prefix + file + which);
  if (!imported) {
    const dictionary::ImportError& error = imported.error();
    throw Failure(error.line != 0
                      ? fmt::format("{}:{}: {} [{}]", file, error.line, error.text, error.rule)
                      : fmt::format("{}: {} [{}]", file, error.text, error.rule));
  }
  return {.file = file,
          .type = prefix + beside(file, options.output) + which,
          .name = imported->product->identity().usual_name,
          .imported = std::move(*imported)};
}

void name_apart(std::vector<Taken>& all) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string name = all[i].name;
    int number = 1;
    while (std::any_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(i),
                       [&](const Taken& other) { return other.name == all[i].name; })) {
      all[i].name = fmt::format("{}-{}", name, ++number);
    }
  }
}

bool on_bus(const Taken& each) {
  return each.imported.product->identity().network == product::NetworkKind::bus;
}

std::string quoted(const std::string& text) {
  return Json(text).dump();  // TOML's basic strings have JSON's escapes
}

std::string rack_text(const std::vector<Taken>& all) {
  std::string text = "# Devices of files, made by \"stator from\"; docs/how-to/any-device.md.\n";
  for (const bool bus : {false, true}) {
    bool first = true;
    int node_id = 0;
    for (const Taken& each : all) {
      if (on_bus(each) != bus) {
        continue;
      }
      if (std::exchange(first, false)) {
        text += bus ? "\n[[bus]]\nname = \"can0\"\n" : "\n[[segment]]\n";
      }
      text += bus ? "\n[[bus.device]]\n" : "\n[[segment.device]]\n";
      text += fmt::format("type = {}  # {}\n", quoted(each.type),
                          each.imported.product->identity().summary);
      text += fmt::format("name = {}\n", quoted(each.name));
      if (bus) {
        text += fmt::format("node_id = {}\n", ++node_id);
      }
    }
  }
  return text;
}

std::string table_of(const Taken& taken) {
  std::string text =
      fmt::format("{}: {}\n", taken.file, taken.imported.product->identity().summary);
  for (const auto& [kind, title] : kKinds) {
    bool first = true;
    for (const dictionary::ImportNote& note : taken.imported.report.notes) {
      if (note.kind != kind) {
        continue;
      }
      if (std::exchange(first, false)) {
        text += fmt::format("  {}:\n", title);
      }
      text += note.line != 0
                  ? fmt::format("    line {}: {} [{}]\n", note.line, note.text, note.rule)
                  : fmt::format("    {} [{}]\n", note.text, note.rule);
    }
  }
  return text;
}

Json json_of(const std::vector<Taken>& all, const std::string& rack) {
  Json files = Json::array();
  for (const Taken& each : all) {
    Json notes = Json::array();
    for (const dictionary::ImportNote& note : each.imported.report.notes) {
      notes.push_back({{"kind", kKindWords[static_cast<std::size_t>(note.kind)]},
                       {"line", note.line},
                       {"rule", note.rule},
                       {"text", note.text}});
    }
    files.push_back({{"file", each.file},
                     {"type", each.type},
                     {"name", each.name},
                     {"summary", each.imported.product->identity().summary},
                     {"notes", std::move(notes)}});
  }
  return {{"rack", rack}, {"files", std::move(files)}};
}

void write_from(const FromOptions& options) {
  if (!options.output.empty() && !options.force && std::filesystem::exists(options.output)) {
    throw Failure(
        fmt::format("{} exists; write another file, or this one with --force", options.output));
  }
  std::vector<Taken> all;
  for (const std::string& file : options.files) {
    all.push_back(take(file, options));
  }
  name_apart(all);
  const std::string rack = rack_text(all);
  if (!options.output.empty()) {
    write_output(options.output, rack, false, "a rack file");
  }
  if (options.format == "json") {
    fmt::print("{}\n", json_of(all, rack).dump(2));
    return;
  }
  // What is written to standard output has to be a rack file and nothing else.
  std::FILE* const told = options.output.empty() ? stderr : stdout;
  for (const Taken& each : all) {
    fmt::print(told, "{}", table_of(each));
  }
  if (options.output.empty()) {
    fmt::print("{}", rack);
  } else {
    fmt::print("Wrote {}. Next: stator run {}\n", options.output, options.output);
  }
}

}  // namespace

void add_from_command(CLI::App& app) {
  auto options = std::make_shared<FromOptions>();
  CLI::App* command = app.add_subcommand(
      "from", "Write a rack file of devices that files describe: ESI, EDS, DCF, EEPROM images");
  command->add_option("files", options->files, "Files, one for each device, in their order")
      ->required()
      ->check(names(Names::file));
  command->add_option(
      "--device", options->device,
      "Which device of a file with several: type, name or product code, @ and a revision");
  command->add_option("-o,--output", options->output,
                      "Rack file to write; standard output if left out");
  command->add_option("--format", options->format, "text or json: of what became of the files")
      ->check(one_of({"text", "json"}))
      ->capture_default_str();
  command->add_flag("--force", options->force, "Replace the file if it exists");
  command->callback([options] { write_from(*options); });
}

}  // namespace stator::cli
