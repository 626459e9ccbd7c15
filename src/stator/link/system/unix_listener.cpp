#include "stator/link/system/unix_listener.hpp"

#include <algorithm>
#include <cerrno>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "stator/link/system/failure.hpp"

namespace stator::link {

namespace {

constexpr int kWaitingConnections = 16;

bool is_served(const sockaddr_un& address) {
  const FileDescriptor probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
         errno == EAGAIN;
}

bool is_socket(const std::string& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0 && S_ISSOCK(status.st_mode);
}

}  // namespace

base::Expected<FileDescriptor, LinkError> listen_at_path(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    return fail(LinkErrorCode::invalid_option,
                "the path " + in_quotes(path) + " is longer than the system allows for sockets (" +
                    std::to_string(sizeof address.sun_path - 1) + " characters)");
  }
  std::ranges::copy(path, address.sun_path);
  FileDescriptor listener(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const auto bind = [&] {
    return ::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  };
  if (!bind()) {
    if (errno == EADDRINUSE && !is_socket(path)) {
      return fail(LinkErrorCode::address_in_use,
                  in_quotes(path) + " is a file; remove it or choose another path");
    }
    if (errno == EADDRINUSE && is_served(address)) {
      return fail(LinkErrorCode::address_in_use, "another process listens at " + in_quotes(path) +
                                                     "; end it, or choose another path");
    }
    ::unlink(path.c_str());  // left behind by a process that was killed
    if (!bind()) {
      return system_failure("cannot listen at " + in_quotes(path), errno);
    }
  }
  if (::listen(listener.get(), kWaitingConnections) != 0) {
    return system_failure("cannot listen at " + in_quotes(path), errno);
  }
  return listener;
}

}  // namespace stator::link
