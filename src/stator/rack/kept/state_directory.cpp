#include "stator/rack/kept/state_directory.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include "stator/link/system/file_kind.hpp"
#include "stator/rack/kept/directory_place.hpp"

namespace stator::rack {

namespace {

constexpr const char* kLock = "lock";
constexpr const char* kTemporary = ".new";
constexpr std::size_t kReadAtOnce = 65536;

std::string reason(int error) {
  return std::generic_category().message(error);
}

void require(bool done) {
  if (!done) {
    throw std::system_error(errno, std::generic_category());
  }
}

void write_all(int file, std::span<const std::byte> bytes, off_t place) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file, bytes.data(), bytes.size(), place);
    require(written >= 0 || errno == EINTR);
    const auto done = static_cast<std::size_t>(std::max<ssize_t>(written, 0));
    bytes = bytes.subspan(done);
    place += static_cast<off_t>(done);
  }
}

void require_regular(const std::string& path, const struct stat& file, const char* remedy) {
  if (const std::string_view kind = link::strange_kind(file.st_mode); !kind.empty()) {
    throw std::runtime_error(
        fmt::format("{}: it is {}, where a regular file is expected; {}", path, kind, remedy));
  }
}

StateDirectory::FileStamp stamp_of(const struct stat& file) {
  return {file.st_dev, file.st_ino, static_cast<std::uint64_t>(file.st_size),
          std::int64_t{file.st_ctim.tv_sec} * 1'000'000'000 + file.st_ctim.tv_nsec};
}

StateDirectory::FileStamp stamp_of(const link::FileDescriptor& file) {
  struct stat status {};
  require(::fstat(file.get(), &status) == 0);
  return stamp_of(status);
}

/// False: another process has it. A rack that was killed a moment ago may still hold the lock until
/// the system has cleared it up. A file system without locks of this kind of file refuses none.
bool take_lock(int file) {
  using namespace std::chrono_literals;
  const auto end = std::chrono::steady_clock::now() + 500ms;
  while (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) {
      return true;
    }
    if (std::chrono::steady_clock::now() >= end) {
      return false;
    }
    std::this_thread::sleep_for(10ms);
  }
  return true;
}

}  // namespace

StateDirectory::StateDirectory(const std::string& path, Use use) : use_(use), path_(path) {
  if (use == Use::own && ::mkdir(path.c_str(), 0755) != 0 && errno != EEXIST) {
    throw std::runtime_error(
        fmt::format("{}: cannot create the state directory: {}; create it, or name another one",
                    path, reason(errno)));
  }
  directory_ = link::FileDescriptor(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (use == Use::look && directory_.is_open()) {
    return;
  }
  if (directory_.is_open()) {
    constexpr const char* kLockRemedy = "delete it, an empty file takes its place";
    struct stat found {};
    if (::fstatat(directory_.get(), kLock, &found, AT_SYMLINK_NOFOLLOW) == 0) {
      require_regular(path_of(kLock), found, kLockRemedy);
    }
    lock_ = link::FileDescriptor(::openat(
        directory_.get(), kLock, O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644));
  }
  if (!lock_.is_open()) {
    throw std::runtime_error(
        fmt::format("{}: cannot use the state directory: {}; it must be a directory this user may "
                    "write to",
                    path, reason(errno)));
  }
  // The directory itself is what counts, since the file can be deleted; that is for racks of
  // earlier versions, and for file systems that lock no directories.
  if (!take_lock(directory_.get()) || !take_lock(lock_.get())) {
    throw std::runtime_error(fmt::format(
        "{}: the state directory is in use by another rack; end that one or name another directory",
        path));
  }
  // Files that a killed process has renamed a moment ago may be appended to from now on.
  static_cast<void>(::fsync(directory_.get()));
}

void StateDirectory::require_short(const std::string& name) const {
  const long limit = ::fpathconf(directory_.get(), _PC_NAME_MAX);
  const std::size_t longest = limit > 0 ? static_cast<std::size_t>(limit) : NAME_MAX;
  const std::size_t length = name.size() + std::string_view(kTemporary).size();
  if (length > longest) {
    throw std::runtime_error(fmt::format(
        "{}: the file's name is too long: with \"{}\", while it is written, it has {} bytes, the "
        "file system takes {}; give the device a shorter name",
        path_of(name), kTemporary, length, longest));
  }
}

void StateDirectory::require_in_place() const {
  if (const std::string gone = displacement(directory_.get(), path_); !gone.empty()) {
    throw std::runtime_error("the state directory " + gone);
  }
}

std::optional<std::vector<std::byte>> StateDirectory::read(const std::string& name,
                                                           std::size_t largest) const {
  constexpr const char* kRemedy =
      "delete it to start without it, or put a copy of the kept file there";
  const auto require_readable = [&](bool done) {
    if (!done) {
      throw std::runtime_error(fmt::format("{}: cannot read the file: {}; check its permissions",
                                           path_of(name), reason(errno)));
    }
  };
  require_short(name);
  if (use_ == Use::own) {
    static_cast<void>(::unlinkat(directory_.get(), (name + kTemporary).c_str(), 0));
  }
  // Not even opened if it is strange: that alone may wait, or do something to a device.
  struct stat found {};
  if (::fstatat(directory_.get(), name.c_str(), &found, AT_SYMLINK_NOFOLLOW) != 0) {
    require_readable(errno == ENOENT);
    return std::nullopt;
  }
  require_regular(path_of(name), found, kRemedy);
  const link::FileDescriptor file(::openat(
      directory_.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  require_readable(file.is_open() && ::fstat(file.get(), &found) == 0);
  require_regular(path_of(name), found, kRemedy);
  std::vector<std::byte> bytes;
  auto end = static_cast<std::size_t>(found.st_size);
  while (end <= largest) {
    const std::size_t before = bytes.size();
    bytes.resize(before + kReadAtOnce);
    const ssize_t count = ::read(file.get(), bytes.data() + before, kReadAtOnce);
    bytes.resize(before + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (count == 0) {
      return bytes;
    }
    require_readable(count > 0 || errno == EINTR);
    end = bytes.size();
  }
  throw std::runtime_error(fmt::format("{}: the file has {} bytes, a kept file at most {}; {}",
                                       path_of(name), end, largest, kRemedy));
}

std::optional<StateDirectory::FileStamp> StateDirectory::stamp(const std::string& name) const {
  struct stat found {};
  if (::fstatat(directory_.get(), name.c_str(), &found, AT_SYMLINK_NOFOLLOW) != 0 ||
      !link::strange_kind(found.st_mode).empty() || found.st_nlink != 1) {
    return std::nullopt;
  }
  return stamp_of(found);
}

std::string StateDirectory::what_is_there(const std::string& name,
                                          const std::optional<FileStamp>& before) const {
  const auto now = stamp(name);
  if (before && now && before->device == now->device && before->number == now->number) {
    return "its old content is still there";
  }
  struct stat found {};
  const bool exists = ::fstatat(directory_.get(), name.c_str(), &found, AT_SYMLINK_NOFOLLOW) == 0;
  return exists ? "what is there now is not what the rack has kept" : "there is no such file now";
}

void StateDirectory::fail_to_write(const std::string& name, const std::string& reason,
                                   const std::string& now_there) const {
  throw std::runtime_error(fmt::format(
      "{}: cannot write the file: {}; {}. Make room, and check that {} is a directory this user "
      "may write to, the same as at the start",
      path_of(name), reason, now_there, path_));
}

StateDirectory::FileStamp StateDirectory::replace(const std::string& name,
                                                  std::span<const std::byte> bytes) const {
  const std::string temporary = name + kTemporary;
  const int directory = directory_.get();
  const auto before = stamp(name);
  bool created = false;
  bool renamed = false;
  try {
    require_in_place();
    // Made anew, so that nothing else can be written to by that name.
    require(::unlinkat(directory, temporary.c_str(), 0) == 0 || errno == ENOENT);
    const link::FileDescriptor file(::openat(
        directory, temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644));
    require(file.is_open());
    created = true;
    write_all(file.get(), bytes, 0);
    require(::fsync(file.get()) == 0);
    require(::renameat(directory, temporary.c_str(), directory, name.c_str()) == 0);
    renamed = true;
    require(::fsync(directory) == 0);
    return stamp_of(file);
  } catch (const std::system_error& error) {
    if (created && !renamed) {
      static_cast<void>(::unlinkat(directory, temporary.c_str(), 0));
    }
    fail_to_write(name, error.code().message(),
                  renamed ? "its new content is there, but may be lost with the power"
                          : what_is_there(name, before));
  } catch (const std::runtime_error& error) {
    fail_to_write(name, error.what(), what_is_there(name, before));
  }
}

std::optional<StateDirectory::FileStamp> StateDirectory::append(
    const std::string& name, const FileStamp& before, std::size_t length,
    std::span<const std::byte> bytes) const {
  if (stamp(name) != before) {
    return std::nullopt;
  }
  const auto end = static_cast<off_t>(length);
  link::FileDescriptor file;
  try {
    require_in_place();
    file = link::FileDescriptor(::openat(
        directory_.get(), name.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    require(file.is_open());
    if (stamp_of(file) != before) {
      return std::nullopt;
    }
    if (before.size > length) {
      require(::ftruncate(file.get(), end) == 0);
    }
    write_all(file.get(), bytes, end);
    require(::fdatasync(file.get()) == 0);
    return stamp_of(file);
  } catch (const std::system_error& error) {
    const bool taken_back =
        !file.is_open() || (::ftruncate(file.get(), end) == 0 && ::fdatasync(file.get()) == 0);
    fail_to_write(name, error.code().message(),
                  taken_back ? what_is_there(name, before) : "it may have its old or new content");
  } catch (const std::runtime_error& error) {
    fail_to_write(name, error.what(), what_is_there(name, before));
  }
}

}  // namespace stator::rack
