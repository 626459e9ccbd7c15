#pragma once

#include <set>
#include <string>
#include <vector>

#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/file/table_reader.hpp"
#include "stator/rack/file/target_reader.hpp"

namespace stator::rack {

/// Reads the [[event]] tables of a rack file against the segments and buses that stand in it.
class EventSectionReader {
 public:
  /// `rack` must outlive the reader.
  explicit EventSectionReader(const RackConfiguration& rack) : rack_(rack), targets_(rack) {}

  /// Reads one [[event]], its time, its action and what the action acts upon, and appends what it
  /// makes happen. Ends reading for a device, port, cable or input that is not in the rack.
  void read(TableReader& section, std::vector<EventConfiguration>& events);
  /// Reads an action from a table that has keys of its own for which `action`, one of
  /// action_names(), and when it happens: `at` after the rack's power-on. Does not report unknown
  /// keys.
  void read_action(TableReader& section, const std::string& action, base::SimDuration at,
                   std::vector<EventConfiguration>& events);
  /// What can happen.
  [[nodiscard]] static const std::vector<std::string>& action_names();

 private:
  [[nodiscard]] RackEvent read_cable(TableReader& section, bool intact) const;
  [[nodiscard]] RackEvent read_frame_fault(TableReader& section, const std::string& action) const;
  [[nodiscard]] RackEvent read_segment_fault(TableReader& section, DeviceAddress target,
                                             const std::string& action) const;
  void read_set(TableReader& section, base::SimDuration at,
                std::vector<EventConfiguration>& events);

  const RackConfiguration& rack_;
  TargetReader targets_;
};

}  // namespace stator::rack
