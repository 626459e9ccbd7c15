#include "stator/link/system/path_lock.hpp"

#include <cerrno>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stator/link/system/failure.hpp"

namespace stator::link {

base::Expected<PathLock, LinkError> PathLock::take(const std::string& path) {
  const std::string file = path + ".lock";
  constexpr int kFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW;
  constexpr mode_t kMode = 0644;
  while (true) {
    // Two steps, since systems that protect files in /tmp let nobody open those of others with
    // O_CREAT.
    bool left_behind = true;
    FileDescriptor descriptor(::open(file.c_str(), kFlags));
    if (!descriptor.is_open() && errno == ENOENT) {
      left_behind = false;
      descriptor = FileDescriptor(::open(file.c_str(), kFlags | O_CREAT | O_EXCL, kMode));
      if (!descriptor.is_open() && errno == EEXIST) {
        continue;
      }
    }
    if (!descriptor.is_open()) {
      return system_failure("cannot open " + in_quotes(file) + ", which keeps " + in_quotes(path) +
                                " for this process",
                            errno);
    }
    if (::flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EINTR) {
        continue;
      }
      if (errno == EWOULDBLOCK) {
        return fail(LinkErrorCode::address_in_use, "another process serves " + in_quotes(path) +
                                                       "; end it, or choose another path");
      }
      return system_failure("cannot lock " + in_quotes(file), errno);
    }
    PathLock lock(file, std::move(descriptor), left_behind);
    if (lock.is_in_place()) {
      return lock;
    }
    // Its holder has removed it between our opening and locking it.
    lock.descriptor_ = FileDescriptor();
  }
}

PathLock& PathLock::operator=(PathLock&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(left_behind_, other.left_behind_);
  descriptor_ = std::move(other.descriptor_);
  return *this;
}

PathLock::~PathLock() {
  // Removed while still locked, so that no other process can hold a lock on the removed file.
  if (descriptor_.is_open() && is_in_place()) {
    ::unlink(file_.c_str());
  }
}

bool PathLock::is_in_place() const {
  struct stat held {};
  struct stat named {};
  return ::fstat(descriptor_.get(), &held) == 0 && ::lstat(file_.c_str(), &named) == 0 &&
         held.st_dev == named.st_dev && held.st_ino == named.st_ino;
}

}  // namespace stator::link
