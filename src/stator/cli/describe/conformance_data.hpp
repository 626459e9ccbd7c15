#pragma once

#include <span>
#include <string_view>

namespace stator::cli {

/// The lines of two CSV files, headers included, as they were when the program was built.
struct ConformanceTables {
  std::string_view device;
  std::span<const std::string_view> requirements;  ///< id, block, requirement, source
  std::span<const std::string_view> outcomes;      ///< id, status, tests, note
};

/// One for each file in docs/conformance/, by device.
[[nodiscard]] std::span<const ConformanceTables> conformance_tables();

}  // namespace stator::cli
