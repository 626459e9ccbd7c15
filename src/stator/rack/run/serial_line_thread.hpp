#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include "stator/link/serial/serial_link.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "stator/rack/run/bus_thread.hpp"
#include "stator/rack/run/master_seat.hpp"
#include "stator/rack/run/running_rack.hpp"

namespace stator::rack {

/// What one line's thread did so far.
struct SerialLineThreadStatistics {
  SerialLineStatistics line;
  link::SerialLinkStatistics link;
  std::uint64_t overruns = 0;  ///< times the rack lagged behind the clock by > kOverrun
  std::int64_t worst_lag_ns = 0;
};

/// Runs one serial line of a rack on its link: a thread that sleeps until a program has sent
/// something or until a device of the line does something on its own.
///
/// With the real clock the rack is brought to the moment at which bytes come, the devices get them,
/// and what they answer at once is sent before the thread looks for more. In lockstep nine bytes,
/// one telegram, move time by the step, however they are cut into pieces on their way, and time
/// moves on until the answer has passed. A device that looks at its interface in its next period
/// only (TMCM-3315, TMCC160) moves no time: it answers when its master does.
class SerialLineThread {
 public:
  /// Opens the line's link. Throws std::runtime_error with the link's own explanation. The threads
  /// in `buses`, some of them null, are woken when something is to happen on their bus.
  SerialLineThread(RunningRack& shared, std::size_t index,
                   const std::vector<std::unique_ptr<BusThread>>& buses);
  ~SerialLineThread();
  SerialLineThread(const SerialLineThread&) = delete;
  SerialLineThread& operator=(const SerialLineThread&) = delete;

  void start();
  /// Ends the thread and waits for it; may be called twice.
  void stop();
  /// Lets the thread look at once at what there is to do. From any thread.
  void wake() noexcept { link_->wake(); }

  /// Has what devices send go to the link, as it does from the beginning; for who had it go
  /// elsewhere. The rack is held.
  void connect();
  /// Guarded by the rack's mutex.
  [[nodiscard]] MasterSeat& seat() { return seat_; }

  /// What programs open.
  [[nodiscard]] const link::SerialLink& link() const { return *link_; }
  [[nodiscard]] SerialLineThreadStatistics statistics();
  /// For queued tasks, which run while the rack is held; without those of the link.
  [[nodiscard]] SerialLineThreadStatistics statistics_in_task() const;

 private:
  void run();
  void take(std::span<const std::byte> bytes);
  void put_in_lockstep(std::span<const std::byte> bytes);
  void wake_buses(base::SimTime before);
  void catch_up();
  void plan();
  void send(std::span<const std::byte> bytes);
  void tell_losses();

  RunningRack& shared_;
  std::size_t index_;
  const SerialLine& line_;
  const std::vector<std::unique_ptr<BusThread>>& buses_;
  std::unique_ptr<link::SerialLink> link_;
  std::size_t room_ = 0;             ///< bytes to be taken from the link next
  base::SimDuration time_to_sleep_;  ///< before the rack is to be looked at again
  base::SimTime last_wait_;          ///< when bytes waited for a device last
  std::size_t bytes_in_step_ = 0;    ///< lockstep: of the nine that move time
  bool send_failure_logged_ = false;
  bool loss_logged_ = false;
  SerialLineThreadStatistics statistics_;
  MasterSeat seat_;
  std::thread thread_;
};

}  // namespace stator::rack
