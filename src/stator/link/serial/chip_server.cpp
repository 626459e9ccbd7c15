#include "stator/link/serial/chip_server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <utility>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "stator/link/serial/serial_link.hpp"
#include "stator/link/system/failure.hpp"
#include "stator/link/system/receive_wait.hpp"
#include "stator/link/system/socket_options.hpp"
#include "stator/link/system/tcp_listener.hpp"
#include "stator/link/system/unix_listener.hpp"

namespace stator::link {

namespace {

using base::SimDuration;

constexpr std::string_view kUnix = "unix:";
constexpr std::string_view kTcp = "tcp:";
constexpr const char* kBusySentence =
    "another program has this chip; end it, or give the chip a second device in the rack";

void add(std::atomic<std::uint64_t>& counter) {
  counter.fetch_add(1, std::memory_order_relaxed);
}

/// A machine that has died is noticed after some twenty seconds.
void watch_over(int socket) {
  set_socket_option(socket, IPPROTO_TCP, TCP_KEEPIDLE, int{10});
  set_socket_option(socket, IPPROTO_TCP, TCP_KEEPINTVL, int{3});
  set_socket_option(socket, IPPROTO_TCP, TCP_KEEPCNT, int{3});
  set_socket_option(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, int{20'000});
}

/// The other end has closed the connection; something it sent may still be there.
bool hung_up(int socket) {
  pollfd state{.fd = socket, .events = POLLRDHUP, .revents = 0};
  return ::poll(&state, 1, 0) > 0 && (state.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
}

std::vector<std::byte> refusal_message(std::uint8_t tag, chip_protocol::Refusal refusal,
                                       std::string_view sentence) {
  std::vector<std::byte> body{std::byte{static_cast<std::uint8_t>(refusal)}};
  const auto text = std::as_bytes(std::span(sentence));
  body.insert(body.end(), text.begin(), text.end());
  std::vector<std::byte> message;
  append_chip_message(message, {.kind = chip_protocol::kError, .tag = tag, .body = body});
  return message;
}

}  // namespace

base::Expected<void, LinkError> check_chip_link(std::string_view address) {
  if ((address.starts_with(kUnix) && address.size() > kUnix.size()) ||
      (address.starts_with(kTcp) && parse_serial_link(address))) {
    return {};
  }
  return fail(LinkErrorCode::invalid_option,
              in_quotes(std::string(address)) + " is no socket for a chip's firmware; write " +
                  std::string(kChipLinkForms) + ", e.g. unix:/tmp/chip or tcp:29146");
}

base::Expected<std::unique_ptr<ChipServer>, LinkError> ChipServer::open(std::string_view address) {
  if (const auto checked = check_chip_link(address); !checked) {
    return base::Unexpected{checked.error()};
  }
  FileDescriptor wake(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake.is_open()) {
    return system_failure("cannot wait for the program of a chip", errno);
  }
  if (address.starts_with(kUnix)) {
    const std::string path(address.substr(kUnix.size()));
    auto listener = listen_at_path(path);
    if (!listener) {
      return base::Unexpected{listener.error()};
    }
    return std::unique_ptr<ChipServer>(
        new ChipServer(std::move(*listener), std::string(address), path, std::move(wake)));
  }
  const auto place = parse_serial_link(address);
  std::uint16_t port = place->port;
  auto listener = listen_at(place->name, port, std::string(address));
  if (!listener) {
    return base::Unexpected{listener.error()};
  }
  return std::unique_ptr<ChipServer>(
      new ChipServer(std::move(*listener), "tcp:" + place->name + ":" + std::to_string(port), {},
                     std::move(wake)));
}

ChipServer::ChipServer(FileDescriptor listener, std::string name, std::string path,
                       FileDescriptor wake)
    : listener_(std::move(listener)),
      name_(std::move(name)),
      path_(std::move(path)),
      wake_(std::move(wake)) {}

ChipServer::~ChipServer() {
  if (!path_.empty()) {
    ::unlink(path_.c_str());
  }
}

ChipServer::News ChipServer::receive(ChipMessage& message, SimDuration timeout) {
  for (bool slept = false;; slept = true) {
    if (const auto news = take(message)) {
      return *news;
    }
    if (slept) {
      return News::nothing;
    }
    sleep(timeout);
    accept_program();
    if (const auto news = read()) {
      return *news;
    }
  }
}

// The next news from what has been received already, without asking the system.
std::optional<ChipServer::News> ChipServer::take(ChipMessage& message) {
  if (!client_.is_open()) {
    return std::nullopt;
  }
  if (!announced_) {
    announced_ = true;
    return News::connected;
  }
  if (leaving_ || congested()) {
    return std::nullopt;
  }
  if (const auto next = reader_.next()) {
    add(messages_);
    message = *next;
    return News::message;
  }
  if (reader_.broken()) {
    refuse(0, chip_protocol::Refusal::too_long,
           "the message announces a body longer than 4100 bytes; cut the transfer in pieces");
  }
  return std::nullopt;
}

// Receives bytes from the program, in which take() finds messages.
std::optional<ChipServer::News> ChipServer::read() {
  if (!client_.is_open()) {
    return std::nullopt;
  }
  bool gone = false;
  if (!leaving_ && !reader_.broken()) {
    const std::span<std::byte> space = reader_.space();
    if (!space.empty()) {
      const ssize_t length = ::recv(client_.get(), space.data(), space.size(), MSG_DONTWAIT);
      if (length > 0) {
        reader_.received(static_cast<std::size_t>(length));
      }
      gone = length == 0 || (length < 0 && errno != EAGAIN && errno != EINTR);
    }
  }
  const SimDuration age(monotonic_now() - connected_at_);
  const bool silent = !greeted_ && age > kGreetingTime;
  {
    const std::scoped_lock lock(mutex_);
    write_unsent();
    gone = gone || failed_ || (leaving_ && (unsent_.empty() || age > kGreetingTime));
  }
  if (!gone && !silent) {
    return std::nullopt;
  }
  if (silent || leaving_) {
    add(thrown_out_);
  }
  close_program();
  return News::left;
}

void ChipServer::accept_program() {
  // A program that is started anew comes right after the one before has ended: it waits in the
  // queue until what that one sent last has been read.
  if (client_.is_open() && hung_up(client_.get())) {
    return;
  }
  FileDescriptor connection = accept_connection(listener_);
  if (!connection.is_open()) {
    return;
  }
  if (client_.is_open()) {
    add(turned_away_);
    const auto message = refusal_message(0, chip_protocol::Refusal::busy, kBusySentence);
    static_cast<void>(
        ::send(connection.get(), message.data(), message.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
    ::shutdown(connection.get(), SHUT_WR);
    return;
  }
  add(programs_);
  watch_over(connection.get());
  reader_.reset();
  greeted_ = false;
  leaving_ = false;
  announced_ = false;
  connected_at_ = monotonic_now();
  const std::scoped_lock lock(mutex_);
  unsent_.clear();
  failed_ = false;
  client_ = std::move(connection);
}

void ChipServer::close_program() {
  const std::scoped_lock lock(mutex_);
  client_ = FileDescriptor();
  unsent_.clear();
}

void ChipServer::sleep(SimDuration time) {
  bool writes = false;
  {
    const std::scoped_lock lock(mutex_);
    writes = !unsent_.empty();
  }
  const bool reads = client_.is_open() && !leaving_ && !congested();
  const auto events = static_cast<short>((reads ? POLLIN : 0) | (writes ? POLLOUT : 0));
  std::array<pollfd, 3> waiting{
      {{.fd = listener_.get(), .events = POLLIN, .revents = 0},
       {.fd = wake_.get(), .events = POLLIN, .revents = 0},
       {.fd = client_.is_open() ? client_.get() : -1, .events = events, .revents = 0}}};
  const std::int64_t nanoseconds = std::max(time, SimDuration()).nanoseconds();
  const timespec limit{nanoseconds / 1'000'000'000, nanoseconds % 1'000'000'000};
  if (::ppoll(waiting.data(), waiting.size(), &limit, nullptr) > 0 && waiting[1].revents != 0) {
    std::uint64_t count = 0;
    static_cast<void>(::read(wake_.get(), &count, sizeof count));
  }
}

bool ChipServer::congested() {
  const std::scoped_lock lock(mutex_);
  return unsent_.size() > kUnsent;
}

void ChipServer::send(const ChipMessage& message) {
  const std::scoped_lock lock(mutex_);
  if (!client_.is_open()) {
    return;
  }
  append_chip_message(unsent_, message);
  flush();
}

bool ChipServer::send_event(const ChipMessage& message) {
  const std::scoped_lock lock(mutex_);
  if (!client_.is_open() || unsent_.size() > kUnsent) {
    add(events_lost_);
    return false;
  }
  append_chip_message(unsent_, message);
  flush();
  return true;
}

void ChipServer::refuse(std::uint8_t tag, chip_protocol::Refusal refusal,
                        std::string_view sentence) {
  leaving_ = leaving_ || chip_protocol::ends_connection(refusal);
  const std::scoped_lock lock(mutex_);
  const auto message = refusal_message(tag, refusal, sentence);
  unsent_.insert(unsent_.end(), message.begin(), message.end());
  flush();
}

// The receiving thread sees to what the system does not take now.
void ChipServer::flush() {
  write_unsent();
  if (!unsent_.empty()) {
    wake();
  }
}

void ChipServer::write_unsent() {
  if (!client_.is_open() || unsent_.empty() || failed_) {
    return;
  }
  const ssize_t written =
      ::send(client_.get(), unsent_.data(), unsent_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (written > 0) {
    unsent_.erase(unsent_.begin(), unsent_.begin() + written);
  } else if (written < 0 && errno != EAGAIN && errno != EINTR) {
    failed_ = true;
  }
}

void ChipServer::wake() noexcept {
  const std::uint64_t one = 1;
  static_cast<void>(::write(wake_.get(), &one, sizeof one));
}

ChipServerStatistics ChipServer::statistics() const {
  const auto value = [](const std::atomic<std::uint64_t>& counter) {
    return counter.load(std::memory_order_relaxed);
  };
  return {.programs = value(programs_),
          .turned_away = value(turned_away_),
          .thrown_out = value(thrown_out_),
          .messages = value(messages_),
          .events_lost = value(events_lost_)};
}

}  // namespace stator::link
