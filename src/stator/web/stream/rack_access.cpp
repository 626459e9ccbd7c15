#include "stator/web/stream/rack_access.hpp"

#include <algorithm>
#include <utility>

#include "stator/web/api/events_job.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

/// How often streams are filled.
constexpr std::chrono::milliseconds kStreamPeriod{20};
/// How often events are fetched: far more often than the log forgets them.
constexpr std::chrono::milliseconds kEventPeriod{250};
/// The same while somebody watches them, as an oscilloscope's trigger does.
constexpr std::chrono::milliseconds kWatchedEventPeriod{50};
/// Jobs of requests under way at most; the rest of the task queue is for streams.
constexpr std::size_t kMostJobs = rack::TaskQueue::kCapacity / 2;

}  // namespace

RackAccess::RackAccess(State& state, rack::TaskQueue& tasks, std::chrono::milliseconds rack_time,
                       std::function<void()> wake)
    : state_(state), tasks_(tasks), rack_time_(rack_time), wake_(std::move(wake)) {}

bool RackAccess::post(std::unique_ptr<Job> job, std::shared_ptr<Waiter> waiter) {
  if (waiting_.size() >= kMostJobs || !tasks_.post(job->task())) {
    return false;
  }
  waiting_.push_back({std::move(job), std::move(waiter), Clock::now() + rack_time_});
  wake_();
  return true;
}

void RackAccess::tap(std::shared_ptr<TapOwner> owner, const Subscription& subscription) {
  Tap added;
  added.task = std::make_unique<TapTask>(state_, subscription);
  added.owner = std::move(owner);
  added.values_per_second = subscription.values_per_second();
  taps_.push_back(std::move(added));
  wake_();
}

void RackAccess::untap(const TapOwner& owner) {
  for (Tap& each : taps_) {
    if (each.owner.get() == &owner) {
      each.owner.reset();
    }
  }
}

void RackAccess::watch_events(std::weak_ptr<TapOwner> owner) {
  event_watchers_.push_back(std::move(owner));
}

void RackAccess::unwatch_events(const TapOwner& owner) {
  std::erase_if(event_watchers_, [&owner](const std::weak_ptr<TapOwner>& each) {
    const std::shared_ptr<TapOwner> watcher = each.lock();
    return watcher == nullptr || watcher.get() == &owner;
  });
}

std::int64_t RackAccess::values_left(const TapOwner& asking) const {
  std::int64_t left = kMostValuesPerSecond;
  for (const Tap& each : taps_) {
    left -= each.owner != nullptr && each.owner.get() != &asking ? each.values_per_second : 0;
  }
  return left;
}

void RackAccess::tick(Clock::time_point now) {
  while (const rack::QueuedTask* task = tasks_.take_done()) {
    finish_tap(*task);
    finish_job(*task);
  }
  drop_late(now);
  look_again();
  serve_taps();
  // Threads of networks with traffic look at the task queue anyway; others sleep.
  if (posted_before_tick_ && tasks_.waiting()) {
    tasks_.wake_rack();
  }
  posted_before_tick_ = tasks_.waiting();
  if (now >= next_collect_) {
    next_collect_ = now + kStreamPeriod;
    collect();
  }
  if (now >= next_fetch_) {
    next_fetch_ = now + (event_watchers_.empty() ? kEventPeriod : kWatchedEventPeriod);
    static_cast<void>(post(make_events_job(state_, UINT64_MAX), nullptr));
  }
}

bool RackAccess::busy() const {
  return !waiting_.empty() ||
         std::ranges::any_of(taps_, [](const Tap& each) { return each.under_way; });
}

bool RackAccess::anybody_waits() const {
  return std::ranges::any_of(waiting_, [](const Waiting& each) { return each.waiter != nullptr; });
}

void RackAccess::forget_all() {
  for (Waiting& each : waiting_) {
    each.waiter.reset();
  }
  for (Tap& each : taps_) {
    each.owner.reset();
  }
}

void RackAccess::finish_job(const rack::QueuedTask& task) {
  const auto found = std::ranges::find_if(
      waiting_, [&task](const Waiting& each) { return &each.job->task() == &task; });
  if (found == waiting_.end()) {
    return;
  }
  if (!found->job->complete() && found->waiter != nullptr) {
    found->resting = true;
    found->under_way = true;
    return;
  }
  const Waiting done = std::move(*found);
  waiting_.erase(found);
  Response response = done.job->response();
  if (done.waiter != nullptr) {
    done.waiter->answer(std::move(response));
  }
}

void RackAccess::finish_tap(const rack::QueuedTask& task) {
  const auto found =
      std::ranges::find_if(taps_, [&task](const Tap& each) { return each.task.get() == &task; });
  if (found == taps_.end()) {
    return;
  }
  found->under_way = false;
  found->inside = !found->inside;
  if (!found->inside) {
    taps_.erase(found);
  } else if (const std::shared_ptr<TapOwner> owner = found->owner; owner != nullptr) {
    owner->tapped();
  }
}

// The job itself stays until the rack has done it.
void RackAccess::drop_late(Clock::time_point now) {
  for (Waiting& each : waiting_) {
    if (each.waiter != nullptr && each.deadline <= now) {
      std::exchange(each.waiter, nullptr)
          ->answer(
              problem(503, each.under_way
                               ? "the device still carries out what was ordered: its disk has not "
                                 "answered, or no master moves simulated time (lockstep)"
                               : "the rack has not answered; have its links failed?"));
    }
  }
}

void RackAccess::look_again() {
  std::erase_if(waiting_,
                [](const Waiting& each) { return each.resting && each.waiter == nullptr; });
  for (Waiting& each : waiting_) {
    if (each.resting && tasks_.post(each.job->task())) {
      each.resting = false;
    }
  }
}

void RackAccess::collect() {
  for (Tap& each : taps_) {
    if (each.inside && each.owner != nullptr) {
      const std::shared_ptr<TapOwner> owner = each.owner;
      owner->collect(each.task->tap());
    }
  }
  const std::vector<std::weak_ptr<TapOwner>> watchers = event_watchers_;  // may change meanwhile
  for (const auto& each : watchers) {
    if (const std::shared_ptr<TapOwner> owner = each.lock()) {
      owner->collect_events();
    }
  }
}

// Brings taps into the rack, and those that nobody wants any more out of it.
void RackAccess::serve_taps() {
  for (Tap& each : taps_) {
    const bool wanted = each.owner != nullptr;
    if (!each.under_way && wanted != each.inside) {
      each.under_way = tasks_.post(*each.task);
    }
  }
  std::erase_if(taps_, [](const Tap& each) {
    return !each.under_way && !each.inside && each.owner == nullptr;
  });
}

}  // namespace stator::web
