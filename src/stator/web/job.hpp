#pragma once

#include <memory>
#include <variant>

#include "stator/rack/run/task_queue.hpp"
#include "stator/web/message.hpp"

namespace stator::web {

/// A request on its way through the rack's task queue: a LookJob or an ActJob.
class Job {
 public:
  Job() = default;
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  virtual ~Job() = default;

  /// The task that is put into the task queue.
  [[nodiscard]] virtual rack::QueuedTask& task() = 0;

  // To be called in the server's thread while the task is not in the task queue.

  /// False: what the job has begun is still under way in the rack, for any time. The job has to be
  /// posted again later; other jobs have their turn meanwhile.
  [[nodiscard]] virtual bool complete() const { return true; }
  /// The answer to the request, once the job is done.
  [[nodiscard]] virtual Response response() = 0;
};

/// A job that only looks at the rack.
class LookJob : public Job, public rack::Look {
 public:
  [[nodiscard]] rack::QueuedTask& task() final { return *this; }
};

/// A job that does something to the rack.
class ActJob : public Job, public rack::Act {
 public:
  [[nodiscard]] rack::QueuedTask& task() final { return *this; }
};

/// What a request gets: an answer at once, or one by way of the rack.
using Answer = std::variant<Response, std::unique_ptr<Job>>;

}  // namespace stator::web
