#pragma once

#include <memory>
#include <variant>

#include "stator/rack/run/desk.hpp"
#include "stator/web/message.hpp"

namespace stator::web {

/// A request on its way through the rack's desk.
class Job : public rack::DeskTask {
 public:
  // In the server's thread, while the rack does not have it.

  /// False: what it has begun goes on inside the rack, however long; it has to look again, and
  /// others have their turn at the desk meanwhile.
  [[nodiscard]] virtual bool complete() const { return true; }
  /// What came of it, once it is done.
  [[nodiscard]] virtual Response response() = 0;
};

/// What a request gets: an answer at once, or one by way of the rack.
using Answer = std::variant<Response, std::unique_ptr<Job>>;

}  // namespace stator::web
