// A bus without devices, for tests: relays frames between the ports named on the command line and
// answers what tests need answered. Prints how to connect to each, then "ready".
//
//   can_relay [--echo] [--burst N] PORT...
//
// --echo: each frame comes back to its port with the identifier plus one.
// --burst N: a frame with the identifier 7FEh lets N frames go to the port it came from, unpaced.

#include <array>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>
#include <vector>

#include <poll.h>
#include <sys/prctl.h>

#include "stator/base/byte_order.hpp"
#include "stator/link/can/can_link.hpp"

namespace {

using namespace stator;

constexpr std::uint32_t kBurstRequest = 0x7FE;
constexpr std::uint32_t kBurstIdentifier = 0x123;

struct Relay {
  bool echo = false;
  std::uint32_t burst = 0;
  std::vector<std::unique_ptr<link::CanLink>> links;

  void take(const can::Frame& frame, link::CanLink& from, base::SimTime now) {
    if (burst != 0 && frame.identifier == kBurstRequest && !frame.remote) {
      for (std::uint32_t i = 0; i < burst; ++i) {
        std::array<std::byte, 8> data{};
        base::store_le(data, 0, i);
        from.send(can::data_frame(kBurstIdentifier, data), now);
      }
      return;
    }
    if (echo) {
      can::Frame answer = frame;
      ++answer.identifier;
      from.send(answer, now);
    }
    for (const auto& each : links) {
      if (each.get() != &from) {
        each->send(frame, now);
      }
    }
  }

  bool service(link::CanLink& from, base::SimTime now) {
    std::array<can::Frame, 256> frames;
    std::size_t count = frames.size();
    while (count == frames.size()) {
      const auto received = from.receive(frames, now);
      if (!received) {
        std::fprintf(stderr, "%s\n", received.error().text.c_str());
        return false;
      }
      count = *received;
      for (std::size_t i = 0; i < count; ++i) {
        take(frames[i], from, now);
      }
    }
    return true;
  }
};

base::SimTime machine_time() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return base::SimTime(base::SimDuration(std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec));
}

volatile std::sig_atomic_t ended = 0;

}  // namespace

int main(int argc, char** argv) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  struct sigaction action {};
  action.sa_handler = [](int) { ended = 1; };
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGINT, &action, nullptr);
  Relay relay;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--echo") {
      relay.echo = true;
    } else if (argument == "--burst" && i + 1 < argc) {
      const std::string_view number = argv[++i];
      std::from_chars(number.data(), number.data() + number.size(), relay.burst);
    } else {
      auto opened = link::open_can_link(argument);
      if (!opened) {
        std::fprintf(stderr, "%s\n", opened.error().text.c_str());
        return EXIT_FAILURE;
      }
      std::printf("%s\n", (*opened)->name().c_str());
      relay.links.push_back(std::move(*opened));
    }
  }
  std::printf("ready\n");
  std::fflush(stdout);

  std::vector<pollfd> waiting;
  for (const auto& each : relay.links) {
    waiting.push_back({.fd = each->descriptor(), .events = POLLIN, .revents = 0});
  }
  while (ended == 0) {
    ::poll(waiting.data(), waiting.size(), -1);
    const base::SimTime now = machine_time();
    for (const auto& each : relay.links) {
      if (!relay.service(*each, now)) {
        return EXIT_FAILURE;
      }
    }
    for (const auto& each : relay.links) {
      each->flush();
    }
  }
  for (const auto& each : relay.links) {
    const auto statistics = each->statistics();
    std::fprintf(stderr, "%s: %llu in, %llu out, %llu dropped, %llu malformed\n",
                 each->name().c_str(), static_cast<unsigned long long>(statistics.frames_received),
                 static_cast<unsigned long long>(statistics.frames_sent),
                 static_cast<unsigned long long>(statistics.frames_dropped),
                 static_cast<unsigned long long>(statistics.malformed));
  }
  return EXIT_SUCCESS;
}
