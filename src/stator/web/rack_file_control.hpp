#pragma once

#include <string>
#include <vector>

#include "stator/base/expected.hpp"

namespace stator::web {

/// The rack file of a running rack, as whoever runs it offers it to the server. For the server's
/// thread.
class RackFileControl {
 public:
  struct File {
    std::string path{};                  ///< empty: there is none
    std::string text{};                  ///< when the run began
    std::vector<std::string> changes{};  ///< made to it before it was read, as --set has them
    std::string fixed{};                 ///< why no other rack can be run instead; empty: one can
    std::string refusal{};  ///< why the rack that was asked for last does not run; empty: it does
  };

  RackFileControl() = default;
  RackFileControl(const RackFileControl&) = delete;
  RackFileControl& operator=(const RackFileControl&) = delete;
  virtual ~RackFileControl() = default;

  [[nodiscard]] virtual File file() = 0;
  /// Keeps `text` in a new file beside the present one, and has the run end and go on with the rack
  /// it describes, which check_rack_text() has found good; with the present one if that cannot
  /// start. The path of the new file, or why not.
  virtual base::Expected<std::string, std::string> replace(const std::string& text) = 0;
};

}  // namespace stator::web
