#include "stator/rack/run/desk.hpp"

#include "stator/rack/core/rack.hpp"

namespace stator::rack {

bool Look::run(Rack& rack, base::SimTime now) {
  return look(rack, now);
}

bool Desk::post(DeskTask& task) {
  if (under_way_ == kCapacity || !posted_.push(&task)) {
    return false;
  }
  ++under_way_;
  return true;
}

DeskTask* Desk::take_done() {
  DeskTask* task = done_.take().value_or(nullptr);
  if (task != nullptr) {
    --under_way_;
  }
  return task;
}

bool Desk::serve(Rack& rack, base::SimTime now) {
  bool changed = false;
  for (int call = 0; call < kCallsPerLook && !posted_.empty(); ++call) {
    DeskTask* task = posted_.front();
    changed |= task->changes();
    if (task->run(rack, now)) {
      posted_.pop();
      done_.push(task);
    }
  }
  return changed;
}

}  // namespace stator::rack
