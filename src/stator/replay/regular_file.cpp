#include "stator/replay/regular_file.hpp"

#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stator/link/system/file_kind.hpp"
#include "stator/rack/file/system_files.hpp"

namespace stator::replay {

namespace {

namespace fs = std::filesystem;

constexpr ::mode_t kMode = 0666;

[[noreturn]] void fail(std::string_view what, const std::string& path, int error) {
  throw std::runtime_error(fmt::format("cannot {} recording \"{}\": {}", what, path,
                                       std::generic_category().message(error)));
}

[[noreturn]] void refuse(std::string_view what, const std::string& path, ::mode_t mode) {
  throw std::runtime_error(fmt::format("cannot {} recording \"{}\": it is {}; name a file", what,
                                       path, link::strange_kind(mode)));
}

}  // namespace

FileHandle open_to_read(const std::string& path) {
  // Looked at before it is opened, which may wait (a FIFO) or do something (a device), and once
  // more what was opened.
  struct ::stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    fail("read", path, errno);
  }
  int descriptor = -1;
  if (S_ISREG(status.st_mode)) {
    descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (descriptor < 0 || ::fstat(descriptor, &status) != 0) {
      fail("read", path, errno);
    }
  }
  FileHandle file(descriptor < 0 ? nullptr : ::fdopen(descriptor, "rb"));
  if (!S_ISREG(status.st_mode)) {
    refuse("read", path, status.st_mode);
  }
  if (file == nullptr) {
    fail("read", path, errno);
  }
  return file;
}

std::uint64_t size_of(std::FILE& file) {
  struct ::stat status {};
  return ::fstat(::fileno(&file), &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

NewFile::NewFile(const std::string& path) : path_(path) {
  struct ::stat status {};
  if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    refuse("write", path, status.st_mode);
  }
  if (const std::string problem = rack::output_problem(path); !problem.empty()) {
    throw std::runtime_error(problem);
  }
  std::error_code error;
  if (fs::is_symlink(path, error)) {
    path_ = fs::canonical(path, error).string();
    if (error) {
      throw std::runtime_error(
          fmt::format("cannot write recording \"{}\": it is a link to nothing; name a file", path));
    }
  }
  temporary_ = path_ + ".new";
  ::unlink(temporary_.c_str());
  const int descriptor =
      ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kMode);
  if (descriptor < 0) {
    fail("create", temporary_, errno);
  }
  file_.reset(::fdopen(descriptor, "wb"));
}

NewFile::~NewFile() {
  if (!named_) {
    ::unlink(temporary_.c_str());
  }
}

void NewFile::give_name() {
  if (std::fflush(file_.get()) != 0 || ::fdatasync(::fileno(file_.get())) != 0 ||
      ::rename(temporary_.c_str(), path_.c_str()) != 0) {
    fail("write", path_, errno);
  }
  named_ = true;
}

}  // namespace stator::replay
