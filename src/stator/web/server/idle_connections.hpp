// Connections on which no request is under way, and the one of them that makes room for others.
#pragma once

#include <list>

namespace stator::web {

/// A connection that may have to make room while it waits for a request.
class IdleConnection {
 public:
  IdleConnection() = default;
  IdleConnection(const IdleConnection&) = delete;
  IdleConnection& operator=(const IdleConnection&) = delete;
  virtual ~IdleConnection() = default;

  /// Ends the connection at once; it is idle no more and does not count any longer.
  virtual void give_way() = 0;
};

/// The connections that wait for a request, those first that have waited longest. One that has sent
/// a part of the head of a request waits as well: otherwise a byte would buy the place.
class IdleConnections {
 public:
  using Place = std::list<IdleConnection*>::iterator;

  /// `connection` begins to wait; it must leave before it ends.
  Place enter(IdleConnection& connection) {
    return connections_.insert(connections_.end(), &connection);
  }
  void leave(Place place) { connections_.erase(place); }
  /// Ends the connection that has waited longest. False: all are at work.
  bool end_longest() {
    if (connections_.empty()) {
      return false;
    }
    connections_.front()->give_way();
    return true;
  }

 private:
  std::list<IdleConnection*> connections_;
};

}  // namespace stator::web
