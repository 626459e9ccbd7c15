#include "stator/link/can/can_stream_link.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <tuple>
#include <utility>

#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "stator/link/system/failure.hpp"

namespace stator::link {

namespace {

constexpr std::size_t kMaximumQueued = std::size_t{16} << 20;
constexpr std::size_t kReadAtOnce = std::size_t{64} << 10;
/// A queue that has grown beyond gives its memory back when it is empty.
constexpr std::size_t kKeptCapacity = std::size_t{1} << 20;
/// What one receive() services at most, so that a flood of nonsense does not hold its caller.
constexpr int kRounds = 16;
/// The end of a line of slcan, whose sessions alone set Taken::restart.
constexpr char kEndOfLine = '\r';

}  // namespace

base::Expected<void, LinkError> CanStreamLink::prepare(std::string name) {
  name_ = std::move(name);
  waiting_ = FileDescriptor(::epoll_create1(EPOLL_CLOEXEC));
  timer_ = FileDescriptor(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK));
  if (!waiting_.is_open() || !timer_.is_open()) {
    return system_failure("cannot wait for " + in_quotes(name_), errno);
  }
  return watch(timer_.get());
}

base::Expected<void, LinkError> CanStreamLink::watch(int descriptor) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = descriptor;
  if (::epoll_ctl(waiting_.get(), EPOLL_CTL_ADD, descriptor, &event) != 0) {
    return system_failure("cannot wait for " + in_quotes(name_), errno);
  }
  return {};
}

base::Expected<void, LinkError> CanStreamLink::add_client(
    FileDescriptor descriptor, std::unique_ptr<CanStreamSession> session) {
  if (auto watched = watch(descriptor.get()); !watched) {
    return watched;
  }
  auto client = std::make_unique<Client>();
  client->descriptor = std::move(descriptor);
  client->session = std::move(session);
  client->session->greet(client->output);
  write(*client);
  clients_.push_back(std::move(client));
  return {};
}

CanStreamLink::Client* CanStreamLink::find(int descriptor) {
  const auto found = std::ranges::find_if(
      clients_, [&](const auto& each) { return each->descriptor.get() == descriptor; });
  return found == clients_.end() ? nullptr : found->get();
}

base::Expected<std::size_t, LinkError> CanStreamLink::receive(std::span<can::Frame> frames,
                                                              base::SimTime now) {
  now_ = now;
  Target target{.frames = frames};
  take_from_all(target);
  std::array<epoll_event, 32> events{};
  for (int round = 0; round < kRounds && !target.full(); ++round) {
    const int count = ::epoll_wait(waiting_.get(), events.data(), int{events.size()}, 0);
    if (count < 0 && errno != EINTR) {
      return system_failure("cannot receive from " + in_quotes(name_), errno);
    }
    if (count <= 0) {
      on_idle();
      break;
    }
    for (const epoll_event& event : std::span(events).first(static_cast<std::size_t>(count))) {
      service(event.data.fd, event.events, target);
    }
    take_from_all(target);
  }
  flush();
  set_timer();
  remove_ended(!target.full());
  return target.count;
}

void CanStreamLink::service(int descriptor, std::uint32_t events, Target& target) {
  if (descriptor == timer_.get()) {
    advance_sessions(target);
    return;
  }
  Client* const client = find(descriptor);
  if (client == nullptr) {
    on_readable(descriptor);
    return;
  }
  if ((events & EPOLLOUT) != 0) {
    write(*client);
  }
  if ((events & (EPOLLIN | EPOLLHUP | EPOLLERR)) != 0) {
    read(*client);
  }
}

void CanStreamLink::take_from_all(Target& target) {
  for (const auto& client : clients_) {
    take_from(*client, target);
  }
}

void CanStreamLink::take_from(Client& client, Target& target) {
  while (!target.full() && client.input_taken < client.input.size()) {
    const std::string_view rest = std::string_view(client.input).substr(client.input_taken);
    const std::size_t answered = client.output.size();
    const CanStreamSession::Taken taken =
        client.session->take(rest, std::chrono::steady_clock::now(), client.output);
    if (taken.consumed == 0) {
      break;
    }
    client.input_taken += taken.consumed;
    // If the program reads in time, all that waits are answers that it wants.
    if (taken.restart && client.waits_to_write) {
      restart_output(client, answered);
    } else if (client.output.size() - client.output_sent > kMaximumQueued) {
      client.output.resize(answered);
    }
    if (taken.frame) {
      deliver(*taken.frame, client, target);
    }
  }
  if (client.input_taken == client.input.size()) {
    client.input.clear();
    client.input_taken = 0;
  } else if (client.input_taken > kReadAtOnce) {
    client.input.erase(0, client.input_taken);
    client.input_taken = 0;
  }
}

void CanStreamLink::deliver(const can::Frame& frame, Client& from, Target& target) {
  target.frames[target.count++] = frame;
  ++statistics_.frames_received;
  for (const auto& client : clients_) {
    if (client.get() != &from) {
      put(*client, frame, now_);
    }
  }
}

void CanStreamLink::advance_sessions(Target& target) {
  const MachineTime now = std::chrono::steady_clock::now();
  for (const auto& client : clients_) {
    while (!target.full()) {
      const auto frame = client->session->advance(now, client->output);
      if (!frame) {
        break;
      }
      deliver(*frame, *client, target);
    }
  }
  std::uint64_t expirations = 0;
  std::ignore = ::read(timer_.get(), &expirations, sizeof expirations);
  timer_set_to_.reset();
}

void CanStreamLink::set_timer() {
  std::optional<MachineTime> earliest;
  for (const auto& client : clients_) {
    if (const auto deadline = client->session->deadline()) {
      earliest = earliest ? std::min(*earliest, *deadline) : *deadline;
    }
  }
  if (earliest == timer_set_to_) {
    return;
  }
  timer_set_to_ = earliest;
  itimerspec setting{};
  if (earliest) {
    setting.it_value = to_timespec(*earliest);
  }
  ::timerfd_settime(timer_.get(), TFD_TIMER_ABSTIME, &setting, nullptr);
}

void CanStreamLink::read(Client& client) {
  // With this much input not taken yet no more is read: it waits in the system, and finally in the
  // program.
  if (client.input.size() - client.input_taken >= kReadAtOnce) {
    return;
  }
  const std::size_t size = client.input.size();
  client.input.resize(size + kReadAtOnce);
  const ssize_t length = ::read(client.descriptor.get(), client.input.data() + size, kReadAtOnce);
  client.input.resize(size + static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
  if (length == 0 || (length < 0 && errno != EAGAIN && errno != EINTR)) {
    end(client);
    return;
  }
  on_read(client);
}

void CanStreamLink::write(Client& client) {
  while (!client.ended && client.output_sent < client.output.size()) {
    const char* const from = client.output.data() + client.output_sent;
    const std::size_t size = client.output.size() - client.output_sent;
    const ssize_t written = medium_ == Medium::socket
                                ? ::send(client.descriptor.get(), from, size, MSG_NOSIGNAL)
                                : ::write(client.descriptor.get(), from, size);
    if (written > 0) {
      client.output_sent += static_cast<std::size_t>(written);
      continue;
    }
    if (written < 0 && errno != EAGAIN && errno != EINTR) {
      end(client);
      return;
    }
    wait_to_write(client, true);
    if (client.output_sent > kMaximumQueued / 2) {
      client.output.erase(0, client.output_sent);
      client.output_sent = 0;
    }
    return;
  }
  discard_output(client);
  wait_to_write(client, false);
}

void CanStreamLink::wait_to_write(Client& client, bool wait) {
  if (client.waits_to_write == wait || client.ended) {
    return;
  }
  client.waits_to_write = wait;
  epoll_event event{};
  event.events = wait ? EPOLLIN | EPOLLOUT : EPOLLIN;
  event.data.fd = client.descriptor.get();
  ::epoll_ctl(waiting_.get(), EPOLL_CTL_MOD, client.descriptor.get(), &event);
}

void CanStreamLink::restart_client(Client& client) {
  client.session->restart();
  client.input.clear();
  client.input_taken = 0;
  discard_output(client);
  wait_to_write(client, false);
}

void CanStreamLink::discard_output(Client& client) {
  client.output.clear();
  client.output_sent = 0;
  if (client.output.capacity() > kKeptCapacity) {
    client.output.shrink_to_fit();
  }
}

/// Discards the output before `answered` but for the rest of a line of which a part has been sent.
void CanStreamLink::restart_output(Client& client, std::size_t answered) {
  std::size_t keep = client.output_sent;
  if (keep > 0 && keep < answered && client.output[keep - 1] != kEndOfLine) {
    keep = std::min(client.output.find(kEndOfLine, keep), answered - 1) + 1;
  }
  if (keep < answered) {
    client.output.erase(keep, answered - keep);
  }
}

void CanStreamLink::put(Client& client, const can::Frame& frame, base::SimTime time) {
  const std::size_t size = client.output.size();
  client.session->put(frame, time + options_.epoch, client.output);
  if (client.output.size() - client.output_sent > kMaximumQueued) {
    client.output.resize(size);
    client.session->note_lost_frame();
    ++statistics_.frames_dropped;
  }
}

void CanStreamLink::send(const can::Frame& frame, base::SimTime time) {
  ++statistics_.frames_sent;
  for (const auto& client : clients_) {
    put(*client, frame, time);
  }
}

void CanStreamLink::send_error(const ErrorFrame& error, base::SimTime time) {
  for (const auto& client : clients_) {
    if (client->output.size() - client->output_sent <= kMaximumQueued) {
      client->session->put_error(error, time + options_.epoch, client->output);
    }
  }
}

void CanStreamLink::flush() {
  for (const auto& client : clients_) {
    if (!client->waits_to_write && client->output_sent < client->output.size()) {
      write(*client);
    }
  }
}

void CanStreamLink::end(Client& client) {
  if (!client.ended) {
    ::epoll_ctl(waiting_.get(), EPOLL_CTL_DEL, client.descriptor.get(), nullptr);
    client.ended = true;
  }
}

/// `all_taken`: what is left of a client's input is the beginning of a message.
void CanStreamLink::remove_ended(bool all_taken) {
  std::erase_if(clients_, [&](const auto& client) {
    const bool finished = client->ended && (all_taken || client->input.empty());
    if (finished) {
      statistics_.malformed += client->session->malformed();
    }
    return finished;
  });
}

CanLinkStatistics CanStreamLink::statistics() const {
  CanLinkStatistics statistics = statistics_;
  statistics.clients = clients_.size();
  for (const auto& client : clients_) {
    statistics.malformed += client->session->malformed();
  }
  return statistics;
}

}  // namespace stator::link
