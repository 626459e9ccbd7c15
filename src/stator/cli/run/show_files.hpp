// The files of the rack that `stator demo --http` runs, as they stand in the repository.
#pragma once

#include <span>
#include <string_view>

namespace stator::cli {

struct ShowFile {
  std::string_view path;  ///< from the root of the repository
  std::string_view text;
};

/// The rack file first. CMake makes it (src/stator/cli/CMakeLists.txt).
[[nodiscard]] std::span<const ShowFile> show_files();

}  // namespace stator::cli
