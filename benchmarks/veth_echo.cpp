#include "veth_echo.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/time.h>

#include "link/veth_namespace.hpp"
#include "stator/link/ethernet/machine.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::benchmarks {

namespace {

using link::VethNamespace;

constexpr unsigned kMasterProcessor = 0;
constexpr std::uint16_t kEtherType = 0x88A4;
constexpr base::SimDuration kStopInterval(100'000'000);

/// An AF_PACKET socket and nothing else; blocking calls return after kStopInterval.
link::FileDescriptor open_bare_socket(const std::string& interface) {
  link::FileDescriptor socket(::socket(AF_PACKET, SOCK_RAW, 0));
  const int one = 1;
  ::setsockopt(socket.get(), SOL_PACKET, PACKET_IGNORE_OUTGOING, &one, sizeof one);
  const timeval limit{.tv_sec = 0, .tv_usec = kStopInterval.nanoseconds() / 1000};
  ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(kEtherType);
  address.sll_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw std::runtime_error("cannot bind a raw socket to " + interface);
  }
  return socket;
}

link::WaitMode wait_mode(Placement placement) {
  return placement == Placement::block_same_core ? link::WaitMode::block : link::WaitMode::spin;
}

void pin(unsigned processor) {
  if (const auto pinned = link::pin_this_thread(processor); !pinned) {
    throw std::runtime_error(pinned.error().text);
  }
}

std::unique_ptr<link::RawEthernetLink> open_link(const std::string& interface,
                                                 link::WaitMode wait) {
  auto opened = link::RawEthernetLink::open({.interface = interface, .wait = wait});
  if (!opened) {
    throw std::runtime_error(opened.error().text);
  }
  return std::move(*opened);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void bare_echo(const PeerEnd& end) {
  const link::FileDescriptor socket = open_bare_socket(end.interface);
  const int flags = end.wait == link::WaitMode::spin ? MSG_DONTWAIT : 0;
  std::array<std::byte, link::kMaximumFrameLength> frame;
  while (!end.stop.load(std::memory_order_relaxed)) {
    const ssize_t length = ::recv(socket.get(), frame.data(), frame.size(), flags);
    if (length > 0) {
      ::send(socket.get(), frame.data(), static_cast<std::size_t>(length), 0);
    }
  }
}

Peer link_echo(std::function<bool(std::span<std::byte>)> handle) {
  return [handle = std::move(handle)](const PeerEnd& end) {
    const auto link = open_link(end.interface, end.wait);
    std::array<std::byte, link::kMaximumFrameLength> buffer;
    while (!end.stop.load(std::memory_order_relaxed)) {
      const auto length = link->receive(buffer, kStopInterval);
      if (length && *length != 0 && handle(std::span(buffer).first(*length))) {
        static_cast<void>(link->send(std::span(buffer).first(*length)));
      }
    }
  };
}

RoundTrip::RoundTrip(const Peer& peer, Placement placement) : placement_(placement) {
  std::string reason;
  veth_ = VethNamespace::create(reason);
  if (veth_ == nullptr) {
    throw std::runtime_error(reason);
  }
  const unsigned far_processor =
      placement == Placement::block_same_core ? kMasterProcessor : kMasterProcessor + 1;
  if (far_processor >= std::thread::hardware_concurrency()) {
    throw std::runtime_error("needs two processors");
  }
  near_socket_ = open_bare_socket(VethNamespace::kFirst);
  far_end_ = std::thread([this, peer, placement, far_processor] {
    pin(far_processor);
    peer({.interface = VethNamespace::kSecond, .wait = wait_mode(placement), .stop = stop_});
  });
}

RoundTrip::~RoundTrip() {
  stop_ = true;
  far_end_.join();
}

/// Sends the frame and waits for the answer; again if the far end was not ready for it yet.
void RoundTrip::exchange(std::span<const std::byte> frame) {
  const int flags = placement_ == Placement::spin_other_core ? MSG_DONTWAIT : 0;
  std::array<std::byte, link::kMaximumFrameLength> answer;
  ::send(near_socket_.get(), frame.data(), frame.size(), 0);
  const auto start = std::chrono::steady_clock::now();
  for (unsigned looks = 1; ::recv(near_socket_.get(), answer.data(), answer.size(), flags) <= 0;
       ++looks) {
    const bool look_at_clock = flags == 0 || looks % 1024 == 0;
    if (look_at_clock && std::chrono::steady_clock::now() - start > std::chrono::seconds(1)) {
      throw std::runtime_error("the far end does not answer");
    }
  }
}

double RoundTrip::run(std::span<const std::byte> frame, std::size_t count) {
  std::exception_ptr failure;
  double seconds = 0;
  // A thread of its own, so that the caller's stays unpinned.
  std::thread([&] {
    try {
      pin(kMasterProcessor);
      wait_for_far_end(frame);
      const auto start = std::chrono::steady_clock::now();
      for (std::size_t i = 0; i < count; ++i) {
        exchange(frame);
      }
      seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    } catch (...) {
      failure = std::current_exception();
    }
  }).join();
  if (failure) {
    std::rethrow_exception(failure);
  }
  return static_cast<double>(count) / seconds;
}

/// Frames sent before the far end has opened its socket are lost.
void RoundTrip::wait_for_far_end(std::span<const std::byte> frame) {
  std::array<std::byte, link::kMaximumFrameLength> answer;
  for (int attempt = 0; attempt < 20; ++attempt) {
    ::send(near_socket_.get(), frame.data(), frame.size(), 0);
    if (::recv(near_socket_.get(), answer.data(), answer.size(), 0) > 0) {
      return;
    }
  }
  throw std::runtime_error("the far end does not answer");
}

std::vector<double> compare(std::span<const Peer> peers, Placement placement,
                            std::span<const std::byte> frame, std::size_t rounds,
                            std::size_t count) {
  std::vector<std::vector<double>> rates(peers.size());
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < peers.size(); ++i) {
      rates[i].push_back(RoundTrip(peers[i], placement).run(frame, count));
    }
  }
  std::vector<double> medians;
  std::ranges::transform(rates, std::back_inserter(medians), median);
  return medians;
}

}  // namespace stator::benchmarks
