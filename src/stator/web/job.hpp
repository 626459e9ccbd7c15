#pragma once

#include <memory>
#include <variant>

#include "stator/rack/run/desk.hpp"
#include "stator/web/message.hpp"

namespace stator::web {

/// A request on its way through the rack's desk: a LookJob or an ActJob.
class Job {
 public:
  Job() = default;
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  virtual ~Job() = default;

  /// What the desk gets.
  [[nodiscard]] virtual rack::DeskTask& task() = 0;

  // In the server's thread, while the rack does not have it.

  /// False: what it has begun goes on inside the rack, however long; it has to look again, and
  /// others have their turn at the desk meanwhile.
  [[nodiscard]] virtual bool complete() const { return true; }
  /// What came of it, once it is done.
  [[nodiscard]] virtual Response response() = 0;
};

/// One that only looks at the rack.
class LookJob : public Job, public rack::Look {
 public:
  [[nodiscard]] rack::DeskTask& task() final { return *this; }
};

/// One that does something to it.
class ActJob : public Job, public rack::Act {
 public:
  [[nodiscard]] rack::DeskTask& task() final { return *this; }
};

/// What a request gets: an answer at once, or one by way of the rack.
using Answer = std::variant<Response, std::unique_ptr<Job>>;

}  // namespace stator::web
