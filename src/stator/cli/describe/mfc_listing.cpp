#include "stator/cli/describe/mfc_listing.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/cells.hpp"
#include "stator/mfc/block/memory_map.hpp"
#include "stator/mfc/pins/signal.hpp"
#include "stator/mfc/registers/register_description.hpp"

namespace stator::cli {

namespace {

using mfc::FieldDescription;

std::string bit_range(const FieldDescription& row) {
  return row.bit_hi == row.bit_lo ? row.bit_hi : fmt::format("{}:{}", row.bit_hi, row.bit_lo);
}

void print_json(const std::vector<FieldDescription>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const FieldDescription& row : rows) {
    nlohmann::ordered_json& object = list.emplace_back(nlohmann::ordered_json::object());
    const auto columns = row.columns();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      object[std::string(mfc::kFieldColumns[i])] = columns[i];
    }
  }
  fmt::print("{}\n", list.dump(2));
}

void print_markdown(const std::vector<FieldDescription>& rows) {
  fmt::print(
      "| No. | Address | Register | Bits | Field | ECAT | MFC CTRL SPI | Range | Reset | Notes |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const FieldDescription& row : rows) {
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", row.number,
               row.mfc_spi_address, row.name, bit_range(row), row.field, row.access_ecat,
               row.access_pdi, markdown_cell(row.range), row.reset, markdown_cell(row.notes));
  }
}

void print_table(const std::vector<FieldDescription>& rows) {
  std::size_t width = 0;
  for (const FieldDescription& row : rows) {
    width = std::max(width, row.field.size());
  }
  std::string number;
  for (const FieldDescription& row : rows) {
    if (row.number != number) {
      fmt::print("{:>2}  {}  {}\n", row.number, row.mfc_spi_address, row.name);
      number = row.number;
    }
    fmt::print("  {:>8}  {:{}}  {:4}  {:4}  {}\n", bit_range(row), row.field, width,
               row.access_ecat, row.access_pdi, row.reset);
  }
}

constexpr std::array<std::string_view, 6> kMapColumns{"address", "number",    "register",
                                                      "size",    "direction", "trigger"};

std::vector<std::array<std::string, 6>> map_rows(const mfc::Configuration& configuration) {
  std::vector<std::array<std::string, 6>> rows;
  const mfc::MemoryMap map(configuration);
  for (const unsigned block : {0U, 1U}) {
    for (const mfc::MappedRegister& mapped : map.registers(block)) {
      rows.push_back({fmt::format("0x{:04X}", mapped.address), std::to_string(mapped.number),
                      std::string(mfc::kRegisters[mapped.number].name), std::to_string(mapped.size),
                      block == 0 ? "write" : "read",
                      std::string(mfc::kTriggerNames[static_cast<std::size_t>(mapped.trigger)])});
    }
  }
  return rows;
}

/// What is at the pins, "MFCIO04" and the name of its signal, in their order.
std::vector<std::pair<std::string_view, std::string_view>> used_pins(
    const mfc::Configuration& configuration) {
  std::vector<std::pair<std::string_view, std::string_view>> pins;
  for (std::size_t line = 0; line < mfc::kLines; ++line) {
    const std::uint8_t code = configuration.signal(line);
    if (code != 0 && code < mfc::kSignals) {
      pins.emplace_back(mfc::kLineNames[line], mfc::describe(static_cast<mfc::Signal>(code)).name);
    }
  }
  return pins;
}

void print_map_as_json(const std::vector<std::array<std::string, 6>>& rows,
                       const mfc::Configuration& configuration) {
  nlohmann::ordered_json map{{"registers", nlohmann::ordered_json::array()},
                             {"pins", nlohmann::ordered_json::object()}};
  for (const auto& row : rows) {
    nlohmann::ordered_json& object = map["registers"].emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) {
      object[std::string(kMapColumns[i])] = row[i];
    }
  }
  for (const auto& [pin, signal] : used_pins(configuration)) {
    map["pins"][std::string(pin)] = signal;
  }
  fmt::print("{}\n", map.dump(2));
}

}  // namespace

void list_mfc_fields(const std::string& format) {
  const auto rows = mfc::describe_fields();
  if (format == "csv") {
    print_csv_row(mfc::kFieldColumns);
    for (const FieldDescription& row : rows) {
      print_csv_row(row.columns());
    }
  } else if (format == "json") {
    print_json(rows);
  } else if (format == "markdown") {
    print_markdown(rows);
  } else {
    print_table(rows);
  }
}

void print_mfc_map(const mfc::Configuration& configuration, const std::string& format) {
  const auto rows = map_rows(configuration);
  if (format == "csv") {
    print_csv_row(kMapColumns);
    for (const auto& row : rows) {
      print_csv_row(row);
    }
    return;
  }
  if (format == "json") {
    print_map_as_json(rows, configuration);
    return;
  }
  fmt::print("{:8}  {:>3}  {:22}  {:>4}  {:9}  {}\n", "ADDRESS", "NO.", "REGISTER", "SIZE",
             "DIRECTION", "TRIGGER");
  for (const auto& row : rows) {
    fmt::print("{:8}  {:>3}  {:22}  {:>4}  {:9}  {}\n", row[0], row[1], row[2], row[3], row[4],
               row[5]);
  }
  fmt::print("\n{:8}  {}\n", "PIN", "SIGNAL");
  for (const auto& [pin, signal] : used_pins(configuration)) {
    fmt::print("{:8}  {}\n", pin, signal);
  }
}

}  // namespace stator::cli
