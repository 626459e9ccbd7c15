#pragma once

#include <cstdint>

#include "stator/base/delegate.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/controller.hpp"
#include "stator/canopen/emergency/emergency_sink.hpp"

namespace stator::canopen {

// Emergency codes about the CAN controller (CiA 301 table 26).
inline constexpr std::uint16_t kCanOverrun = 0x8110;
inline constexpr std::uint16_t kCanErrorPassive = 0x8120;
inline constexpr std::uint16_t kRecoveredFromBusOff = 0x8140;

/// Which buffer lost frames: cause of emergency kCanOverrun.
enum class CanOverrun : std::uint8_t { transmit = 2, receive = 3 };

/// Watches the CAN controller of a node and reports what becomes of it: frames lost (8110h, its
/// first byte of information is the CanOverrun), error passive (8120h), bus-off. Bus-off counts as
/// a communication error (1029h:01); as nothing can be sent then, 8140h follows once the controller
/// is on the bus again.
class ControllerSupervision {
 public:
  ControllerSupervision(const can::Controller& controller, EmergencySink& emergencies,
                        CommunicationErrorReaction& reaction)
      : controller_(controller), emergencies_(emergencies), reaction_(reaction) {}
  ControllerSupervision(const ControllerSupervision&) = delete;
  ControllerSupervision& operator=(const ControllerSupervision&) = delete;

  /// Told when the controller has gone bus-off, before the error behaviour acts.
  void set_bus_off_hook(base::Delegate<void(base::SimTime)> hook) { bus_off_ = hook; }

  /// The node begins anew: what was before is forgotten.
  void start();
  /// Looks at the controller; to be called by the device once per firmware period.
  void poll(base::SimTime now);

 private:
  void follow_error_state(can::ErrorState state, base::SimTime now);
  void follow_losses(CanOverrun buffer, std::uint64_t lost, std::uint64_t& known,
                     base::SimTime now);

  const can::Controller& controller_;
  EmergencySink& emergencies_;
  CommunicationErrorReaction& reaction_;
  base::Delegate<void(base::SimTime)> bus_off_;
  can::ErrorState state_ = can::ErrorState::error_active;
  std::uint64_t transmit_lost_ = 0;
  std::uint64_t receive_lost_ = 0;
};

}  // namespace stator::canopen
