#include "stator/rack/faults/faults.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/ethercat/stack/slave_stack.hpp"
#include "stator/product/device/ethercat_device.hpp"
#include "stator/rack/faults/fault_kinds.hpp"

namespace stator::rack {

namespace {

using base::SimDuration;
using base::SimTime;

// Arguments: {0} number, {1} kind.
constexpr base::EventRule kBegins{"fault-begins", base::Severity::information,
                                  "fault {0} begins: {1}"};
constexpr base::EventRule kEnds{"fault-ends", base::Severity::information, "fault {0} ends: {1}"};

bool watches_mailbox(const Milestone& milestone) {
  using enum Milestone::Kind;
  return milestone.kind == message || milestone.kind == sdo || milestone.kind == segment;
}

std::string in_words(SimDuration duration) {
  const double seconds = duration.seconds();
  return seconds < 1.0 ? fmt::format("{:.3g} ms", seconds * 1e3) : fmt::format("{:.1f} s", seconds);
}

}  // namespace

std::string_view to_text(FaultState state) {
  switch (state) {
    case FaultState::armed:
      return "armed";
    case FaultState::active:
      return "active";
    case FaultState::done:
      return "done";
  }
  return "?";
}

Faults::~Faults() {
  for (const auto& [device, mailbox] : mailboxes_) {
    target_.slave(device).slave_stack()->set_mailbox_intervention(nullptr);
  }
}

base::Expected<std::uint64_t, std::string> Faults::inject(const FaultConfiguration& fault,
                                                          SimTime now) {
  Record record;
  record.configuration = fault;
  try {
    record.effect = fault.kind->make(
        {target_, held_,
         base::Delegate<MailboxFaults&(DeviceAddress)>::bind<&Faults::mailbox_of>(*this)},
        fault);
    arm_watch(record, now);
  } catch (const std::exception& error) {
    return base::Unexpected{std::string(error.what())};
  }
  record.id = ++newest_;
  records_.push_back(std::move(record));
  act(now);
  return newest_;
}

void Faults::arm_watch(Record& record, SimTime now) {
  const FaultConfiguration& fault = record.configuration;
  if (fault.when) {
    if (watches_mailbox(*fault.when)) {
      static_cast<void>(mailbox_of(fault.when->device));
    }
    record.watch = watch_.make(*fault.when);
  } else if (fault.at) {
    record.begins = SimTime(*fault.at) + fault.wait;
  } else if (fault.after.empty()) {
    record.begins = now + fault.wait;
  }
}

MailboxFaults& Faults::mailbox_of(DeviceAddress device) {
  auto& mailbox = mailboxes_[device];
  if (mailbox == nullptr) {
    ethercat::SlaveStack* stack = target_.slave(device).slave_stack();
    if (stack == nullptr) {
      mailboxes_.erase(device);
      throw std::runtime_error(target_.name_of(device) + " has no mailbox of its own firmware");
    }
    mailbox =
        std::make_unique<MailboxFaults>(MailboxFaults::Listener::bind<&Faults::on_mailbox>(*this));
    stack->set_mailbox_intervention(mailbox.get());
  }
  return *mailbox;
}

// Called while a device handles a request: only faults of that mailbox may begin here, all others
// begin when the device is done.
void Faults::on_mailbox(const MailboxFaults& mailbox, const MailboxStep& step) {
  for (Record& record : records_) {
    if (record.state != FaultState::armed || record.watch == nullptr ||
        !watches_mailbox(*record.configuration.when) ||
        mailboxes_[record.configuration.when->device].get() != &mailbox) {
      continue;
    }
    record.watch->see(step);
    if (!record.watch->reached()) {
      continue;
    }
    record.watch.reset();
    record.begins = step.time + record.configuration.wait;
    next_ = std::min(next_, record.begins);
    if (record.begins <= step.time && record.configuration.kind->of_mailbox) {
      begin(record, step.time);
    }
  }
}

bool Faults::clear(std::uint64_t id, SimTime now) {
  const auto found = std::ranges::find(records_, id, &Record::id);
  if (found == records_.end()) {
    return false;
  }
  if (found->state == FaultState::active) {
    end(*found, now);
  } else if (found->state == FaultState::armed) {
    found->state = FaultState::done;
    found->watch.reset();
    found->ended = now;
  }
  act(now);
  return true;
}

// Armed faults are done first: one that waits for the end of another must not begin when that ends.
std::size_t Faults::clear_all(SimTime now) {
  std::size_t count = 0;
  for (Record& record : records_) {
    if (record.state == FaultState::armed) {
      record.state = FaultState::done;
      record.watch.reset();
      record.ended = now;
      ++count;
    }
  }
  for (Record& record : records_) {
    if (record.state == FaultState::active) {
      end(record, now);
      ++count;
    }
  }
  plan(now);
  return count;
}

void Faults::act(SimTime now) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (Record& record : records_) {
      changed = step(record, now) || changed;
    }
  }
  forget_old();
  plan(now);
}

/// True if something began or ended.
bool Faults::step(Record& record, SimTime now) {
  const FaultConfiguration& fault = record.configuration;
  if (record.state == FaultState::armed) {
    if (record.watch != nullptr && record.watch->reached()) {
      record.watch.reset();
      record.begins = now + fault.wait;
    }
    if (!fault.after.empty() && record.begins == SimTime::never()) {
      if (const Record* before = find(fault.after);
          before != nullptr && before->state == FaultState::done) {
        record.begins = *before->ended + fault.wait;
      }
    }
    if (record.begins > now) {
      return false;
    }
    begin(record, now);
    return true;
  }
  if (record.state == FaultState::done) {
    return false;
  }
  if (record.ends <= now || !record.effect->hits()) {
    end(record, now);
    return true;
  }
  if (record.effect->next_step() <= now) {
    record.effect->step(now);
  }
  return false;
}

void Faults::begin(Record& record, SimTime now) {
  record.state = FaultState::active;
  record.begun = now;
  report(record, now, true);
  if (record.configuration.duration) {
    record.ends = now + *record.configuration.duration;
  }
  record.effect->begin(now);
  if (record.configuration.kind->momentary) {
    record.ends = now;
  }
}

void Faults::end(Record& record, SimTime now) {
  record.hits = record.effect->hits().value_or(record.configuration.count);
  record.effect->end(now);
  record.state = FaultState::done;
  record.ended = now;
  if (!record.configuration.kind->momentary) {
    report(record, now, false);
  }
}

void Faults::report(const Record& record, SimTime now, bool begins) {
  const base::EventReporter reporter = target_.reporter(record.configuration);
  reporter.report(now, begins ? kBegins : kEnds,
                  {static_cast<std::int64_t>(record.id), record.configuration.kind->name});
}

const Faults::Record* Faults::find(const std::string& name) const {
  const auto found =
      std::find_if(records_.rbegin(), records_.rend(),
                   [&name](const Record& record) { return record.configuration.name == name; });
  return found == records_.rend() ? nullptr : &*found;
}

void Faults::plan(SimTime now) {
  next_ = SimTime::never();
  looking_ = false;
  if (std::ranges::all_of(records_, [](const Record& record) { return record.watch == nullptr; })) {
    watch_.rest();
  }
  for (const Record& record : records_) {
    if (record.state == FaultState::armed) {
      next_ = std::min(next_, record.begins);
      looking_ = looking_ || record.watch != nullptr;
    } else if (record.state == FaultState::active) {
      next_ = std::min({next_, record.ends, record.effect->next_step()});
      looking_ = looking_ || record.configuration.count != 0;
    }
  }
  if (looking_) {
    const SimDuration since = now.since_power_on();
    next_ = std::min(next_, SimTime(kLookPeriod * (since / kLookPeriod + 1)));
  }
}

void Faults::forget_old() {
  std::size_t done = 0;
  for (const Record& record : records_) {
    done += record.state == FaultState::done ? 1 : 0;
  }
  for (auto record = records_.begin(); record != records_.end() && done > kDoneKept;) {
    if (record->state == FaultState::done) {
      record = records_.erase(record);
      --done;
    } else {
      ++record;
    }
  }
}

std::vector<FaultStatus> Faults::list(SimTime now) const {
  std::vector<FaultStatus> all;
  for (const Record& record : records_) {
    const FaultConfiguration& fault = record.configuration;
    FaultStatus status{.id = record.id,
                       .name = fault.name,
                       .kind = fault.kind->name,
                       .target = fault.target.text,
                       .state = record.state,
                       .remaining = remaining(record, now),
                       .begun = record.begun,
                       .ended = record.ended,
                       .hits = record.hits};
    if (record.state == FaultState::active) {
      status.hits = record.effect->hits().value_or(fault.count);
      if (fault.count != 0) {
        status.remaining_count = fault.count - status.hits;
      }
      if (fault.duration) {
        status.remaining_time = record.ends - now;
      }
    }
    all.push_back(std::move(status));
  }
  return all;
}

std::string Faults::remaining(const Record& record, SimTime now) const {
  const FaultConfiguration& fault = record.configuration;
  if (record.state == FaultState::done) {
    return "";
  }
  if (record.state == FaultState::armed) {
    if (record.watch != nullptr) {
      return "waits for its milestone";
    }
    return record.begins == SimTime::never()
               ? fmt::format("waits for the end of {}", fault.after)
               : fmt::format("begins in {}", in_words(record.begins - now));
  }
  const std::uint64_t hits = record.effect->hits().value_or(fault.count);
  if (fault.count != 0) {
    return fmt::format("{} more {}", fault.count - hits, fault.kind->counted);
  }
  return fault.duration ? in_words(record.ends - now) : "until it is cleared";
}

}  // namespace stator::rack
