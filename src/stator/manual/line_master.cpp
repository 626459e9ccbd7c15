#include "stator/manual/line_master.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

#include "stator/manual/tmcl_axis.hpp"

namespace stator::manual {

using master::ErrorCode;
using master::Result;

namespace {

constexpr base::SimDuration kReplyPoll{1'000'000};
constexpr base::SimDuration kReplyTimeout{200'000'000};

}  // namespace

LineMaster::LineMaster(rack::RunningRack& running, rack::SerialLineThread& thread, std::size_t line,
                       std::vector<LineMember> members)
    : NetworkMaster(running, thread.seat()),
      thread_(thread),
      line_(line),
      members_(std::move(members)) {}

LineMaster::~LineMaster() {
  const std::scoped_lock lock(running_.mutex);
  disconnect();
}

Result<void> LineMaster::begin() {
  const std::scoped_lock lock(running_.mutex);
  if (!ended()) {
    running_.rack.connect_line(
        line_, base::Delegate<void(std::span<const std::byte>)>::bind<&LineMaster::hear>(*this));
    connected_ = true;
  }
  return {};
}

void LineMaster::finish() {
  const std::scoped_lock lock(running_.mutex);
  disconnect();
}

void LineMaster::disconnect() {
  if (std::exchange(connected_, false)) {
    thread_.connect();
  }
}

void LineMaster::displace() {
  awaited_ += owed_.size() * tmcl::kTelegramLength;
  for (const auto& [axis, instruction] : std::exchange(owed_, {})) {
    send(axis.first, instruction);
  }
  if (awaited_ == 0) {
    disconnect();
  }
}

void LineMaster::hear(std::span<const std::byte> bytes) {
  heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  awaited_ -= std::min(awaited_, bytes.size());
  if (displaced() && awaited_ == 0) {
    disconnect();
  }
}

void LineMaster::send(std::uint8_t address, const tmcl::Instruction& instruction) {
  running_.rack.put(line_,
                    tmcl::encode(tmcl::Request{.address = address,
                                               .command = instruction.command,
                                               .type = instruction.type,
                                               .motor = instruction.motor,
                                               .value = instruction.value}),
                    running_.reached);
}

Result<void> LineMaster::cycle() {
  wait(kCycle);
  return ended() ? base::Unexpected{why_ended()} : Result<void>();
}

Result<std::unique_ptr<Axis>> LineMaster::axis(const AxisPlace& place) {
  const auto member = std::ranges::find(members_, place.device, &LineMember::device);
  return std::unique_ptr<Axis>(std::make_unique<TmclAxis>(
      [this, address = member->address](const tmcl::Instruction& instruction) {
        return ask(address, instruction);
      },
      place,
      [this, address = member->address,
       motor = static_cast<std::uint8_t>(place.number)](const auto& instruction) {
        const std::scoped_lock lock(running_.mutex);
        if (instruction) {
          owed_[{address, motor}] = *instruction;
        } else {
          owed_.erase({address, motor});
        }
      }));
}

Result<tmcl::Reply> LineMaster::ask(std::uint8_t address, const tmcl::Instruction& instruction) {
  {
    const std::scoped_lock lock(running_.mutex);
    if (ended()) {
      return base::Unexpected{why_ended()};
    }
    heard_.clear();
    running_.catch_up();
    awaited_ = tmcl::kTelegramLength;
    send(address, instruction);
  }
  thread_.wake();
  const base::SimTime deadline = running_.machine_now() + kReplyTimeout;
  while (!ended() && running_.machine_now() < deadline) {
    {
      const std::scoped_lock lock(running_.mutex);
      running_.catch_up();
      if (heard_.size() >= tmcl::kTelegramLength) {
        tmcl::Telegram telegram{};
        std::copy_n(heard_.begin(), telegram.size(), telegram.begin());
        if (!tmcl::has_right_checksum(telegram)) {
          return master::fail(ErrorCode::protocol, "the module's reply has a wrong checksum");
        }
        return tmcl::decode_reply(telegram);
      }
    }
    wait(kReplyPoll);
  }
  const std::scoped_lock lock(running_.mutex);
  if (!ended()) {
    awaited_ = 0;
  }
  return ended() ? base::Unexpected{why_ended()}
                 : master::fail(ErrorCode::timeout,
                                "the module did not answer a command over its serial line");
}

}  // namespace stator::manual
