#include "rack/kept_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include "base/crc32.hpp"

namespace stator::rack {

namespace {

constexpr std::string_view kMagic = "stator 1 ";
constexpr std::size_t kLongestHeader = 200;
constexpr std::size_t kReadAtOnce = 65536;

std::string reason(int error) {
  return std::generic_category().message(error);
}

/// The text up to the next space, which is taken off `line` with it.
std::string_view next_word(std::string_view& line) {
  const std::size_t end = std::min(line.find(' '), line.size());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  return word;
}

template <typename T>
std::optional<T> number(std::string_view word, int base) {
  T value{};
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value, base);
  return error == std::errc() && rest == end ? std::optional(value) : std::nullopt;
}

void write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) {
      throw std::system_error(errno, std::generic_category());
    }
    bytes = bytes.subspan(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
  }
}

/// A rack that was killed a moment ago may still hold the lock until the system has cleared it up.
bool take_lock(int file) {
  using namespace std::chrono_literals;
  const auto end = std::chrono::steady_clock::now() + 500ms;
  while (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    if (std::chrono::steady_clock::now() >= end) {
      return false;
    }
    std::this_thread::sleep_for(10ms);
  }
  return true;
}

void require(bool done) {
  if (!done) {
    throw std::system_error(errno, std::generic_category());
  }
}

}  // namespace

std::vector<std::byte> encode(std::string_view kind, std::string_view product,
                              std::span<const std::byte> content) {
  const std::string header = fmt::format("{}{} {} {:08X} {}\n", kMagic, kind, content.size(),
                                         base::crc32(content), product);
  std::vector<std::byte> file;
  file.reserve(header.size() + content.size());
  std::ranges::copy(std::as_bytes(std::span(header)), std::back_inserter(file));
  file.insert(file.end(), content.begin(), content.end());
  return file;
}

KeptFile decode(std::span<const std::byte> file) {
  const std::string_view text(reinterpret_cast<const char*>(file.data()),
                              std::min(file.size(), kLongestHeader));
  const std::size_t end = text.find('\n');
  if (!text.starts_with(kMagic) || end == std::string_view::npos) {
    throw std::runtime_error(
        "it is no file that Stator has kept: its first line does not begin with \"stator 1\"");
  }
  std::string_view line = text.substr(kMagic.size(), end - kMagic.size());
  KeptFile kept;
  kept.kind = next_word(line);
  const auto length = number<std::size_t>(next_word(line), 10);
  const auto checksum = number<std::uint32_t>(next_word(line), 16);
  kept.product = line;
  const auto content = file.subspan(end + 1);
  if (!length || !checksum) {
    throw std::runtime_error("it is damaged: length or checksum in its first line is no number");
  }
  if (content.size() != *length) {
    throw std::runtime_error(fmt::format(
        "it is damaged: its first line promises {} bytes, {} follow", *length, content.size()));
  }
  if (const std::uint32_t found = base::crc32(content); found != *checksum) {
    throw std::runtime_error(
        fmt::format("it is damaged: its first line promises CRC-32 {:08X}, its content has {:08X}",
                    *checksum, found));
  }
  kept.content.assign(content.begin(), content.end());
  return kept;
}

std::string file_name_for(std::string_view device_name) {
  std::string name;
  for (const char c : device_name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       c == '.' || c == '_' || c == '-';
    name += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return name;
}

StateDirectory::StateDirectory(const std::string& path, Use use) : path_(path) {
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
    lock_ = link::FileDescriptor(
        ::openat(directory_.get(), "lock", O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  }
  if (!lock_.is_open()) {
    throw std::runtime_error(
        fmt::format("{}: cannot use the state directory: {}; it must be a directory this user may "
                    "write to",
                    path, reason(errno)));
  }
  if (!take_lock(lock_.get())) {
    throw std::runtime_error(fmt::format(
        "{}: the state directory is in use by another rack; end that one or name another directory",
        path));
  }
}

std::optional<std::vector<std::byte>> StateDirectory::read(const std::string& name) const {
  const link::FileDescriptor file(::openat(directory_.get(), name.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open() && errno == ENOENT) {
    return std::nullopt;
  }
  std::vector<std::byte> bytes;
  ssize_t count = file.is_open() ? 0 : -1;
  while (file.is_open()) {
    const std::size_t end = bytes.size();
    bytes.resize(end + kReadAtOnce);
    count = ::read(file.get(), bytes.data() + end, kReadAtOnce);
    bytes.resize(end + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (count == 0 || (count < 0 && errno != EINTR)) {
      break;
    }
  }
  if (count < 0) {
    throw std::runtime_error(fmt::format("{}: cannot read the file: {}; check its permissions",
                                         path_of(name), reason(errno)));
  }
  return bytes;
}

void StateDirectory::replace(const std::string& name, std::span<const std::byte> bytes) const {
  const std::string temporary = name + ".new";
  try {
    {
      const link::FileDescriptor file(::openat(directory_.get(), temporary.c_str(),
                                               O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
      require(file.is_open());
      write_all(file.get(), bytes);
      require(::fsync(file.get()) == 0);
    }
    require(::renameat(directory_.get(), temporary.c_str(), directory_.get(), name.c_str()) == 0);
    require(::fsync(directory_.get()) == 0);
  } catch (const std::system_error& error) {
    throw std::runtime_error(
        fmt::format("{}: cannot write the file: {}; its old content is still there. Make room and "
                    "check the permissions of the directory",
                    path_of(name), error.code().message()));
  }
}

}  // namespace stator::rack
