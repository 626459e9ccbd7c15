#include "stator/link/serial/tcp_serial_link.hpp"

#include <array>
#include <cerrno>
#include <utility>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include "stator/link/system/failure.hpp"
#include "stator/link/system/socket_options.hpp"
#include "stator/link/system/tcp_listener.hpp"

namespace stator::link {

namespace {

/// Bytes that the system keeps for a program that does not read.
constexpr int kUnread = 1 << 18;

}  // namespace

base::Expected<std::unique_ptr<TcpSerialLink>, LinkError> TcpSerialLink::open(
    const std::string& address, std::uint16_t port, const SerialLinkOptions& options) {
  auto listener = listen_at(address, port, "tcp:" + address + ":" + std::to_string(port));
  if (!listener) {
    return base::Unexpected{listener.error()};
  }
  return std::unique_ptr<TcpSerialLink>(
      new TcpSerialLink(std::move(*listener), address, port, options));
}

TcpSerialLink::TcpSerialLink(FileDescriptor listener, const std::string& address,
                             std::uint16_t port, const SerialLinkOptions& options)
    : listener_(std::move(listener)),
      port_(port),
      name_((address == "0.0.0.0" ? kLoopbackAddress : address) + ":" + std::to_string(port)),
      wait_(options.wait, options.spin_time) {}

base::Expected<std::size_t, LinkError> TcpSerialLink::receive(std::span<std::byte> buffer,
                                                              base::SimDuration timeout) {
  return wait_.receive(*this, buffer, timeout);
}

base::Expected<ReceiveWait::Taken, LinkError> TcpSerialLink::take(std::span<std::byte> buffer,
                                                                  base::SimDuration wait) {
  for (bool slept = false;; slept = true) {
    if (const std::size_t length = read(buffer); length != 0) {
      return ReceiveWait::Taken{.length = length};
    }
    if (slept) {
      return ReceiveWait::Taken{};
    }
    if (!sleep(wait)) {
      return ReceiveWait::Taken{.interrupted = true};
    }
  }
}

std::size_t TcpSerialLink::read(std::span<std::byte> buffer) {
  if (!client_.is_open() || buffer.empty()) {
    return 0;
  }
  const ssize_t length = ::recv(client_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (length > 0) {
    // Without it the system falls back to delaying acknowledgements by 40 ms, for which a program
    // that does not set TCP_NODELAY waits before it sends its next telegram.
    set_socket_option(client_.get(), IPPROTO_TCP, TCP_QUICKACK, int{1});
    count_received(static_cast<std::size_t>(length));
    return static_cast<std::size_t>(length);
  }
  if (length == 0 || (errno != EAGAIN && errno != EINTR)) {
    set_client({});
  }
  return 0;
}

// Sleeps until bytes or a connection come, and accepts the connection. False: a signal ended the
// sleep.
bool TcpSerialLink::sleep(base::SimDuration wait) {
  std::array<pollfd, 2> waiting{
      {{.fd = listener_.get(), .events = POLLIN, .revents = 0},
       {.fd = client_.is_open() ? client_.get() : -1, .events = POLLIN, .revents = 0}}};
  const std::int64_t nanoseconds = std::max(wait, base::SimDuration()).nanoseconds();
  const timespec limit{nanoseconds / 1'000'000'000, nanoseconds % 1'000'000'000};
  if (::ppoll(waiting.data(), waiting.size(), &limit, nullptr) < 0) {
    return errno != EINTR;
  }
  if (waiting[0].revents != 0) {
    if (FileDescriptor client = accept_connection(listener_); client.is_open()) {
      clients_.fetch_add(1, std::memory_order_relaxed);
      set_client(std::move(client));
    }
  }
  return true;
}

void TcpSerialLink::set_client(FileDescriptor client) {
  const std::scoped_lock lock(mutex_);
  client_ = std::move(client);
}

base::Expected<void, LinkError> TcpSerialLink::send(std::span<const std::byte> bytes) {
  const std::scoped_lock lock(mutex_);
  if (!client_.is_open()) {
    count_dropped(bytes.size());
    return {};
  }
  // Asked before, because a write that finds the buffer nearly full takes a part.
  int unread = 0;
  const bool full = ::ioctl(client_.get(), TIOCOUTQ, &unread) == 0 && unread > kUnread;
  const ssize_t written =
      full ? -1 : ::send(client_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (written == static_cast<ssize_t>(bytes.size())) {
    count_sent(bytes.size());
    return {};
  }
  count_dropped(bytes.size());
  if (!full && written < 0 && (errno == EPIPE || errno == ECONNRESET)) {
    return {};  // the next receive() finds the connection closed
  }
  return fail(LinkErrorCode::queue_full,
              "the program at " + in_quotes(name_) + " does not read; bytes were dropped");
}

}  // namespace stator::link
