#include "stator/rack/kept/directory_place.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

namespace stator::rack {

std::string displacement(int directory, const std::string& path) {
  struct stat opened {};
  struct stat named {};
  const bool open = ::fstat(directory, &opened) == 0;
  if (open && ::stat(path.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
      opened.st_ino == named.st_ino) {
    return {};
  }
  return fmt::format("has been {} since the rack was started",
                     !open || opened.st_nlink == 0 ? "removed" : "moved away");
}

}  // namespace stator::rack
