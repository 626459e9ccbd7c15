#include "stator/cli/describe/register_listing.hpp"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/cells.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/products.hpp"
#include "stator/ethercat/controller/controller_preset.hpp"
#include "stator/ethercat/controller/register_description.hpp"

namespace stator::cli {

namespace {

using ethercat::RegisterDescription;

struct KnownPreset {
  std::string product;
  const ethercat::ControllerPreset* preset;
};

/// Those of all products, the larger controllers first.
std::vector<KnownPreset> known_presets() {
  std::vector<KnownPreset> known;
  for (const auto& product : catalogue().products()) {
    for (const ethercat::ControllerPreset& preset : product->controllers()) {
      known.push_back({product->identity().type, &preset});
    }
  }
  std::ranges::stable_sort(known, std::greater(), [](const KnownPreset& one) {
    return one.preset->configuration.ram_kilobytes;
  });
  return known;
}

const ethercat::ControllerPreset& require_preset(const std::string& device,
                                                 const std::string& name) {
  if (const auto product = catalogue().find(device)) {
    if (const auto* preset = ethercat::find_preset(product->controllers(), name);
        preset != nullptr) {
      return *preset;
    }
  }
  std::string known;
  for (const KnownPreset& each : known_presets()) {
    known += fmt::format("\n  {} --preset {}: {}", each.product, each.preset->name,
                         each.preset->summary);
  }
  throw Failure(fmt::format("there is no slave controller \"{}\"{}; those there are:{}", device,
                            name.empty() ? "" : fmt::format(" with preset \"{}\"", name), known));
}

void print_csv(const std::vector<RegisterDescription>& rows) {
  print_csv_row(ethercat::kRegisterColumns);
  for (const RegisterDescription& row : rows) {
    print_csv_row(row.columns());
  }
}

void print_json(const std::vector<RegisterDescription>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const RegisterDescription& row : rows) {
    nlohmann::ordered_json& object = list.emplace_back(nlohmann::ordered_json::object());
    const auto columns = row.columns();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      object[std::string(ethercat::kRegisterColumns[i])] = columns[i];
    }
  }
  fmt::print("{}\n", list.dump(2));
}

/// Bits as documents write them: "7:0", or "3" for a single one.
std::string bit_range(const RegisterDescription& row) {
  return row.bit_hi == row.bit_lo ? row.bit_hi : fmt::format("{}:{}", row.bit_hi, row.bit_lo);
}

void print_markdown(const std::vector<RegisterDescription>& rows) {
  fmt::print(
      "| Address | Register | Bits | Field | ECAT | PDI | Reset | Notes |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const RegisterDescription& row : rows) {
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} |\n", row.address, markdown_cell(row.name),
               bit_range(row), markdown_cell(row.field), row.access_ecat, row.access_pdi, row.reset,
               markdown_cell(row.notes));
  }
}

void print_table(const std::vector<RegisterDescription>& rows) {
  std::size_t field_width = 0;
  for (const RegisterDescription& row : rows) {
    field_width = std::max(field_width, row.field.size());
  }
  std::string address;
  for (const RegisterDescription& row : rows) {
    if (row.address != address) {
      fmt::print("{}  {}\n", row.address, row.name);
      address = row.address;
    }
    fmt::print("  {:>8}  {:{}}  {:13}  {:9}  {}\n", bit_range(row), row.field, field_width,
               row.access_ecat, row.access_pdi, row.reset);
  }
}

}  // namespace

void list_registers(const std::string& device, const std::string& preset,
                    const std::string& format) {
  const auto rows = ethercat::describe_registers(require_preset(device, preset));
  if (format == "csv") {
    print_csv(rows);
  } else if (format == "json") {
    print_json(rows);
  } else if (format == "markdown") {
    print_markdown(rows);
  } else {
    print_table(rows);
  }
}

}  // namespace stator::cli
