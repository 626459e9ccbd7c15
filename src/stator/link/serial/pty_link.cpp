#include "stator/link/serial/pty_link.hpp"

#include <cerrno>
#include <utility>

#include <sys/ioctl.h>
#include <unistd.h>

#include "stator/link/system/failure.hpp"

namespace stator::link {

namespace {

/// More than any reply needs; a line that holds as much has no reader.
constexpr int kUnread = 2048;

}  // namespace

base::Expected<std::unique_ptr<PtyLink>, LinkError> PtyLink::open(
    const std::string& path, const SerialLinkOptions& options) {
  auto terminal = PseudoTerminal::open(path);
  if (!terminal) {
    return base::Unexpected{terminal.error()};
  }
  return std::unique_ptr<PtyLink>(new PtyLink(std::move(*terminal), options));
}

base::Expected<std::size_t, LinkError> PtyLink::receive(std::span<std::byte> buffer,
                                                        base::SimDuration timeout) {
  return wait_.receive(*this, buffer, timeout);
}

base::Expected<ReceiveWait::Taken, LinkError> PtyLink::take(std::span<std::byte> buffer,
                                                            base::SimDuration wait) {
  for (bool slept = false;; slept = true) {
    const ssize_t length = ::read(terminal_.master(), buffer.data(), buffer.size());
    if (length > 0) {
      count_received(static_cast<std::size_t>(length));
      return ReceiveWait::Taken{.length = static_cast<std::size_t>(length)};
    }
    if (length < 0 && errno != EAGAIN && errno != EINTR) {
      return system_failure("cannot receive from the serial port " + in_quotes(name()), errno);
    }
    if (slept || wait <= base::SimDuration()) {
      return ReceiveWait::Taken{};
    }
    if (!sleep_until_readable(terminal_.master(), wait)) {
      return ReceiveWait::Taken{.interrupted = true};
    }
  }
}

base::Expected<void, LinkError> PtyLink::send(std::span<const std::byte> bytes) {
  // Asked before, because a write that finds the buffer nearly full takes a part.
  int unread = 0;
  const bool full = ::ioctl(terminal_.client_end(), FIONREAD, &unread) == 0 && unread > kUnread;
  const ssize_t written = full ? 0 : ::write(terminal_.master(), bytes.data(), bytes.size());
  if (written == static_cast<ssize_t>(bytes.size())) {
    count_sent(bytes.size());
    return {};
  }
  count_dropped(bytes.size());
  if (written >= 0 || errno == EAGAIN) {
    return fail(LinkErrorCode::queue_full,
                "nobody reads the serial port " + in_quotes(name()) + "; bytes were dropped");
  }
  return system_failure("cannot send on the serial port " + in_quotes(name()), errno);
}

}  // namespace stator::link
