#pragma once

#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"
#include "stator/canopen/nmt_state.hpp"

namespace stator::canopen {

/// One service of a node: SDO server, a PDO, SYNC, heartbeat. Passive: frames and time come in,
/// frames go out through the can::Transmitter it was built with.
class Service {
 public:
  Service() = default;
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;
  virtual ~Service() = default;

  /// Begins anew, at power-on and after NMT reset: the communication objects have the values they
  /// start with, and the node is about to report its boot-up.
  virtual void start(base::SimTime now) = 0;
  /// The node's NMT state has changed.
  virtual void on_state(NmtState /*state*/, base::SimTime /*now*/) {}
  /// Takes `frame` if it is addressed to this service in the present NMT state; false otherwise.
  /// Whether a data frame is taken may depend on its identifier, on the NMT state and on the
  /// communication objects only: the node remembers identifiers that no service takes until one of
  /// them changes (Node::communication_objects_changed).
  virtual bool receive(const can::Frame& /*frame*/, base::SimTime /*now*/) { return false; }
  /// Does what is due at `now`.
  virtual void advance(base::SimTime /*now*/) {}
  /// The next moment at which advance() has something to do; SimTime::never() if there is none.
  [[nodiscard]] virtual base::SimTime next_deadline() const { return base::SimTime::never(); }

 protected:
  /// To be called when next_deadline() has changed in another way than by the four functions above:
  /// by a hook of the dictionary or by the application. The node asks again then.
  void deadline_changed() {
    if (deadline_stale_ != nullptr) {
      *deadline_stale_ = true;
    }
  }

 private:
  friend class Node;
  bool* deadline_stale_ = nullptr;
};

}  // namespace stator::canopen
