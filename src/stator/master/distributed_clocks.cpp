#include "stator/master/distributed_clocks.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "stator/master/registers.hpp"
#include "stator/master/text.hpp"

namespace stator::master {

namespace {

constexpr std::uint16_t kSpeedCounterReset = 0x1000;

Result<ReceiveTimes> read_receive_times(Bus& bus, const Slave& slave) {
  const Station station{slave.position, slave.station_address};
  std::array<std::byte, 16> ports{};
  if (const auto done = bus.read(station, registers::kReceiveTimes, ports); !done) {
    return base::Unexpected{done.error()};
  }
  const auto unit = bus.read_number<std::uint64_t>(station, registers::kReceiveTimeUnit);
  if (!unit) {
    return base::Unexpected{unit.error()};
  }
  ReceiveTimes times{.unit = *unit};
  for (std::size_t port = 0; port < times.ports.size(); ++port) {
    times.ports[port] = base::load_le<std::uint32_t>(ports.data() + 4 * port);
    const bool open = port == 0 || !slave.ports[port].loop_closed;
    times.open |= static_cast<std::uint8_t>((open ? 1U : 0U) << port);
  }
  return times;
}

/// A frame inside a slave.
struct Passage {
  std::vector<std::uint32_t> times;  ///< at its open ports, in the order of the frame's way
  std::size_t next = 1;              ///< of them, that no slave behind has been found at
  std::size_t parent = 0;
};

Passage passage_of(const ReceiveTimes& slave) {
  Passage passage;
  for (const unsigned port : {0U, 3U, 1U, 2U}) {  // ETG.1000.4 §4.2
    if (port == 0 || (slave.open >> port & 1U) != 0) {
      passage.times.push_back(slave.ports[port]);
    }
  }
  return passage;
}

Result<void> set_clock(Bus& bus, const Slave& slave, std::uint64_t offset, std::uint32_t delay) {
  const Station station{slave.position, slave.station_address};
  if (auto done = bus.write_number(station, registers::kSystemTimeOffset, offset); !done) {
    return done;
  }
  if (auto done = bus.write_number(station, registers::kSystemTimeDelay, delay); !done) {
    return done;
  }
  // Forgets what the control loop has learned from the former offset.
  return bus.write_number(station, registers::kSpeedCounterStart, kSpeedCounterReset);
}

}  // namespace

std::vector<std::uint32_t> propagation_delays(std::span<const ReceiveTimes> slaves) {
  std::vector<std::uint32_t> delays(slaves.size(), 0);
  std::vector<Passage> passages;
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    passages.push_back(passage_of(slaves[i]));
    if (i == 0) {
      continue;
    }
    // It hangs at the nearest slave before it that has a port left.
    std::size_t parent = i - 1;
    while (parent > 0 && passages[parent].next == passages[parent].times.size()) {
      parent = passages[parent].parent;
    }
    Passage& before = passages[parent];
    Passage& own = passages[i];
    own.parent = parent;
    if (before.next == before.times.size()) {
      continue;  // the receive times do not tell of it
    }
    // Unsigned subtraction takes the wrap of the 32-bit times along.
    const std::uint32_t sent = before.times[before.next - 1];
    const std::uint32_t answer = before.times[before.next++] - sent;
    const std::uint32_t behind = own.times.back() - own.times.front();
    delays[i] = delays[parent] + (sent - before.times.front()) +
                (answer > behind ? (answer - behind) / 2 : 0);
  }
  return delays;
}

Result<std::optional<Station>> synchronize_clocks(Bus& bus, std::span<const Slave> slaves) {
  const std::array<std::byte, 4> latch{};
  if (const auto done = bus.broadcast(registers::kReceiveTimes, latch); !done) {
    return base::Unexpected{done.error()};
  }
  std::vector<const Slave*> clocks;
  std::vector<ReceiveTimes> times;
  const auto branches = [](const Slave& slave) {
    return !slave.ports[2].loop_closed || !slave.ports[3].loop_closed;
  };
  const auto branch = std::ranges::find_if(slaves, branches);
  const auto without = std::ranges::find(slaves, false, &Slave::distributed_clocks);
  if (branch != slaves.end() && without != slaves.end()) {
    return fail(ErrorCode::configuration,
                "the segment branches at slave " + std::to_string(branch->position) +
                    ", and slave " + std::to_string(without->position) +
                    " has no distributed clocks, so that the delays of the branches cannot be told "
                    "apart");
  }
  for (const Slave& slave : slaves) {
    if (slave.distributed_clocks) {
      const auto received = read_receive_times(bus, slave);
      if (!received) {
        return base::Unexpected{received.error()};
      }
      clocks.push_back(&slave);
      times.push_back(*received);
    }
  }
  if (clocks.empty()) {
    return std::optional<Station>();
  }
  const std::vector<std::uint32_t> delays = propagation_delays(times);
  for (std::size_t i = 0; i < clocks.size(); ++i) {
    // The frame passed this slave `delay` after the reference, whose local time is the system time.
    const std::uint64_t offset = times[0].unit + delays[i] - times[i].unit;
    if (const auto done = set_clock(bus, *clocks[i], offset, delays[i]); !done) {
      return base::Unexpected{done.error()};
    }
  }
  return std::optional(Station{clocks[0]->position, clocks[0]->station_address});
}

}  // namespace stator::master
