#include "master/distributed_clocks.hpp"

#include <array>

#include "master/registers.hpp"
#include "master/text.hpp"

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
  ReceiveTimes times{.port0 = base::load_le<std::uint32_t>(ports.data()),
                     .port1 = base::load_le<std::uint32_t>(ports.data() + 4),
                     .unit = *unit};
  if (slave.ports[1].loop_closed) {
    times.port1 = times.port0;
  }
  return times;
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
  for (std::size_t i = 1; i < slaves.size(); ++i) {
    // Unsigned subtraction takes the wrap of the 32-bit times along.
    const std::uint32_t before = slaves[i - 1].port1 - slaves[i - 1].port0;
    const std::uint32_t behind = slaves[i].port1 - slaves[i].port0;
    delays[i] = delays[i - 1] + (before > behind ? (before - behind) / 2 : 0);
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
  for (const Slave& slave : slaves) {
    if (!slave.ports[2].loop_closed || !slave.ports[3].loop_closed) {
      return fail(ErrorCode::configuration, "the segment branches at slave " +
                                                std::to_string(slave.position) +
                                                "; delays are measured for slaves in line only");
    }
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
