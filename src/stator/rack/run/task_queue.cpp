#include "stator/rack/run/task_queue.hpp"

#include "stator/rack/core/rack.hpp"

namespace stator::rack {

bool Look::run(Rack& rack, base::SimTime now) {
  return look(rack, now);
}

bool TaskQueue::post(QueuedTask& task) {
  if (under_way_ == kCapacity || !posted_.push(&task)) {
    return false;
  }
  ++under_way_;
  return true;
}

QueuedTask* TaskQueue::take_done() {
  QueuedTask* task = done_.take().value_or(nullptr);
  if (task != nullptr) {
    --under_way_;
  }
  return task;
}

bool TaskQueue::serve(Rack& rack, base::SimTime now) {
  bool changed = false;
  for (int call = 0; call < kCallsPerLook && !posted_.empty(); ++call) {
    QueuedTask* task = posted_.front();
    changed |= task->changes();
    if (task->run(rack, now)) {
      posted_.pop();
      done_.push(task);
    }
  }
  return changed;
}

}  // namespace stator::rack
