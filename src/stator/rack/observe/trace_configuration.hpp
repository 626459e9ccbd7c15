#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace stator::rack {

/// A logic analyser at the pins of a TMC8461.
struct TraceConfiguration {
  std::string file;                 ///< value change dump to write
  std::string device;               ///< empty: the first one of the rack
  std::vector<std::string> pins{};  ///< "MFCIO00".."MFC_HV7"; empty: those wired to something
  std::size_t queue = std::size_t{1} << 18U;  ///< edges that wait for the disk at most, from 64 on
};

}  // namespace stator::rack
