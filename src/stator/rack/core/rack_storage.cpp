// What devices of a rack have ordered to be kept: when time may move on, and who hears of the end.

#include "stator/rack/core/internal/telling.hpp"
#include "stator/rack/core/nested_calls.hpp"

namespace stator::rack {

namespace {

/// With a storage, in lockstep: no device that gives orders on its own, between frames, has a
/// shorter write time.
constexpr base::SimDuration kShortestWriteTime{5'000'000};

}  // namespace

/// Devices may give orders on the way: time moves on by no more than the shortest write time at
/// once, so that a completion is there when the device looks for it.
void Rack::advance_with_storage(base::SimTime now) {
  wait_for_completions();
  while (parts_->advanced_to + kShortestWriteTime < now) {
    parts_->advanced_to += kShortestWriteTime;
    advance_at_once(parts_->advanced_to);
    wait_for_completions();
  }
  advance_at_once(now);
}

void Rack::wait_for_completions() {
  if (!parts_->storage->busy()) {
    return;
  }
  for (const StorageCompletion& completion :
       parts_->storage->wait_for_completions(parts_->advanced_to)) {
    complete(completion, parts_->advanced_to);
  }
}

void Rack::hand_over_completions(base::SimTime now) {
  for (const StorageCompletion& completion : parts_->storage->take_completions(now)) {
    complete(completion, now);
  }
}

bool Rack::complete(const StorageCompletion& completion, base::SimTime now) {
  tell(command::CompleteStorage{completion, now});
  const NestedCalls nested(parts_->inside);
  return parts_->storage != nullptr && parts_->storage->complete(completion, now);
}

}  // namespace stator::rack
