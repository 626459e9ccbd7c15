#include "stator/link/can/slcan_pty_link.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <tuple>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/inotify.h>
#include <termios.h>
#include <unistd.h>

#include "stator/link/can/can_link_address.hpp"
#include "stator/link/can/can_link_events.hpp"
#include "stator/link/system/failure.hpp"

namespace stator::link {

base::Expected<std::unique_ptr<CanLink>, LinkError> SlcanPtyLink::open(
    const std::string& path, bool acknowledge, const CanLinkOptions& options) {
  auto terminal = PseudoTerminal::open(path);
  if (!terminal) {
    return base::Unexpected{terminal.error()};
  }
  auto link = std::unique_ptr<SlcanPtyLink>(new SlcanPtyLink(std::move(*terminal), options));
  if (const auto started = link->start(acknowledge); !started) {
    return base::Unexpected{started.error()};
  }
  return std::unique_ptr<CanLink>(std::move(link));
}

base::Expected<void, LinkError> SlcanPtyLink::start(bool acknowledge) {
  const CanLinkAddress address{
      .kind = CanLinkKind::slcan, .name = terminal_.path(), .acknowledge = acknowledge};
  if (auto prepared = prepare(to_text(address)); !prepared) {
    return prepared;
  }
  FileDescriptor master(::fcntl(terminal_.master(), F_DUPFD_CLOEXEC, 0));
  if (!master.is_open()) {
    return system_failure("cannot use the pseudo-terminal of " + in_quotes(name()), errno);
  }
  watch_programs();
  return add_client(std::move(master),
                    std::make_unique<SlcanSession>(acknowledge, [this](unsigned bit_rate) {
                      report_bit_rate(*this, options(), now(), bit_rate);
                    }));
}

/// Where the system has no inotify, programs have to close the channel themselves (command C).
void SlcanPtyLink::watch_programs() {
  opens_and_closes_ = FileDescriptor(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK));
  if (opens_and_closes_.is_open() &&
      ::inotify_add_watch(opens_and_closes_.get(), terminal_.terminal().c_str(),
                          IN_OPEN | IN_CLOSE) >= 0) {
    std::ignore = watch(opens_and_closes_.get());
  }
}

void SlcanPtyLink::on_readable(int descriptor) {
  alignas(inotify_event) std::array<char, 4096> buffer{};
  bool closed = false;
  ssize_t length = 0;
  while ((length = ::read(descriptor, buffer.data(), buffer.size())) > 0) {
    for (std::size_t at = 0; at + sizeof(inotify_event) <= static_cast<std::size_t>(length);) {
      inotify_event event{};
      std::memcpy(&event, buffer.data() + at, sizeof event);
      at += sizeof event + event.len;
      const bool opens = (event.mask & IN_OPEN) != 0;
      programs_ += opens ? 1 : -1;
      closed = closed || !opens;
    }
  }
  last_has_gone_ = programs_ == 0 && closed;
}

void SlcanPtyLink::on_idle() {
  if (!last_has_gone_) {
    return;
  }
  // The last bytes of a program may arrive after the news that it is gone, since the system hands
  // them over in the background. poll() completes that; such bytes are read before the session
  // restarts.
  pollfd input{.fd = clients().front()->descriptor.get(), .events = POLLIN, .revents = 0};
  if (::poll(&input, 1, 0) > 0) {
    return;
  }
  last_has_gone_ = false;
  restart_client(*clients().front());
  ::tcflush(terminal_.client_end(), TCIFLUSH);
}

std::string SlcanPtyLink::usage() const {
  // slcand takes names below /dev only.
  const CanLinkAddress address{.kind = CanLinkKind::slcan, .name = terminal_.path()};
  return "can.Bus(" + python_can_arguments(address) + "), or: sudo slcand -o $(readlink " +
         terminal_.path() + ") can0";
}

}  // namespace stator::link
