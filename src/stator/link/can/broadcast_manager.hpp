#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <linux/can/bcm.h>

#include "stator/can/frame.hpp"
#include "stator/link/system/machine_time.hpp"

namespace stator::link {

/// The head of all messages: bcm_msg_head without the frames that follow.
struct BroadcastHead {
  std::uint32_t opcode = 0;
  std::uint32_t flags = 0;
  std::uint32_t count = 0;
  bcm_timeval ival1{};
  bcm_timeval ival2{};
  canid_t can_id = 0;
  std::uint32_t nframes = 0;
};
static_assert(sizeof(BroadcastHead) == sizeof(bcm_msg_head));

/// What Linux's broadcast manager (CAN_BCM) does for one socket: sends frames cyclically and tells
/// when frames change or stay away. Messages are those of <linux/can/bcm.h>.
///
/// Left out: multiplexed filters (more than one frame with RX_SETUP) and throttling (ival2 there).
class BroadcastManager {
 public:
  using Frames = std::vector<can::Frame>;
  using Messages = std::vector<std::string>;

  /// Executes what a program wrote. False: it is none of the commands, or wrong.
  bool execute(std::span<const std::byte> message, MachineTime now, Frames& to_bus,
               Messages& to_program);
  /// A frame was on the bus.
  void on_frame(const can::Frame& frame, MachineTime now, Messages& to_program);
  [[nodiscard]] std::optional<MachineTime> deadline() const;
  void advance(MachineTime now, Frames& to_bus, Messages& to_program);

 private:
  using Interval = std::chrono::microseconds;
  struct Transmission {
    BroadcastHead head;
    std::vector<can_frame> frames;
    std::size_t index = 0;
    std::uint32_t remaining = 0;  ///< of the first `count`, sent at the first interval
    std::optional<MachineTime> next;
  };
  struct Reception {
    BroadcastHead head;
    std::optional<can_frame> mask;
    std::optional<can_frame> last;
    bool timed_out = false;
    std::optional<MachineTime> timeout;
  };

  bool set_up_transmission(const BroadcastHead& head, std::vector<can_frame> frames,
                           MachineTime now, Frames& to_bus);
  bool set_up_reception(const BroadcastHead& head, const std::vector<can_frame>& frames,
                        MachineTime now);
  static void transmit(Transmission& transmission, Frames& to_bus);
  static void schedule(Transmission& transmission, MachineTime from);

  std::vector<Transmission> transmissions_;
  std::vector<Reception> receptions_;
};

}  // namespace stator::link
