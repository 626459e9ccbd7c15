#include "stator/cli/describe/tmcl_module_listing.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/cells.hpp"
#include "stator/tmcl/module/module_listing.hpp"

namespace stator::cli {

namespace {

struct Table {
  std::string key;    ///< for programs
  std::string title;  ///< for people
  std::vector<std::string_view> columns;
  std::vector<std::vector<std::string>> rows;
};

template <typename Columns, typename Rows>
Table table_of(std::string key, std::string title, const Columns& columns, const Rows& rows) {
  Table table{std::move(key), std::move(title), {columns.begin(), columns.end()}, {}};
  for (const auto& row : rows) {
    table.rows.emplace_back(row.begin(), row.end());
  }
  return table;
}

std::vector<Table> tables_of(const tmcl::ModuleDescription& module, const ModuleTables& wanted) {
  const bool all = wanted.parameters.empty() && !wanted.commands;
  std::vector<Table> tables;
  if (all || wanted.parameters == "axis") {
    tables.push_back(table_of("axis_parameters", "Axis parameters", tmcl::kAxisParameterColumns,
                              tmcl::list_axis_parameters(module)));
  }
  if (all || wanted.parameters == "global") {
    tables.push_back(table_of("global_parameters", "Global parameters",
                              tmcl::kGlobalParameterColumns, tmcl::list_global_parameters(module)));
  }
  if (all || wanted.commands) {
    tables.push_back(
        table_of("commands", "Commands", tmcl::kCommandColumns, tmcl::list_commands(module)));
  }
  return tables;
}

void print_csv(const std::vector<Table>& tables) {
  for (const Table& table : tables) {
    if (&table != tables.data()) {
      fmt::print("\n");
    }
    print_csv_row(table.columns);
    for (const auto& row : table.rows) {
      print_csv_row(row);
    }
  }
}

void print_json(const std::vector<Table>& tables) {
  nlohmann::ordered_json document;
  for (const Table& table : tables) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const auto& row : table.rows) {
      nlohmann::ordered_json object;
      for (std::size_t i = 0; i < row.size(); ++i) {
        object[std::string(table.columns[i])] = row[i];
      }
      rows.push_back(std::move(object));
    }
    document[table.key] = std::move(rows);
  }
  fmt::print("{}\n", document.dump(2));
}

void print_markdown(const std::vector<Table>& tables) {
  for (const Table& table : tables) {
    fmt::print("{}## {}\n\n| {} |\n", &table == tables.data() ? "" : "\n", table.title,
               fmt::join(table.columns, " | "));
    fmt::print("{}|\n", fmt::join(std::vector<std::string_view>(table.columns.size(), "|---"), ""));
    for (const auto& row : table.rows) {
      std::vector<std::string> cells;
      std::ranges::transform(row, std::back_inserter(cells), markdown_cell);
      fmt::print("| {} |\n", fmt::join(cells, " | "));
    }
  }
}

/// Without the columns that make lines too long for a screen.
bool is_shown(std::string_view column) {
  return column != "source_line" && column != "notes" && column != "reply";
}

void print_table(const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    std::size_t width = table.columns[i].size();
    for (const auto& row : table.rows) {
      width = std::max(width, row[i].size());
    }
    widths.push_back(width);
  }
  const auto print_row = [&](const auto& cells) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (is_shown(table.columns[i])) {
        line += fmt::format("{:{}}  ", cells[i], widths[i]);
      }
    }
    fmt::print("{}\n", line.substr(0, line.find_last_not_of(' ') + 1));
  };
  fmt::print("{}\n", table.title);
  print_row(table.columns);
  for (const auto& row : table.rows) {
    print_row(row);
  }
}

}  // namespace

void list_tmcl_module(const tmcl::ModuleDescription& module, const ModuleTables& tables,
                      const std::string& format) {
  const std::vector<Table> wanted = tables_of(module, tables);
  if (format == "csv") {
    print_csv(wanted);
  } else if (format == "json") {
    print_json(wanted);
  } else if (format == "markdown") {
    print_markdown(wanted);
  } else {
    for (const Table& table : wanted) {
      fmt::print("{}", &table == wanted.data() ? "" : "\n");
      print_table(table);
    }
  }
}

}  // namespace stator::cli
