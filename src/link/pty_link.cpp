#include "link/pty_link.hpp"

#include <array>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "link/failure.hpp"

namespace stator::link {

namespace {

constexpr std::string_view kTerminals = "/dev/pts/";
/// More than any reply needs; a line that holds as much has no reader.
constexpr int kUnread = 2048;

}  // namespace

base::Expected<std::unique_ptr<PtyLink>, LinkError> PtyLink::open(const std::string& path) {
  auto link = std::unique_ptr<PtyLink>(new PtyLink(path));
  if (const auto opened = link->open_terminal(); !opened) {
    return base::Unexpected{opened.error()};
  }
  if (const auto placed = link->place_name(); !placed) {
    return base::Unexpected{placed.error()};
  }
  return link;
}

PtyLink::~PtyLink() {
  if (!terminal_.empty() && name_leads_to() == terminal_) {
    ::unlink(path_.c_str());
  }
}

base::Expected<void, LinkError> PtyLink::open_terminal() {
  master_ = FileDescriptor(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  std::array<char, 64> name{};
  if (!master_.is_open() || ::grantpt(master_.get()) != 0 || ::unlockpt(master_.get()) != 0 ||
      ::ptsname_r(master_.get(), name.data(), name.size()) != 0) {
    return system_failure("cannot make a pseudo-terminal for " + in_quotes(path_), errno);
  }
  client_end_ = FileDescriptor(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (!client_end_.is_open() || ::tcgetattr(client_end_.get(), &settings) != 0) {
    return system_failure("cannot open " + in_quotes(name.data()), errno);
  }
  ::cfmakeraw(&settings);
  if (::tcsetattr(client_end_.get(), TCSANOW, &settings) != 0) {
    return system_failure("cannot set up " + in_quotes(name.data()), errno);
  }
  terminal_ = name.data();
  return {};
}

std::string PtyLink::name_leads_to() const {
  std::error_code ignored;
  return std::filesystem::read_symlink(path_, ignored).string();
}

base::Expected<void, LinkError> PtyLink::place_name() {
  if (::symlink(terminal_.c_str(), path_.c_str()) == 0) {
    return {};
  }
  if (errno == EEXIST && name_leads_to().starts_with(kTerminals) && ::unlink(path_.c_str()) == 0 &&
      ::symlink(terminal_.c_str(), path_.c_str()) == 0) {
    return {};
  }
  const int error = errno;
  terminal_.clear();
  if (error == EEXIST) {
    return fail(LinkErrorCode::invalid_option,
                in_quotes(path_) +
                    " exists and is no pseudo-terminal; choose another name for the "
                    "serial port or remove it");
  }
  return system_failure("cannot give a serial port the name " + in_quotes(path_), error);
}

base::Expected<std::size_t, LinkError> PtyLink::receive(std::span<std::byte> buffer,
                                                        base::SimDuration timeout) {
  return wait_.receive(*this, buffer, timeout);
}

base::Expected<ReceiveWait::Taken, LinkError> PtyLink::take(std::span<std::byte> buffer,
                                                            base::SimDuration wait) {
  for (bool slept = false;; slept = true) {
    const ssize_t length = ::read(master_.get(), buffer.data(), buffer.size());
    if (length > 0) {
      return ReceiveWait::Taken{.length = static_cast<std::size_t>(length)};
    }
    if (length < 0 && errno != EAGAIN && errno != EINTR) {
      return system_failure("cannot receive from the serial port " + in_quotes(path_), errno);
    }
    if (slept || wait <= base::SimDuration()) {
      return ReceiveWait::Taken{};
    }
    if (!sleep_until_readable(master_.get(), wait)) {
      return ReceiveWait::Taken{.interrupted = true};
    }
  }
}

base::Expected<void, LinkError> PtyLink::send(std::span<const std::byte> bytes) {
  // Asked before, because a write that finds the buffer nearly full takes a part.
  int unread = 0;
  if (::ioctl(client_end_.get(), FIONREAD, &unread) == 0 && unread > kUnread) {
    return fail(LinkErrorCode::queue_full,
                "nobody reads the serial port " + in_quotes(path_) + "; bytes were dropped");
  }
  const ssize_t written = ::write(master_.get(), bytes.data(), bytes.size());
  if (written == static_cast<ssize_t>(bytes.size())) {
    return {};
  }
  if (written >= 0 || errno == EAGAIN) {
    return fail(LinkErrorCode::queue_full,
                "nobody reads the serial port " + in_quotes(path_) + "; bytes were dropped");
  }
  return system_failure("cannot send on the serial port " + in_quotes(path_), errno);
}

}  // namespace stator::link
