#include "stator/cli/describe/peripheral_listing.hpp"

#include <array>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/board/peripheral/peripheral_types.hpp"
#include "stator/cli/cells.hpp"

namespace stator::cli {

namespace {

using board::PeripheralType;
using Row = std::array<std::string, 8>;

constexpr std::array<std::string_view, 8> kColumns{"type",    "kind",    "name",    "unit",
                                                   "minimum", "maximum", "default", "description"};

const char* use_of(const board::PinDeclaration& pin) {
  if (pin.optional) {
    return "optional";
  }
  return "needed";
}

std::vector<Row> rows_of(const PeripheralType& type) {
  const std::string name(type.name);
  std::vector<Row> rows;
  for (const board::PinDeclaration& pin : type.pins) {
    rows.push_back({name, "pin", std::string(pin.name), "", "", "", use_of(pin),
                    std::string(pin.description)});
  }
  for (const board::ParameterDeclaration& parameter : type.parameters) {
    if (parameter.is_text) {
      rows.push_back({name, "parameter", std::string(parameter.name), "", "", "",
                      std::string(parameter.text), std::string(parameter.description)});
    } else {
      rows.push_back({name, "parameter", std::string(parameter.name), std::string(parameter.unit),
                      fmt::format("{}", parameter.minimum), fmt::format("{}", parameter.maximum),
                      fmt::format("{}", parameter.value), std::string(parameter.description)});
    }
  }
  for (const board::ConnectionDeclaration& connection : type.connections) {
    rows.push_back({name, "connection", std::string(connection.name), "", "", "",
                    connection.optional ? "optional" : "needed",
                    std::string(connection.description)});
  }
  return rows;
}

void print_json() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PeripheralType* type : board::peripheral_types()) {
    for (const Row& row : rows_of(*type)) {
      nlohmann::ordered_json& object = list.emplace_back(nlohmann::ordered_json::object());
      for (std::size_t i = 0; i < row.size(); ++i) {
        object[std::string(kColumns[i])] = row[i];
      }
    }
  }
  fmt::print("{}\n", list.dump(2));
}

void print_markdown() {
  bool first = true;
  for (const PeripheralType* type : board::peripheral_types()) {
    fmt::print(
        "{}## `{}`\n\n{}.\n\n| Key | Kind | Unit | Range | Default | Meaning |\n"
        "|---|---|---|---|---|---|\n",
        first ? "" : "\n", type->name, type->summary);
    first = false;
    for (const Row& row : rows_of(*type)) {
      const std::string range = row[4].empty() ? "" : fmt::format("{} … {}", row[4], row[5]);
      fmt::print("| `{}` | {} | {} | {} | {} | {} |\n", row[2], row[1], markdown_cell(row[3]),
                 range, markdown_cell(row[6]), markdown_cell(row[7]));
    }
  }
}

void print_table() {
  for (const PeripheralType* type : board::peripheral_types()) {
    fmt::print("{}: {}\n", type->name, type->summary);
    for (const Row& row : rows_of(*type)) {
      fmt::print("  {:10}  {:22}  {:>8}  {}\n", row[1], row[2], row[6],
                 row[3].empty() || row[7].empty() ? row[3] + row[7]
                                                  : fmt::format("{}; {}", row[3], row[7]));
    }
  }
}

}  // namespace

void list_peripherals(const std::string& format) {
  if (format == "csv") {
    print_csv_row(kColumns);
    for (const PeripheralType* type : board::peripheral_types()) {
      for (const Row& row : rows_of(*type)) {
        print_csv_row(row);
      }
    }
  } else if (format == "json") {
    print_json();
  } else if (format == "markdown") {
    print_markdown();
  } else {
    print_table();
  }
}

}  // namespace stator::cli
