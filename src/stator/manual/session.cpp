#include "stator/manual/session.hpp"

#include <algorithm>
#include <ranges>
#include <utility>

#include "stator/base/event_text.hpp"

namespace stator::manual {

using master::Result;

namespace {

/// How often axes are asked where they are.
constexpr base::SimDuration kLookPeriod{100'000'000};

/// What was written goes out with the next cycle; what it has changed comes back with one after.
constexpr int kCyclesUntilSeen = 3;

constexpr base::EventRule kBegins{
    "manual-control-begins", base::Severity::information,
    "it is under manual control: a master inside Stator commands it until it is given back or "
    "another master speaks on its network"};
constexpr base::EventRule kReleased{"manual-control-ends", base::Severity::information,
                                    "manual control of it has ended"};
constexpr base::EventRule kGone{"manual-control-lost", base::Severity::warning,
                                "manual control of it has ended: {0}"};

}  // namespace

Session::Session(const rack::RunningRack& running, std::unique_ptr<NetworkMaster> master,
                 std::vector<Member> members, rack::DeviceAddress first)
    : running_(running),
      master_(std::move(master)),
      members_(std::move(members)),
      requests_{{.kind = Request::Kind::start, .device = first}},
      statuses_{{first, {.phase = Phase::starting}}},
      thread_([this] { run(); }) {}

Session::~Session() {
  stopping_ = true;
  master_->end();
}

DeviceStatus Session::status(rack::DeviceAddress device) const {
  const std::scoped_lock lock(mutex_);
  const auto found = statuses_.find(device);
  return found != statuses_.end() ? found->second : DeviceStatus{};
}

bool Session::ask(Request request) {
  const std::scoped_lock lock(mutex_);
  if (over_) {
    return false;
  }
  if (request.kind == Request::Kind::start) {
    DeviceStatus& status = statuses_[request.device];
    if (status.phase == Phase::starting || status.phase == Phase::active) {
      return true;
    }
    status = {.phase = Phase::starting};
  }
  // The newest command to jog stands for those of the axis that wait: a button that is held must
  // not go on turning when it is let go.
  if (request.kind == Request::Kind::command && !requests_.empty()) {
    Request& last = requests_.back();
    if (last.kind == Request::Kind::command && last.device == request.device &&
        last.axis == request.axis && last.command.kind == CommandKind::jog &&
        request.command.kind == CommandKind::jog) {
      last = std::move(request);
      return true;
    }
  }
  requests_.push_back(std::move(request));
  return true;
}

bool Session::start(rack::DeviceAddress device) {
  return ask({.kind = Request::Kind::start, .device = device});
}

bool Session::release(rack::DeviceAddress device) {
  return ask({.kind = Request::Kind::release, .device = device});
}

bool Session::command(rack::DeviceAddress device, std::size_t axis, const Command& command) {
  return ask({.kind = Request::Kind::command, .device = device, .axis = axis, .command = command});
}

bool Session::set_outputs(rack::DeviceAddress device, std::size_t offset,
                          std::vector<std::byte> data) {
  return ask({.kind = Request::Kind::outputs,
              .device = device,
              .offset = offset,
              .data = std::move(data)});
}

const Session::Member& Session::member(rack::DeviceAddress device) const {
  return *std::ranges::find(members_, device, &Member::device);
}

void Session::report(rack::DeviceAddress device, const base::EventRule& rule,
                     const std::string& text) {
  member(device).reporter.report(running_.machine_now(), rule, {base::SharedText(text)});
}

void Session::run() {
  if (const auto opened = master_->open(); !opened) {
    master_->close();
    end(opened.error().text);
    return;
  }
  std::string why;
  while (!stopping_) {
    std::optional<Request> request;
    {
      const std::scoped_lock lock(mutex_);
      if (!requests_.empty()) {
        request = std::move(requests_.front());
        requests_.pop_front();
      } else if (axes_.empty()) {
        over_ = true;  // the last device was given back, and nobody wants another
        break;
      }
    }
    if (request) {
      serve(*request);
    }
    end_jogs();
    look();
    if (const auto passed = master_->cycle(); !passed) {
      why = passed.error().text;
      break;
    }
  }
  master_->close();
  end(why);
}

void Session::serve(const Request& request) {
  switch (request.kind) {
    case Request::Kind::start:
      begin(request.device);
      break;
    case Request::Kind::release:
      give_back(request.device);
      break;
    case Request::Kind::command:
      execute(request);
      break;
    case Request::Kind::outputs:
      if (axes_.contains(request.device)) {
        static_cast<void>(master_->set_outputs(request.device, request.offset, request.data));
      }
      break;
  }
}

void Session::begin(rack::DeviceAddress device) {
  Axes axes;
  std::string failure;
  const Member& its = member(device);
  for (unsigned number = 0; number < its.axes && failure.empty(); ++number) {
    auto axis = master_->axis({.device = device, .number = number, .units = its.units});
    if (axis) {
      axes.push_back({.axis = std::move(*axis)});
    } else {
      failure = axis.error().text;
    }
  }
  std::vector<AxisRecord> records(axes.size());
  for (std::size_t i = 0; i < axes.size() && failure.empty(); ++i) {
    records[i].description = axes[i].axis->description();
    if (auto status = axes[i].axis->look()) {
      records[i].status = std::move(*status);
    } else {
      failure = status.error().text;
    }
  }
  {
    const std::scoped_lock lock(mutex_);
    statuses_[device] = failure.empty()
                            ? DeviceStatus{.phase = Phase::active, .axes = std::move(records)}
                            : DeviceStatus{.phase = Phase::ended, .text = failure};
  }
  if (failure.empty()) {
    axes_.emplace(device, std::move(axes));
    report(device, kBegins, {});
  } else {
    report(device, kGone, failure);
  }
}

void Session::give_back(rack::DeviceAddress device) {
  const auto found = axes_.find(device);
  if (found == axes_.end()) {
    return;
  }
  for (const Held& each : found->second) {
    static_cast<void>(each.axis->leave());
  }
  axes_.erase(found);
  {
    const std::scoped_lock lock(mutex_);
    statuses_[device] = {};
  }
  report(device, kReleased, {});
}

void Session::execute(const Request& request) {
  const auto found = axes_.find(request.device);
  if (found == axes_.end() || request.axis >= found->second.size()) {
    return;
  }
  Held& held = found->second[request.axis];
  const bool jogs = request.command.kind == CommandKind::jog && request.command.value != 0;
  const auto done = held.axis->execute(request.command);
  held.jog_until = done && jogs ? std::optional(running_.machine_now() + kJogHold) : std::nullopt;
  // What fails here, fails again soon.
  for (int i = 0; i < kCyclesUntilSeen; ++i) {
    static_cast<void>(master_->cycle());
  }
  static_cast<void>(look(request.device, found->second));
  const std::scoped_lock lock(mutex_);
  AxisRecord& record = statuses_[request.device].axes[request.axis];
  record.refusal = done ? std::string() : done.error().text;
  ++record.executed;
}

// Nobody repeats the command any more: the button was let go, or the page is gone.
void Session::end_jogs() {
  const base::SimTime now = running_.machine_now();
  for (auto& [device, axes] : axes_) {
    for (Held& each : axes) {
      if (each.jog_until && *each.jog_until <= now) {
        each.jog_until.reset();
        static_cast<void>(each.axis->execute({.kind = CommandKind::stop}));
      }
    }
  }
}

void Session::look() {
  const base::SimTime now = running_.machine_now();
  if (now < next_look_) {
    return;
  }
  next_look_ = now + kLookPeriod;
  std::vector<std::pair<rack::DeviceAddress, std::string>> lost;
  for (auto& [device, axes] : axes_) {
    if (const auto looked = look(device, axes); !looked) {
      lost.emplace_back(device, looked.error().text);
    }
  }
  if (master_->displaced() || stopping_) {
    return;  // that is why, and end() tells it
  }
  for (const auto& [device, why] : lost) {
    axes_.erase(device);
    {
      const std::scoped_lock lock(mutex_);
      statuses_[device] = {.phase = Phase::ended, .text = why};
    }
    report(device, kGone, why);
  }
}

Result<void> Session::look(rack::DeviceAddress device, Axes& axes) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    auto status = axes[i].axis->look();
    if (!status) {
      return base::Unexpected{status.error()};
    }
    const std::scoped_lock lock(mutex_);
    statuses_[device].axes[i].status = std::move(*status);
  }
  return {};
}

void Session::end(const std::string& why) {
  std::vector<rack::DeviceAddress> lost;
  {
    const std::scoped_lock lock(mutex_);
    over_ = true;
    for (auto& [device, status] : statuses_) {
      if (status.phase == Phase::starting || status.phase == Phase::active) {
        status = {.phase = Phase::ended, .text = why};
        lost.push_back(device);
      }
    }
  }
  if (!stopping_) {
    for (const rack::DeviceAddress device : lost) {
      report(device, kGone, why);
    }
  }
}

}  // namespace stator::manual
