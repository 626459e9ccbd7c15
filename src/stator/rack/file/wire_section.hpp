#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "stator/product/device/input.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/file/table_reader.hpp"

namespace stator::rack {

/// Reads the [[wire]] tables of a rack file against the devices and events that stand in it.
class WireSectionReader {
 public:
  /// `rack` must outlive the reader.
  explicit WireSectionReader(const RackConfiguration& rack) : rack_(rack) {}

  /// Reads one [[wire]]. Ends reading for a device, signal or input that is not in the
  /// rack, for an input that has a wire or an event, and for wires that form a ring.
  [[nodiscard]] WireConfiguration read(TableReader& section);

 private:
  /// An end of a wire: "device.name".
  struct End {
    DeviceAddress device;
    std::string name;

    friend auto operator<=>(const End&, const End&) = default;
  };
  /// Signals and inputs of a device that was made only to be asked for them.
  struct Terminals {
    std::set<std::string> signals;
    std::vector<product::InputRange> inputs;
  };

  [[nodiscard]] End read_end(TableReader& section, const std::string& key) const;
  [[nodiscard]] const Terminals& terminals_of(DeviceAddress address);
  /// The input at the end `to`; ends reading unless that input and the signal `from` exist. Empty
  /// while a table is only described.
  [[nodiscard]] product::InputRange input_between(TableReader& section, const End& from,
                                                  const End& to);
  void read_levels(TableReader& section, const product::InputRange& input, WireConfiguration& wire);
  void check_driver(TableReader& section, const End& from, const End& to);

  const RackConfiguration& rack_;
  std::map<DeviceAddress, Terminals> terminals_;
  std::map<End, End> drivers_;  ///< of each wired input the signal
};

}  // namespace stator::rack
