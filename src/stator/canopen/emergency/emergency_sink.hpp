#pragma once

#include <array>
#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::canopen {

/// An error as an emergency message reports it (CiA 301 §7.2.7).
struct Emergency {
  std::uint16_t code = 0;
  /// Bits it sets in the error register 1001h while it lasts; bit 0 (generic error) is added.
  std::uint8_t error_register = 0;
  std::array<std::uint8_t, 5> information{};  ///< manufacturer-specific bytes
  /// Tells errors of one code apart that can exist beside each other, e.g. the entry of 1016h whose
  /// heartbeat is missing.
  std::uint8_t cause = 0;
};

/// Where services and application report errors. The emergency producer implements it.
class EmergencySink {
 public:
  EmergencySink() = default;
  EmergencySink(const EmergencySink&) = delete;
  EmergencySink& operator=(const EmergencySink&) = delete;
  virtual ~EmergencySink() = default;

  /// The error has come. Raising an error that lasts already changes nothing.
  virtual void raise(const Emergency& emergency, base::SimTime now) = 0;
  /// The error with `code` and `cause` is gone. Nothing happens if it was not there.
  virtual void clear(std::uint16_t code, std::uint8_t cause, base::SimTime now) = 0;
};

/// What a node does about a communication error beside reporting it (1029h:01, CiA 301 §7.5.2.27):
/// a heartbeat or a guarding request that did not come, bus-off.
class CommunicationErrorReaction {
 public:
  CommunicationErrorReaction() = default;
  CommunicationErrorReaction(const CommunicationErrorReaction&) = delete;
  CommunicationErrorReaction& operator=(const CommunicationErrorReaction&) = delete;
  virtual ~CommunicationErrorReaction() = default;

  /// Called after the emergency has been raised.
  virtual void on_communication_error(base::SimTime now) = 0;
};

/// Error codes of the services in this room (CiA 301 table 26).
inline constexpr std::uint16_t kLifeGuardOrHeartbeatError = 0x8130;
/// Bit of the error register for communication errors (CiA 301 §7.5.2.2).
inline constexpr std::uint8_t kErrorRegisterCommunication = 0x10;

}  // namespace stator::canopen
