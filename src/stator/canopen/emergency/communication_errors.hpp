#pragma once

#include <array>
#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/canopen/emergency/emergency_sink.hpp"

namespace stator::canopen {

/// By which the node's services report that error control has failed or works again: to the
/// emergency producer and to error behaviour, as far as the node has them.
class CommunicationErrors {
 public:
  /// `information` fills the manufacturer-specific bytes of the emergency.
  explicit CommunicationErrors(const std::array<std::uint8_t, 5>& information)
      : information_(information) {}

  void set_sink(EmergencySink* sink) { sink_ = sink; }
  void set_reaction(CommunicationErrorReaction* reaction) { reaction_ = reaction; }

  /// A heartbeat or a guarding request is missing; `cause` tells which.
  void raise(std::uint8_t cause, base::SimTime now) {
    if (sink_ != nullptr) {
      sink_->raise({.code = kLifeGuardOrHeartbeatError,
                    .error_register = kErrorRegisterCommunication,
                    .information = information_,
                    .cause = cause},
                   now);
    }
    if (reaction_ != nullptr) {
      reaction_->on_communication_error(now);
    }
  }
  void clear(std::uint8_t cause, base::SimTime now) {
    if (sink_ != nullptr) {
      sink_->clear(kLifeGuardOrHeartbeatError, cause, now);
    }
  }

 private:
  std::array<std::uint8_t, 5> information_;
  EmergencySink* sink_ = nullptr;
  CommunicationErrorReaction* reaction_ = nullptr;
};

}  // namespace stator::canopen
