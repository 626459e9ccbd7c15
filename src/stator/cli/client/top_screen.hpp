#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "stator/cli/client/rack_overview.hpp"
#include "stator/cli/terminal.hpp"

namespace stator::cli {

/// What of an overview is on the screen.
struct TopView {
  std::size_t columns = 80;
  std::size_t rows = 0;   ///< 0: as many as there are lines
  std::size_t first = 0;  ///< line of the tables that comes first; kept within them
  std::string filter{};   ///< only rows that contain it
  bool typing = false;    ///< the filter is being typed
  bool paused = false;
  bool help = false;  ///< the keys are shown in place of the tables
};

/// The lines of one frame, each no wider than the screen; tables above, newest events below. Where
/// the tables have no room, that of the axes is the first.
[[nodiscard]] std::vector<StyledLine> top_frame(const RackOverview& overview, const TopView& view);

/// How many lines the tables have; the last of them can come to the top by scrolling.
[[nodiscard]] std::size_t top_table_lines(const RackOverview& overview, const TopView& view);

}  // namespace stator::cli
