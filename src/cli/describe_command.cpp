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

#include "cli/commands.hpp"
#include "cli/failure.hpp"
#include "cli/products.hpp"
#include "dictionary/description.hpp"

namespace stator::cli {

namespace {

using dictionary::EntryDescription;

void append_csv_field(std::string& row, std::string_view text) {
  if (text.find_first_of(",\"\n") == std::string_view::npos) {
    row += text;
    return;
  }
  row += '"';
  for (const char c : text) {
    if (c == '"') {
      row += '"';
    }
    row += c;
  }
  row += '"';
}

template <typename Columns>
void print_csv_row(const Columns& columns) {
  std::string row;
  bool first = true;
  for (const std::string_view column : columns) {
    if (!first) {
      row += ',';
    }
    first = false;
    append_csv_field(row, column);
  }
  fmt::print("{}\n", row);
}

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

/// `text` with the character that ends a cell written so that it does not.
std::string markdown_cell(std::string_view text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|') {
      cell += '\\';
    }
    cell += c;
  }
  return cell;
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
};

void describe(const DescribeOptions& options) {
  const auto device = build_product(options.device);
  std::vector<EntryDescription> rows;
  for (const dictionary::Entry& entry : device->dictionary().entries()) {
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
  CLI::App* command = app.add_subcommand("describe", "Print the object dictionary of a product");
  command->add_option("device", options->device, "Product, see \"stator devices\"")->required();
  command->add_option("--format", options->format, "table, csv, json or markdown")
      ->check(CLI::IsMember({"table", "csv", "json", "markdown"}))
      ->capture_default_str();
  command->footer("Example: stator describe tmcm-3315 --format csv > objects.csv");
  command->callback([options] { describe(*options); });
}

}  // namespace stator::cli
