// stator describe: prints objects, TMCL tables, registers, signals, inputs or quirks of a product
// in several formats.
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/cells.hpp"
#include "stator/cli/commands.hpp"
#include "stator/cli/describe/mfc_listing.hpp"
#include "stator/cli/describe/peripheral_listing.hpp"
#include "stator/cli/describe/register_listing.hpp"
#include "stator/cli/describe/tmcl_module_listing.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/dictionary/description.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/product/catalogue/io_configuration.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/product/device/can_device.hpp"

namespace stator::cli {

namespace {

using dictionary::EntryDescription;

void print_csv(const std::vector<EntryDescription>& rows) {
  print_csv_row(dictionary::kDescriptionColumns);
  for (const EntryDescription& row : rows) {
    print_csv_row(row.columns());
  }
}

void print_json(const std::vector<EntryDescription>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const EntryDescription& row : rows) {
    list.push_back({{"index", row.index},
                    {"subindex", row.subindex},
                    {"name", row.name},
                    {"object_type", row.object_type},
                    {"data_type", row.data_type},
                    {"access", row.access},
                    {"pdo_mapping", row.pdo_mapping},
                    {"default", row.default_value},
                    {"minimum", row.minimum},
                    {"maximum", row.maximum},
                    {"unit", row.unit},
                    {"source", row.source},
                    {"notes", row.notes}});
  }
  fmt::print("{}\n", list.dump(2));
}

void print_markdown(const std::vector<EntryDescription>& rows) {
  fmt::print(
      "| Object | Name | Type | Access | PDO | Default | Range | Unit |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const EntryDescription& row : rows) {
    const std::string range =
        row.minimum.empty() ? "" : fmt::format("{} … {}", row.minimum, row.maximum);
    fmt::print("| {}h:{} | {} | {} | {} | {} | {} | {} | {} |\n", row.index, row.subindex,
               markdown_cell(row.name), row.data_type, row.access, row.pdo_mapping,
               row.default_value, range, markdown_cell(row.unit));
  }
}

void print_table(const std::vector<EntryDescription>& rows) {
  std::size_t name_width = 0;
  for (const EntryDescription& row : rows) {
    name_width = std::max(name_width, row.name.size());
  }
  fmt::print("{:8}  {:{}}  {:14}  {:6}  {:4}  {:>12}  {}\n", "OBJECT", "NAME", name_width, "TYPE",
             "ACCESS", "PDO", "DEFAULT", "UNIT");
  for (const EntryDescription& row : rows) {
    fmt::print("{}h:{}  {:{}}  {:14}  {:6}  {:4}  {:>12}  {}\n", row.index, row.subindex, row.name,
               name_width, row.data_type, row.access, row.pdo_mapping, row.default_value, row.unit);
  }
}

struct DescribeOptions {
  std::string device;
  std::string format = "table";
  std::string preset;
  bool registers = false;
  bool mfc = false;
  bool peripherals = false;
  bool signals = false;
  bool inputs = false;
  bool quirks = false;
  std::string parameters;  ///< of a module with TMCL: axis or global
  bool commands = false;   ///< of a module with TMCL
};

constexpr std::array<std::string_view, 2> kSignalColumns{"signal", "unit"};
constexpr std::array<std::string_view, 4> kInputColumns{"input", "minimum", "maximum", "unit"};

/// Rows of a few cells each; the first is the widest.
template <std::size_t Columns>
void print_names(const std::array<std::string_view, Columns>& header,
                 const std::vector<std::array<std::string, Columns>>& rows,
                 const std::string& format) {
  if (format == "csv") {
    print_csv_row(header);
    for (const auto& row : rows) {
      print_csv_row(row);
    }
    return;
  }
  if (format == "json") {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const auto& row : rows) {
      nlohmann::ordered_json object;
      for (std::size_t i = 0; i < Columns; ++i) {
        object[std::string(header[i])] = row[i];
      }
      list.push_back(object);
    }
    fmt::print("{}\n", list.dump(2));
    return;
  }
  if (format == "markdown") {
    fmt::print("| {} |\n", fmt::join(header, " | "));
    fmt::print("{}|\n", fmt::join(std::vector<std::string_view>(Columns, "|---"), ""));
    for (const auto& row : rows) {
      fmt::print("| {} |\n", fmt::join(row, " | "));
    }
    return;
  }
  for (const auto& row : rows) {
    fmt::print("{:24}  {}\n", row[0], fmt::join(row.begin() + 1, row.end(), "  "));
  }
}

void list_signals(const DescribeOptions& options) {
  std::vector<std::array<std::string, 2>> rows;
  for (const product::Signal& signal : build_product(options.device)->signals()) {
    rows.push_back({signal.name, signal.unit});
  }
  print_names(kSignalColumns, rows, options.format);
}

void list_inputs(const DescribeOptions& options) {
  std::vector<std::array<std::string, 4>> rows;
  for (const product::Input& input : build_product(options.device)->inputs()) {
    rows.push_back({input.name, fmt::format("{}", input.minimum), fmt::format("{}", input.maximum),
                    input.unit});
  }
  print_names(kInputColumns, rows, options.format);
}

constexpr std::array<std::string_view, 4> kQuirkColumns{"quirk", "parameter", "summary", "trap"};

/// "1us to 60s, 100ms if none is given".
std::string parameter_of(const dictionary::QuirkDeclaration& quirk) {
  const auto milliseconds = [](std::int64_t nanoseconds) {
    return fmt::format("{}ms", static_cast<double>(nanoseconds) / 1e6);
  };
  if (std::holds_alternative<base::SimDuration dictionary::Quirks::*>(quirk.member)) {
    return fmt::format("duration up to {}, {} by default", milliseconds(quirk.maximum),
                       milliseconds(quirk.usual));
  }
  if (std::holds_alternative<std::string dictionary::Quirks::*>(quirk.member)) {
    return "text";
  }
  return quirk.maximum == 0
             ? ""
             : fmt::format("{} to {}, {} by default", quirk.minimum, quirk.maximum, quirk.usual);
}

void list_quirks(const DescribeOptions& options) {
  const auto product = find_product(options.device);
  const product::Setup setup = product->defaults();
  if (setup.quirks() == nullptr) {
    throw Failure(
        fmt::format("a {} has no quirks; devices with CoE or CANopen have", options.device));
  }
  const bool canopen = product->identity().network == product::NetworkKind::bus;
  std::vector<std::array<std::string, 4>> rows;
  for (const dictionary::QuirkDeclaration& quirk : dictionary::quirks()) {
    if (canopen ? quirk.canopen : quirk.coe) {
      rows.push_back({std::string(quirk.name), parameter_of(quirk), std::string(quirk.summary),
                      std::string(quirk.trap)});
    }
  }
  print_names(kQuirkColumns, rows, options.format);
}

void list_io_block(const DescribeOptions& options) {
  const auto has_block = [](const product::Product& product) {
    return product.io_configuration() != nullptr;
  };
  if (!has_block(*find_product(options.device))) {
    throw Failure(fmt::format("a {} has no multi-function I/O block; a {} has one", options.device,
                              fmt::join(types_of_products(has_block), " or a ")));
  }
  if (options.mfc) {
    list_mfc_fields(options.format);
  } else {
    list_peripherals(options.format);
  }
}

void describe(const DescribeOptions& options) {
  if (options.mfc || options.peripherals) {
    list_io_block(options);
    return;
  }
  if (options.registers) {
    list_registers(options.device, options.preset, options.format);
    return;
  }
  if (options.signals) {
    list_signals(options);
    return;
  }
  if (options.inputs) {
    list_inputs(options);
    return;
  }
  if (options.quirks) {
    list_quirks(options);
    return;
  }
  if (const tmcl::ModuleDescription* module = find_tmcl_module(options.device)) {
    list_tmcl_module(*module, {options.parameters, options.commands}, options.format);
    return;
  }
  if (!options.parameters.empty() || options.commands) {
    static_cast<void>(tmcl_module(options.device));
  }
  const auto device = build_product(options.device);
  std::vector<EntryDescription> rows;
  if (device->object_dictionary() == nullptr) {
    throw Failure(
        fmt::format("a {} has no object dictionary; --signals and --inputs list what can "
                    "be recorded and set",
                    options.device));
  }
  for (const dictionary::Entry& entry : device->object_dictionary()->entries()) {
    rows.push_back(dictionary::describe(entry));
  }
  if (options.format == "csv") {
    print_csv(rows);
  } else if (options.format == "json") {
    print_json(rows);
  } else if (options.format == "markdown") {
    print_markdown(rows);
  } else {
    print_table(rows);
  }
}

}  // namespace

void add_describe_command(CLI::App& app) {
  auto options = std::make_shared<DescribeOptions>();
  CLI::App* command =
      app.add_subcommand("describe",
                         "Print the object dictionary of a product or its parameters and "
                         "commands, its registers, signals or inputs");
  command
      ->add_option("device", options->device,
                   "Product, see \"stator devices\"; with --registers also tmc8461, tmc8670")
      ->required()
      ->check(names(Names::product));
  command->add_option("--format", options->format, "table, csv, json or markdown")
      ->check(one_of({"table", "csv", "json", "markdown"}))
      ->capture_default_str();
  CLI::Option* registers = command->add_flag("--registers", options->registers,
                                             "The slave controller's registers, field by field");
  command->add_option("--preset", options->preset, "Reading of the device: document or silicon")
      ->needs(registers);
  CLI::Option* mfc =
      command
          ->add_flag(
              "--mfc", options->mfc,
              "Of the tmc8461: the registers of its multi-function I/O block, field by field")
          ->excludes(registers);
  command
      ->add_flag("--peripherals", options->peripherals,
                 "Of the tmc8461: what a rack file can wire to its pins")
      ->excludes(registers)
      ->excludes(mfc);
  CLI::Option* signals =
      command->add_flag("--signals", options->signals, "What of it can be recorded");
  command->add_flag("--inputs", options->inputs, "What around it a rack file's [[event]] can set")
      ->excludes(signals)
      ->excludes(registers);
  command
      ->add_flag("--quirks", options->quirks,
                 "What a rack file can make it do otherwise than it should, to try masters")
      ->excludes(signals)
      ->excludes(registers);
  signals->excludes(registers);
  command
      ->add_option("--parameters", options->parameters,
                   "Of a module with TMCL: only its axis or its global parameters")
      ->check(one_of({"axis", "global"}));
  command->add_flag("--commands", options->commands, "Of a module with TMCL: only its commands");
  command->footer(
      "Examples:\n"
      "  stator describe tmcm-3315 --format csv > objects.csv\n"
      "  stator describe tmcm-3315 --inputs\n"
      "  stator describe tmcm-142 --parameters axis --format csv\n"
      "  stator describe tmc8461 --mfc --format csv\n"
      "  stator describe tmc8670 --registers --preset silicon --format csv");
  command->callback([options] { describe(*options); });
}

}  // namespace stator::cli
