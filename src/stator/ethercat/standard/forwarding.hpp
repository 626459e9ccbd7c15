// How EtherCAT slaves forward a frame between their ports: open ports, delays, arrival times.
#pragma once

#include <array>
#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::ethercat {

inline constexpr unsigned kPortsPerSlave = 4;

/// What a slave does with frames at present.
struct SlaveForwarding {
  std::uint8_t open_ports = 0;  ///< bit n: loop of port n open; else frames go on to the next port
  std::uint8_t links = 0;       ///< bit n: what leaves port n reaches the other end of the cable
  bool marks_circulating = false;  ///< no link at port 0 and its loop closed by itself
  base::SimDuration delay;         ///< from receiving at one port to sending at the next open one
  std::array<base::SimDuration, kPortsPerSlave> transmit_delay{};  ///< more of what leaves a port
  std::int32_t clock_deviation_ppb = 0;
  std::uint8_t fifo_size = 7;  ///< of the receive FIFOs, 0x0102
};

/// When the first bit of a frame reaches a slave, counted from the master's interface.
struct ArrivalTimes {
  base::SimDuration processing_unit;
  std::array<base::SimDuration, kPortsPerSlave> port{};
  std::uint8_t ports = 0;  ///< bit n: the frame is received at port n
};

}  // namespace stator::ethercat
