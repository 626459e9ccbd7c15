#include "stator/link/can/can_exec_link.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <tuple>
#include <utility>

#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/timerfd.h>
#include <sys/un.h>
#include <unistd.h>

#include "stator/link/can/socketcan_frame.hpp"
#include "stator/link/system/failure.hpp"

namespace stator::link {

namespace {

constexpr std::size_t kMaximumQueued = std::size_t{16} << 20;
constexpr std::size_t kKeptCapacity = std::size_t{1} << 20;
constexpr int kWaitingConnections = 64;
/// Messages taken from one program before the next one has its turn.
constexpr int kTurn = 64;
constexpr int kRounds = 64;
constexpr std::size_t kLengthSize = sizeof(std::uint16_t);

sockaddr_un to_address(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  return address;
}

std::string_view as_text(const can_frame& frame) {
  return {reinterpret_cast<const char*>(&frame), sizeof frame};
}

}  // namespace

bool passes(const can_filter& filter, const can_frame& frame) {
  const bool inverted = (filter.can_id & CAN_INV_FILTER) != 0;
  const canid_t mask = filter.can_mask & ~CAN_ERR_FLAG;
  const canid_t wanted = filter.can_id & ~CAN_INV_FILTER;
  return ((frame.can_id & mask) == (wanted & mask)) != inverted;
}

base::Expected<std::unique_ptr<CanLink>, LinkError> CanExecLink::open(
    const std::string& name, const CanLinkOptions& options) {
  auto link = std::unique_ptr<CanExecLink>(new CanExecLink(name, options.bit_rate));
  if (const auto listening = link->listen(); !listening) {
    return base::Unexpected{listening.error()};
  }
  return std::unique_ptr<CanLink>(std::move(link));
}

CanExecLink::~CanExecLink() {
  if (!path_.empty()) {
    ::unlink(path_.c_str());
  }
}

base::Expected<void, LinkError> CanExecLink::listen() {
  const std::string directory = can_exec::directory();
  const std::string path = directory + "/" + interface_;
  struct stat status {};
  if (::mkdir(directory.c_str(), S_IRWXU) != 0 && errno != EEXIST) {
    return system_failure("cannot make the directory " + in_quotes(directory), errno);
  }
  // In a directory that everybody may write to, somebody else may have taken the name.
  if (::lstat(directory.c_str(), &status) != 0 || !S_ISDIR(status.st_mode) ||
      status.st_uid != ::getuid() || (status.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
    return fail(LinkErrorCode::not_permitted,
                in_quotes(directory) +
                    " belongs to somebody else or others may write to it; "
                    "remove it");
  }
  const sockaddr_un address = to_address(path);
  const auto bind = [&] {
    return ::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) ==
           0;
  };
  listener_ = FileDescriptor(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  waiting_ = FileDescriptor(::epoll_create1(EPOLL_CLOEXEC));
  timer_ = FileDescriptor(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK));
  if (!bind()) {
    if (errno == EADDRINUSE && is_served()) {
      return fail(LinkErrorCode::address_in_use, "another process serves " + in_quotes(name_) +
                                                     "; end it, or choose another name");
    }
    // Left behind by a process that was killed.
    ::unlink(path.c_str());
    if (!bind()) {
      return system_failure("cannot listen at " + in_quotes(path), errno);
    }
  }
  path_ = path;
  if (::listen(listener_.get(), kWaitingConnections) != 0 || !watch(listener_.get()) ||
      !watch(timer_.get())) {
    return system_failure("cannot listen at " + in_quotes(path), errno);
  }
  return {};
}

bool CanExecLink::is_served() const {
  const sockaddr_un address = to_address(can_exec::directory() + "/" + interface_);
  const FileDescriptor probe(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
  return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

bool CanExecLink::watch(int descriptor) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = descriptor;
  return ::epoll_ctl(waiting_.get(), EPOLL_CTL_ADD, descriptor, &event) == 0;
}

void CanExecLink::accept() {
  auto client = std::make_unique<Client>();
  client->descriptor =
      FileDescriptor(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (client->descriptor.is_open() && watch(client->descriptor.get())) {
    clients_.push_back(std::move(client));
  }
}

CanExecLink::Client* CanExecLink::find(int descriptor) {
  const auto found = std::ranges::find_if(
      clients_, [&](const auto& each) { return each->descriptor.get() == descriptor; });
  return found == clients_.end() ? nullptr : found->get();
}

base::Expected<std::size_t, LinkError> CanExecLink::receive(std::span<can::Frame> frames,
                                                            base::SimTime /*now*/) {
  Target target{.frames = frames};
  deliver_pending(target);
  std::array<epoll_event, 32> events{};
  for (int round = 0; round < kRounds && !target.full(); ++round) {
    const int count = ::epoll_wait(waiting_.get(), events.data(), int{events.size()}, 0);
    if (count < 0 && errno != EINTR) {
      return system_failure("cannot receive from " + in_quotes(name_), errno);
    }
    if (count <= 0) {
      break;
    }
    const auto ready = std::span(events).first(static_cast<std::size_t>(count));
    const auto first = std::ranges::find_if(
        ready, [&](const epoll_event& event) { return event.data.fd == waits_for_room_; });
    std::rotate(ready.begin(), first, ready.end());
    waits_for_room_ = kNobody;
    for (const epoll_event& event : ready) {
      if (event.data.fd == listener_.get()) {
        accept();
      } else if (event.data.fd == timer_.get()) {
        advance(target);
      } else if (Client* const client = find(event.data.fd); client != nullptr) {
        if ((event.events & EPOLLOUT) != 0) {
          write(*client);
        }
        if (target.full() && waits_for_room_ == kNobody) {
          waits_for_room_ = event.data.fd;
        }
        read(*client, target);
      }
    }
  }
  flush();
  set_timer();
  std::erase_if(clients_, [](const auto& client) { return client->ended; });
  return target.count;
}

void CanExecLink::read(Client& client, Target& target) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): long, and the system fills it
  alignas(can_frame) std::array<std::byte, can_exec::kMaximumMessage> message;
  for (int turn = 0; turn < kTurn && !target.full() && !client.ended; ++turn) {
    const ssize_t size = ::recv(client.descriptor.get(), message.data(), message.size(), 0);
    if (size <= 0) {
      if (size == 0 || (errno != EAGAIN && errno != EINTR)) {
        end(client);
      }
      return;
    }
    take(client, std::span(message).first(static_cast<std::size_t>(size)), target);
  }
}

void CanExecLink::take(Client& client, std::span<const std::byte> message, Target& target) {
  if (configure(client, message)) {
    return;
  }
  if (!client.configuration) {
    ++statistics_.malformed;
    end(client);
    return;
  }
  if (client.configuration->kind == can_exec::SocketKind::inquiry) {
    ++statistics_.malformed;
    return;
  }
  if (client.configuration->kind == can_exec::SocketKind::broadcast_manager) {
    BroadcastManager::Frames to_bus;
    BroadcastManager::Messages to_program;
    const bool done = client.broadcast_manager.execute(message, std::chrono::steady_clock::now(),
                                                       to_bus, to_program);
    statistics_.malformed += done ? 0U : 1U;
    for (const can::Frame& each : to_bus) {
      deliver(each, client, target);
    }
    for (const std::string& each : to_program) {
      queue(client, each, 0);
    }
    return;
  }
  can_frame frame{};
  if (message.size() == sizeof frame) {
    std::memcpy(&frame, message.data(), sizeof frame);
  }
  const auto sent = message.size() == sizeof frame ? from_socketcan(frame) : std::nullopt;
  if (!sent) {
    ++statistics_.malformed;
    return;
  }
  deliver(*sent, client, target);
}

bool CanExecLink::configure(Client& client, std::span<const std::byte> message) {
  can_exec::Configuration configuration;
  if (message.size() < sizeof configuration) {
    return false;
  }
  std::memcpy(&configuration, message.data(), sizeof configuration);
  const std::size_t filters = message.size() - sizeof configuration;
  if (configuration.magic != can_exec::kMagic || configuration.version != can_exec::kVersion ||
      configuration.filter_count > can_exec::kMaximumFilters ||
      filters != configuration.filter_count * sizeof(can_filter)) {
    return false;
  }
  if (configuration.kind == can_exec::SocketKind::inquiry) {
    answer_inquiry(client);
  } else if (!client.configuration) {
    queue(client, {}, can_exec::kConnected);
  }
  client.configuration = configuration;
  client.filters.resize(configuration.filter_count);
  if (filters != 0) {
    std::memcpy(client.filters.data(), message.data() + sizeof configuration, filters);
  }
  return true;
}

void CanExecLink::answer_inquiry(Client& client) {
  const can_exec::PortState state{.bit_rate = bit_rate_ * 1'000,
                                  .frames_received = statistics_.frames_sent,
                                  .bytes_received = bytes_sent_,
                                  .frames_sent = statistics_.frames_received,
                                  .bytes_sent = bytes_received_,
                                  .frames_dropped = statistics_.frames_dropped,
                                  .bus_errors = error_frames_};
  queue(client, {reinterpret_cast<const char*>(&state), sizeof state}, 0);
}

void CanExecLink::deliver(const can::Frame& frame, Client& from, Target& target) {
  ++statistics_.frames_received;
  bytes_received_ += frame.remote ? 0 : frame.length;
  if (target.full()) {
    pending_.push_back(frame);
  } else {
    target.frames[target.count++] = frame;
  }
  const std::uint8_t options = from.configuration->options;
  if ((options & can_exec::kLoopback) == 0) {
    return;
  }
  for (const auto& client : clients_) {
    if (client.get() != &from) {
      put(*client, to_socketcan(frame), can_exec::kFromProgram);
    } else if ((options & can_exec::kReceiveOwn) != 0) {
      put(*client, to_socketcan(frame), can_exec::kFromProgram | can_exec::kOwn);
    }
  }
}

void CanExecLink::deliver_pending(Target& target) {
  std::size_t taken = 0;
  while (taken < pending_.size() && !target.full()) {
    target.frames[target.count++] = pending_[taken++];
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(taken));
}

void CanExecLink::advance(Target& target) {
  std::uint64_t expirations = 0;
  std::ignore = ::read(timer_.get(), &expirations, sizeof expirations);
  timer_set_to_.reset();
  const MachineTime now = std::chrono::steady_clock::now();
  for (const auto& client : clients_) {
    BroadcastManager::Frames to_bus;
    BroadcastManager::Messages to_program;
    client->broadcast_manager.advance(now, to_bus, to_program);
    for (const can::Frame& each : to_bus) {
      deliver(each, *client, target);
    }
    for (const std::string& each : to_program) {
      queue(*client, each, 0);
    }
  }
}

void CanExecLink::set_timer() {
  std::optional<MachineTime> earliest;
  for (const auto& client : clients_) {
    if (const auto deadline = client->broadcast_manager.deadline()) {
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

void CanExecLink::put(Client& client, const can_frame& frame, std::uint32_t flags) {
  if (!client.configuration || client.configuration->kind == can_exec::SocketKind::inquiry) {
    return;
  }
  if (client.configuration->kind == can_exec::SocketKind::broadcast_manager) {
    BroadcastManager::Messages to_program;
    if (const auto received = from_socketcan(frame)) {
      client.broadcast_manager.on_frame(*received, std::chrono::steady_clock::now(), to_program);
    }
    for (const std::string& each : to_program) {
      queue(client, each, flags);
    }
    return;
  }
  if ((frame.can_id & CAN_ERR_FLAG) != 0) {
    if ((frame.can_id & client.configuration->error_mask & CAN_ERR_MASK) != 0) {
      queue(client, as_text(frame), flags);
    }
    return;
  }
  const auto lets_pass = [&](const can_filter& filter) { return passes(filter, frame); };
  const bool joined = (client.configuration->options & can_exec::kJoinFilters) != 0;
  const bool wanted = joined && !client.filters.empty()
                          ? std::ranges::all_of(client.filters, lets_pass)
                          : std::ranges::any_of(client.filters, lets_pass);
  if (wanted) {
    queue(client, as_text(frame), flags);
  }
}

void CanExecLink::queue(Client& client, std::string_view message, std::uint32_t flags) {
  const can_exec::Origin origin{.flags = flags};
  const auto length = static_cast<std::uint16_t>(message.size() + sizeof origin);
  if (client.output.size() - client.output_sent + kLengthSize + length > kMaximumQueued) {
    ++statistics_.frames_dropped;
    return;
  }
  client.output.append(reinterpret_cast<const char*>(&length), kLengthSize);
  client.output += message;
  client.output.append(reinterpret_cast<const char*>(&origin), sizeof origin);
}

void CanExecLink::write(Client& client) {
  while (!client.ended && client.output_sent < client.output.size()) {
    std::uint16_t length = 0;
    std::memcpy(&length, client.output.data() + client.output_sent, kLengthSize);
    if (::send(client.descriptor.get(), client.output.data() + client.output_sent + kLengthSize,
               length, MSG_NOSIGNAL) < 0) {
      if (errno != EAGAIN && errno != EINTR) {
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
    client.output_sent += kLengthSize + length;
  }
  client.output.clear();
  client.output_sent = 0;
  if (client.output.capacity() > kKeptCapacity) {
    client.output.shrink_to_fit();
  }
  wait_to_write(client, false);
}

void CanExecLink::wait_to_write(Client& client, bool wait) {
  if (client.waits_to_write == wait || client.ended) {
    return;
  }
  client.waits_to_write = wait;
  epoll_event event{};
  event.events = wait ? EPOLLIN | EPOLLOUT : EPOLLIN;
  event.data.fd = client.descriptor.get();
  ::epoll_ctl(waiting_.get(), EPOLL_CTL_MOD, client.descriptor.get(), &event);
}

void CanExecLink::end(Client& client) {
  if (!client.ended) {
    ::epoll_ctl(waiting_.get(), EPOLL_CTL_DEL, client.descriptor.get(), nullptr);
    client.ended = true;
  }
}

void CanExecLink::send(const can::Frame& frame, base::SimTime /*time*/) {
  ++statistics_.frames_sent;
  bytes_sent_ += frame.remote ? 0 : frame.length;
  const can_frame message = to_socketcan(frame);
  for (const auto& client : clients_) {
    put(*client, message, 0);
  }
}

void CanExecLink::send_error(const ErrorFrame& error, base::SimTime /*time*/) {
  ++error_frames_;
  const can_frame message = to_socketcan(error);
  for (const auto& client : clients_) {
    put(*client, message, 0);
  }
}

void CanExecLink::flush() {
  for (const auto& client : clients_) {
    if (!client->waits_to_write && client->output_sent < client->output.size()) {
      write(*client);
    }
  }
}

CanLinkStatistics CanExecLink::statistics() const {
  CanLinkStatistics statistics = statistics_;
  statistics.clients =
      static_cast<std::size_t>(std::ranges::count_if(clients_, [](const auto& each) {
        return !each->configuration || each->configuration->kind != can_exec::SocketKind::inquiry;
      }));
  return statistics;
}

std::string CanExecLink::usage() const {
  return "stator can-exec -- candump " + interface_;
}

}  // namespace stator::link
