#include "stator/rack/toml/output_file.hpp"

#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

namespace stator::rack {

std::string output_problem(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path file(path);
  if (std::filesystem::is_directory(file, ignored)) {
    return fmt::format("cannot write {}: it is a directory; name a file in it", path);
  }
  // An existing file is opened for writing, of another one the directory gets an entry.
  const bool exists = std::filesystem::exists(file, ignored);
  const std::filesystem::path parent =
      file.parent_path().empty() ? std::filesystem::path(".") : file.parent_path();
  const int access = exists ? ::access(file.c_str(), W_OK) : ::access(parent.c_str(), W_OK | X_OK);
  if (access == 0) {
    return {};
  }
  return fmt::format(
      "cannot write {}: {}; choose a file in a directory that exists and can be written", path,
      std::generic_category().message(errno));
}

}  // namespace stator::rack
