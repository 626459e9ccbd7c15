#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/sim_time.hpp"
#include "ethercat/register_table.hpp"

namespace stator::ethercat {

/// When a frame reached a slave: its first bit at port 0 on the way out and at port 1 on the way
/// back. Port 1 counts only if it is open.
struct FrameTiming {
  base::SimTime port0;
  base::SimTime port1;
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

  /// Stores the receive times of a frame with a write to 0x0900.
  void latch_receive_times(const FrameTiming& timing, bool port1_open);

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
