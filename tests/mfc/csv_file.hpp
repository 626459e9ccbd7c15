#pragma once

#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "devices/csv.hpp"
#include "source_paths.hpp"

namespace stator::mfc::testing {

/// The rows of a table of the TMC8461's document, cells by column.
inline std::vector<std::map<std::string, std::string>> document_table(const std::string& name) {
  std::ifstream file(STATOR_TEST_DATA "/tmc8461/" + name);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const auto rows = tests::parse_csv(text);
  std::vector<std::map<std::string, std::string>> table;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    auto& row = table.emplace_back();
    for (std::size_t column = 0; column < rows[0].size() && column < rows[i].size(); ++column) {
      row[rows[0][column]] = rows[i][column];
    }
  }
  return table;
}

}  // namespace stator::mfc::testing
