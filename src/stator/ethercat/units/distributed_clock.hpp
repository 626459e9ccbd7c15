#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/registers/register_table.hpp"
#include "stator/ethercat/standard/forwarding.hpp"

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
///
/// Between two comparisons with the reference the clock runs on a straight line, or on two while a
/// difference is being slewed away, and never backwards. Moments of system time can therefore be
/// turned into simulated time exactly, see when().
class DistributedClock {
 public:
  DistributedClock(std::span<std::byte, kRegisterSpace> registers, std::int32_t deviation_ppb)
      : registers_(registers), deviation_ppb_(deviation_ppb) {}

  /// Power-on at `now`: the local clock starts from 0 and the loop forgets what it has learned.
  void reset(base::SimTime now);

  /// The oscillator runs fast by so much from `now` on.
  void set_deviation(std::int32_t ppb, base::SimTime now);

  [[nodiscard]] std::uint64_t local_time(base::SimTime t) const;
  [[nodiscard]] std::uint64_t system_time(base::SimTime t) const { return local_time(t) + offset_; }
  /// System time as a frame that begins at `t` reads it: when it passed the reference clock.
  [[nodiscard]] std::uint64_t bus_time(base::SimTime t) const { return system_time(t) - delay_; }
  /// The first moment from `from` on at which the system time is `system_time` or later, as the
  /// clock runs now; never() if that is more than 146 years away.
  [[nodiscard]] base::SimTime when(std::uint64_t system_time, base::SimTime from) const;

  /// Stores the receive times of a frame with a write to 0x0900, of those ports that received it.
  void latch_receive_times(const FrameTiming& timing);

  /// A master or reference clock wrote `received` (its low 32 bits) to 0x0910 in the frame that
  /// reached this slave at `t`: measures the difference, shows its mean in 0x092C and corrects
  /// phase and rate, both within what the speed counter allows.
  void compare(std::uint32_t received, base::SimTime t);
  /// The host wrote `received` at `t`: the time by the reference clock (its low 32 bits) at which
  /// the system time here was `latched`. Measures and corrects as compare().
  void compare_latched(std::uint32_t received, std::uint64_t latched, base::SimTime t);

  /// 0x0920 or 0x0928 has been written.
  void take_settings();
  /// 0x0930 has been written at `now`: the loop starts anew with the bandwidth given.
  void reset_loop(base::SimTime now);
  /// 0x0934 has been written at `now`: forgets the mean difference.
  void reset_difference(base::SimTime now);
  /// 0x0935 has been written at `now`: forgets the deviation of the clock period.
  void reset_speed_filter(base::SimTime now);

  /// Writes 0x0932, the deviation of the clock period that the loop compensates: positive if the
  /// local clock by itself is slower than the reference.
  void show_speed_counter_difference();

 private:
  /// ns that the loop's phase correction has added `elapsed` ns after start_, in 1/2^10 ns.
  [[nodiscard]] std::int64_t slewed(std::int64_t elapsed) const;
  /// ns the oscillator has gained over simulated time since start_, in 1/2^10 ns.
  [[nodiscard]] std::int64_t gained(std::int64_t elapsed) const;
  /// Begins a new straight line at `t`, where the present ones have led; returns what has been
  /// slewed.
  std::int64_t restart_line(base::SimTime t);
  /// Takes a difference of local time less reference in ns, `elapsed` ns after the one before;
  /// since then the loop has slewed by `slewed_by`, 1/2^10 ns.
  void take_difference(std::uint32_t difference_ns, std::int64_t elapsed, std::int64_t slewed_by);
  void set_trim(std::int64_t trim);
  void learn_rate(std::int64_t innovation, std::int64_t elapsed);
  void show_difference();

  std::span<std::byte, kRegisterSpace> registers_;
  std::int32_t deviation_ppb_;
  std::uint64_t offset_ = 0;
  std::uint64_t delay_ = 0;

  // The line: local time is start_time_ + start_fraction_ / 2^10 ns at start_.
  base::SimTime start_;
  std::uint64_t start_time_ = 0;
  std::int64_t start_fraction_ = 0;
  std::int64_t rate_ = 0;         ///< deviation and trim, ppb in 1/2^10
  std::int64_t slew_amount_ = 0;  ///< phase to correct, 1/2^10 ns
  std::int64_t slew_span_ = 0;    ///< ns it takes at most

  // The loop.
  std::int64_t largest_slew_ppb_ = 0;  ///< by 0x0930
  std::int64_t slew_duration_ = 0;     ///< ns to slew one, rounded up
  std::int64_t trim_ = 0;              ///< ppb in 1/2^20
  std::int64_t mean_difference_ = 0;   ///< local less reference, 1/2^16 ns
  bool primed_ = false;                ///< mean_difference_ holds a measurement
};

}  // namespace stator::ethercat
