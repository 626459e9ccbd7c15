#pragma once

#include <string>
#include <utility>

#include "stator/base/expected.hpp"
#include "stator/link/system/error.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

/// Keeps a path for this process: an empty file beside it, "PATH.lock", on which the process holds
/// a lock. The system takes the lock back however the process ends; the file goes with the object
/// and outlives only a process that was killed.
class PathLock {
 public:
  /// LinkErrorCode::address_in_use: another process, or another object of this one, holds it.
  static base::Expected<PathLock, LinkError> take(const std::string& path);
  PathLock() = default;
  PathLock(PathLock&& other) noexcept { *this = std::move(other); }
  PathLock& operator=(PathLock&& other) noexcept;
  ~PathLock();

  /// The file was there already: a process that held the lock was killed.
  [[nodiscard]] bool was_left_behind() const { return left_behind_; }

 private:
  PathLock(std::string file, FileDescriptor descriptor, bool left_behind)
      : file_(std::move(file)), descriptor_(std::move(descriptor)), left_behind_(left_behind) {}

  [[nodiscard]] bool is_in_place() const;

  std::string file_;
  FileDescriptor descriptor_;  ///< not open: nothing is held
  bool left_behind_ = false;
};

}  // namespace stator::link
