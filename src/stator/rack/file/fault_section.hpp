#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/file/table_reader.hpp"
#include "stator/rack/file/target_reader.hpp"

namespace stator::rack {

/// Reads faults: [[fault]] tables of a rack file, and what is asked for while a rack runs. Keys and
/// ranges are those of fault_kinds.hpp.
class FaultReader {
 public:
  /// `rack` must outlive the reader.
  explicit FaultReader(const RackConfiguration& rack) : rack_(rack), targets_(rack) {}

  /// Ends reading for what does not exist or does not fit.
  [[nodiscard]] FaultConfiguration read(TableReader& section);

 private:
  /// The device's name; empty while a table is only described.
  [[nodiscard]] std::string name_of(const TableReader& section, DeviceAddress device) const;
  void read_target(TableReader& section, FaultConfiguration& fault);
  void read_bus_target(TableReader& section, FaultConfiguration& fault);
  void read_line_target(TableReader& section, FaultConfiguration& fault);
  void check_reach(TableReader& section, const FaultConfiguration& fault) const;
  void check_values(TableReader& section, const FaultConfiguration& fault);
  void read_begin(TableReader& section, FaultConfiguration& fault);
  void read_end(TableReader& section, FaultConfiguration& fault) const;
  [[nodiscard]] Milestone read_milestone(TableReader& section, const FaultTarget& target) const;

  const RackConfiguration& rack_;
  TargetReader targets_;
};

/// Reads all [[fault]] tables below `root`. Throws as FaultReader, also for a fault that is to come
/// after one that does not exist.
void read_faults(TableReader& root, RackConfiguration& rack);

/// Reads one fault from the keys of a [[fault]] table. Throws RackFileError with the reason alone,
/// as there is no file.
[[nodiscard]] FaultConfiguration parse_fault(std::string_view text, const RackConfiguration& rack);
/// The same from a table that a program has made.
[[nodiscard]] FaultConfiguration read_fault(const settings::Value& table,
                                            const RackConfiguration& rack);

}  // namespace stator::rack
