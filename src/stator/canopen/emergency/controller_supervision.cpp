#include "stator/canopen/emergency/controller_supervision.hpp"

namespace stator::canopen {

void ControllerSupervision::start() {
  state_ = can::ErrorState::error_active;
  transmit_lost_ = controller_.transmit_lost();
  receive_lost_ = controller_.receive_lost();
}

void ControllerSupervision::poll(base::SimTime now) {
  if (const can::ErrorState state = controller_.error_state(); state != state_) {
    follow_error_state(state, now);
  }
  if (state_ != can::ErrorState::bus_off) {
    follow_losses(CanOverrun::transmit, controller_.transmit_lost(), transmit_lost_, now);
  }
  follow_losses(CanOverrun::receive, controller_.receive_lost(), receive_lost_, now);
}

void ControllerSupervision::follow_error_state(can::ErrorState state, base::SimTime now) {
  const can::ErrorState before = state_;
  state_ = state;
  if (state == can::ErrorState::error_passive) {
    emergencies_.raise({.code = kCanErrorPassive, .error_register = kErrorRegisterCommunication},
                       now);
  } else {
    emergencies_.clear(kCanErrorPassive, 0, now);
  }
  if (state == can::ErrorState::bus_off) {
    if (bus_off_) {
      bus_off_(now);
    }
    reaction_.on_communication_error(now);
  } else if (before == can::ErrorState::bus_off) {
    transmit_lost_ = controller_.transmit_lost();
    emergencies_.raise(
        {.code = kRecoveredFromBusOff, .error_register = kErrorRegisterCommunication}, now);
    emergencies_.clear(kRecoveredFromBusOff, 0, now);
  }
}

/// A loss is an event, not a state: it is over when it is reported.
void ControllerSupervision::follow_losses(CanOverrun buffer, std::uint64_t lost,
                                          std::uint64_t& known, base::SimTime now) {
  if (lost == known) {
    return;
  }
  known = lost;
  const auto which = static_cast<std::uint8_t>(buffer);
  emergencies_.raise({.code = kCanOverrun,
                      .error_register = kErrorRegisterCommunication,
                      .information = {which},
                      .cause = which},
                     now);
  emergencies_.clear(kCanOverrun, which, now);
}

}  // namespace stator::canopen
