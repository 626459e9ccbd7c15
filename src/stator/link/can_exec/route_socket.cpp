#include "stator/link/can_exec/route_socket.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <linux/rtnetlink.h>
#include <unistd.h>

#include "stator/link/can_exec/system_calls.hpp"

namespace stator::link::can_exec {

namespace {

using Kind = LinkQuestion::Kind;

/// Linux makes datagrams of listings no longer than this for programs that do not ask for more.
constexpr std::size_t kLongestDatagram = 8192;
/// Programs that give up waiting leave questions behind.
constexpr std::size_t kMostPending = 16;

/// The next datagram of the kernel, which stays where it is. Nothing: `error` says why.
std::optional<std::vector<std::byte>> peek(int descriptor, int flags, int& error) {
  const int modes = MSG_PEEK | (flags & MSG_DONTWAIT);
  std::byte none{};
  const ssize_t size = STATOR_SYSTEM(recv)(descriptor, &none, 0, modes | MSG_TRUNC);
  std::vector<std::byte> datagram(size < 0 ? 0 : static_cast<std::size_t>(size));
  if (size < 0 || STATOR_SYSTEM(recv)(descriptor, datagram.data(), datagram.size(), modes) < 0) {
    error = errno;
    return std::nullopt;
  }
  return datagram;
}

void consume(int descriptor) {
  std::byte none{};
  STATOR_SYSTEM(recv)(descriptor, &none, 0, MSG_DONTWAIT);
}

std::size_t room(const msghdr& message) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < message.msg_iovlen; ++i) {
    size += message.msg_iov[i].iov_len;
  }
  return size;
}

}  // namespace

void RouteSocket::note(std::span<const std::byte> datagram) {
  std::size_t offset = 0;
  std::size_t begin = 0;
  while (const auto header = take_header(datagram, offset)) {
    const LinkQuestion question = read_question(datagram.subspan(begin, header->nlmsg_len));
    begin = offset;
    const std::scoped_lock lock(mutex_);
    // A new request with the same sequence number replaces the old question.
    std::erase_if(pending_,
                  [&](const Pending& each) { return each.sequence == header->nlmsg_seq; });
    if (question.kind == Kind::none) {
      continue;
    }
    if (pending_.size() == kMostPending) {
      pending_.erase(pending_.begin());
    }
    pending_.push_back({.sequence = header->nlmsg_seq,
                        .question = question,
                        .acknowledge = (header->nlmsg_flags & NLM_F_ACK) != 0});
  }
}

bool RouteSocket::awaits_answers() {
  const std::scoped_lock lock(mutex_);
  return !pending_.empty();
}

RouteSocket::Place RouteSocket::find_ended(std::span<const std::byte> datagram, nlmsghdr& end) {
  std::size_t offset = 0;
  while (const auto header = take_header(datagram, offset)) {
    if (header->nlmsg_type != NLMSG_DONE && header->nlmsg_type != NLMSG_ERROR) {
      continue;
    }
    const auto found = std::ranges::find(pending_, header->nlmsg_seq, &Pending::sequence);
    if (found != pending_.end()) {
      end = *header;
      return found;
    }
  }
  return pending_.end();
}

void RouteSocket::prepare(Pending& pending, const nlmsghdr& end) {
  pending.answers.emplace();
  if (pending.question.kind == Kind::one) {
    pending.answers->push_back(link_message(*pending.question.bus, end, 0));
  } else if (pending.question.kind == Kind::listing && end.nlmsg_type == NLMSG_DONE) {
    for (const Bus& bus : buses()) {
      pending.answers->push_back(link_message(bus, end, NLM_F_MULTI));
    }
  }
}

ssize_t RouteSocket::receive(int descriptor, msghdr& message, int flags) {
  if (!awaits_answers()) {
    return STATOR_SYSTEM(recvmsg)(descriptor, &message, flags);
  }
  int error = 0;
  const auto datagram = peek(descriptor, flags, error);
  if (!datagram) {
    errno = error;
    return -1;
  }
  const std::scoped_lock lock(mutex_);
  nlmsghdr end{};
  const auto found = find_ended(*datagram, end);
  if (found == pending_.end()) {
    return STATOR_SYSTEM(recvmsg)(descriptor, &message, flags);
  }
  if (!found->answers) {
    prepare(*found, end);
  }
  const bool looks_only = (flags & MSG_PEEK) != 0;
  ssize_t size = 0;
  if (found->given < found->answers->size()) {
    size = give_answers(*found, message, flags);
    // The kernel's error, which the answer stands for, is not for the program.
    const bool complete = found->question.kind == Kind::one && !found->acknowledge;
    if (!looks_only && complete) {
      consume(descriptor);
      pending_.erase(found);
    }
    return size;
  }
  size = give_end(descriptor, *found, end, message, flags);
  if (!looks_only) {
    pending_.erase(found);
  }
  return size;
}

/// As many of the messages as go into one datagram.
ssize_t RouteSocket::give_answers(Pending& pending, msghdr& message, int flags) {
  const bool looks_only = (flags & MSG_PEEK) != 0;
  // With MSG_PEEK a program asks how large its buffer must be, so its present size is no limit.
  const std::size_t longest =
      looks_only ? kLongestDatagram : std::min(room(message), kLongestDatagram);
  std::string datagram;
  std::size_t next = pending.given;
  while (next < pending.answers->size() &&
         (datagram.empty() || datagram.size() + (*pending.answers)[next].size() <= longest)) {
    datagram += (*pending.answers)[next++];
  }
  if (!looks_only) {
    pending.given = next;
  }
  return hand_over(std::as_bytes(std::span(datagram)), message, flags);
}

/// The end of the kernel's answer, as it is where there is such an interface.
ssize_t RouteSocket::give_end(int descriptor, const Pending& pending, const nlmsghdr& end,
                              msghdr& message, int flags) {
  if (pending.question.kind == Kind::listing) {
    return STATOR_SYSTEM(recvmsg)(descriptor, &message, flags);
  }
  int error = 0;
  auto datagram = peek(descriptor, MSG_DONTWAIT, error);
  if (!datagram || datagram->size() < NLMSG_HDRLEN + sizeof(int)) {
    return STATOR_SYSTEM(recvmsg)(descriptor, &message, flags);
  }
  // The acknowledgement repeats only the head of the request, and does not hold the kernel's
  // refusal.
  nlmsghdr header = end;
  header.nlmsg_flags = NLM_F_CAPPED;
  header.nlmsg_len = NLMSG_HDRLEN + sizeof(nlmsgerr);
  if (pending.question.kind == Kind::empty) {
    header.nlmsg_type = NLMSG_DONE;
    header.nlmsg_flags = NLM_F_MULTI;
    header.nlmsg_len = NLMSG_HDRLEN + sizeof(int);
  }
  header.nlmsg_len = std::min(header.nlmsg_len, static_cast<std::uint32_t>(datagram->size()));
  const int result = -pending.question.error;
  std::memcpy(datagram->data(), &header, sizeof header);
  std::memcpy(datagram->data() + NLMSG_HDRLEN, &result, sizeof result);
  if ((flags & MSG_PEEK) == 0) {
    consume(descriptor);
  }
  return hand_over(std::span(*datagram).first(header.nlmsg_len), message, flags);
}

/// Copies to where the program wants it, as recvmsg() does.
ssize_t RouteSocket::hand_over(std::span<const std::byte> datagram, msghdr& message,
                               int flags) const {
  std::size_t copied = 0;
  for (std::size_t i = 0; i < message.msg_iovlen && copied < datagram.size(); ++i) {
    const iovec& part = message.msg_iov[i];
    const std::size_t length = std::min(part.iov_len, datagram.size() - copied);
    std::memcpy(part.iov_base, datagram.data() + copied, length);
    copied += length;
  }
  if (message.msg_name != nullptr) {
    sockaddr_nl kernel{};
    kernel.nl_family = AF_NETLINK;
    std::memcpy(message.msg_name, &kernel,
                std::min<std::size_t>(message.msg_namelen, sizeof kernel));
    message.msg_namelen = sizeof kernel;
  }
  message.msg_controllen = 0;
  message.msg_flags = copied < datagram.size() ? MSG_TRUNC : 0;
  return static_cast<ssize_t>((flags & MSG_TRUNC) != 0 ? datagram.size() : copied);
}

}  // namespace stator::link::can_exec
