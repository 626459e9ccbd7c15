#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/sim_time.hpp"
#include "ethercat/register_table.hpp"
#include "ethercat/topology.hpp"

namespace stator::ethercat {

/// When the first bit of a frame reached the ports and the processing unit of a slave.
struct FrameTiming {
  base::SimTime sent;             ///< when it left the master
  base::SimTime processing_unit;  ///< at hand, because every frame needs it
  const ArrivalTimes& arrivals;

  [[nodiscard]] bool received_at(unsigned port) const { return (arrivals.ports >> port & 1U) != 0; }
  [[nodiscard]] base::SimTime port(unsigned port) const { return sent + arrivals.port[port]; }
};

/// Local clock and system time of a slave (ETG.1000.4 §6.6; registers 0x0900..0x0935). Works on the
/// controller's register memory.
///
/// Local time is what the oscillator counts, at a rate that the control loop trims: it starts at 0
/// at power-on. System time = local time + offset (0x0920). The bus sees it less the propagation
/// delay (0x0928), i.e. the time at which the frame passed the reference clock.
class DistributedClock {
 public:
  DistributedClock(std::span<std::byte, kRegisterSpace> registers, std::int32_t deviation_ppb)
      : registers_(registers), deviation_ppb_(deviation_ppb) {}

  /// Power-on at `now`: the local clock starts from 0.
  void reset(base::SimTime now);

  [[nodiscard]] std::uint64_t local_time(base::SimTime t) const;
  [[nodiscard]] std::uint64_t system_time(base::SimTime t) const;

  /// Writes system time at `t` into 0x0910; for the bus less the propagation delay.
  void show_system_time(base::SimTime t, bool for_bus);

  /// Stores the receive times of a frame with a write to 0x0900, of those ports that received it.
  void latch_receive_times(const FrameTiming& timing);

  /// A master or reference clock wrote `received` (its low 32 bits) to 0x0910 in the frame that
  /// reached this slave at `t`: measures the difference, shows the filtered one in 0x092C and slews
  /// the clock by no more than the speed counter allows.
  void compare(std::uint32_t received, base::SimTime t);

  /// Forgets the filtered difference (write to 0x0930 or 0x0934).
  void reset_filter();

 private:
  [[nodiscard]] std::uint64_t offset() const;
  [[nodiscard]] std::uint32_t delay() const;
  void show_difference();

  std::span<std::byte, kRegisterSpace> registers_;
  std::int32_t deviation_ppb_;
  base::SimTime power_on_;
  base::SimTime last_compare_;
  std::int64_t correction_ = 0;           ///< ns the loop has added to local time
  std::int64_t filtered_difference_ = 0;  ///< in 1/2^16 ns
  bool filter_primed_ = false;
};

}  // namespace stator::ethercat
