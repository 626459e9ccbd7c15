#pragma once

#include <string_view>

#include <sys/stat.h>

namespace stator::link {

/// What a name stands for that is no regular file, for messages: "a FIFO"; empty if it is one.
/// `mode`: st_mode of stat() or lstat().
[[nodiscard]] inline std::string_view strange_kind(::mode_t mode) {
  switch (mode & S_IFMT) {
    case S_IFREG:
      return {};
    case S_IFDIR:
      return "a directory";
    case S_IFLNK:
      return "a symbolic link";
    case S_IFIFO:
      return "a FIFO";
    case S_IFSOCK:
      return "a socket";
    default:
      return "a device";
  }
}

}  // namespace stator::link
