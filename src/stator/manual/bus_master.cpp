#include "stator/manual/bus_master.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "stator/manual/cia402_axis.hpp"
#include "stator/manual/tmcl_axis.hpp"
#include "stator/master/can_sdo_client.hpp"
#include "stator/master/cia402/drive_port.hpp"

namespace stator::manual {

using master::CanSdoClient;
using master::ErrorCode;
using master::Result;

namespace {

/// How often answers are looked for.
constexpr base::SimDuration kPoll{500'000};
constexpr base::SimDuration kSdoTimeout{500'000'000};
constexpr base::SimDuration kTmclTimeout{200'000'000};

// NMT (CiA 301 §7.2.8.2.1): to all nodes.
constexpr std::uint32_t kNmt = 0x000;
constexpr unsigned kStartNode = 0x01;
constexpr unsigned kEnterPreOperational = 0x80;

// On CAN a telegram of TMCL goes without its first and last byte, address and checksum.
constexpr std::size_t kTelegramOnCan = 7;

BusMaster::IsAnswer data_frame_of(std::uint32_t identifier) {
  return [identifier](const can::Frame& frame) {
    return !frame.extended && !frame.remote && frame.identifier == identifier;
  };
}

can::Frame request_to(const product::TmclAddress& module, const tmcl::Instruction& instruction) {
  const tmcl::Telegram telegram = tmcl::encode(tmcl::Request{.address = module.serial,
                                                             .command = instruction.command,
                                                             .type = instruction.type,
                                                             .motor = instruction.motor,
                                                             .value = instruction.value});
  return can::data_frame(module.can,
                         std::span<const std::byte>(telegram).subspan(1, kTelegramOnCan));
}

std::optional<tmcl::Reply> reply_of(const product::TmclAddress& module, const can::Frame& frame) {
  if (!data_frame_of(module.can_reply)(frame) || frame.length < kTelegramOnCan) {
    return std::nullopt;
  }
  tmcl::Telegram telegram{};
  std::ranges::copy(frame.payload().first(kTelegramOnCan), telegram.begin() + 1);
  return tmcl::decode_reply(telegram);
}

/// A drive on CANopen, whose objects are reached by SDO.
class NodePort final : public master::DrivePort {
 public:
  NodePort(BusMaster& bus, std::uint8_t node_id) : bus_(bus), node_id_(node_id) {}

  Result<std::uint64_t> read(master::ObjectAddress object, std::size_t size) override {
    const auto data = client().upload(object);
    return data ? master::number_of(*data, size, object, name()) : base::Unexpected{data.error()};
  }
  Result<void> write(master::ObjectAddress object, std::size_t size, std::uint64_t bits) override {
    std::array<std::byte, sizeof bits> data{};
    const auto used = std::span(data).first(size);
    master::store_number(used, bits);
    return client().download(object, used);
  }
  [[nodiscard]] bool cyclic(master::ObjectAddress /*object*/) const override { return false; }
  Result<void> run_cycle() override { return bus_.cycle(); }
  [[nodiscard]] base::SimTime now() override { return bus_.now(); }
  [[nodiscard]] std::string name() const override { return "node " + std::to_string(node_id_); }

 private:
  [[nodiscard]] CanSdoClient client() {
    return {node_id_, [this](const can::Frame& request) {
              return bus_.ask(request, data_frame_of(CanSdoClient::kAnswer + node_id_),
                              kSdoTimeout);
            }};
  }

  BusMaster& bus_;
  std::uint8_t node_id_;
};

}  // namespace

BusMaster::BusMaster(rack::RunningRack& running, rack::BusThread& thread, std::size_t bus,
                     std::vector<BusMember> members)
    : NetworkMaster(running, thread.seat()),
      thread_(thread),
      bus_(bus),
      members_(std::move(members)) {}

BusMaster::~BusMaster() {
  const std::scoped_lock lock(running_.mutex);
  port_.reset();
}

Result<void> BusMaster::begin() {
  {
    const std::scoped_lock lock(running_.mutex);
    port_.emplace(running_.rack, bus_,
                  rack::BusPort::Options{.hears_errors = false, .lossy = true});
  }
  const bool canopen =
      std::ranges::any_of(members_, [](const BusMember& each) { return each.node_id.has_value(); });
  if (canopen && !put(can::data_frame(kNmt, {kStartNode, 0U}))) {
    return base::Unexpected{why_ended()};
  }
  return cycle();
}

void BusMaster::finish() {
  const bool canopen =
      std::ranges::any_of(members_, [](const BusMember& each) { return each.node_id.has_value(); });
  if (canopen && put(can::data_frame(kNmt, {kEnterPreOperational, 0U}))) {
    wait(kCycle);  // it leaves with the port otherwise
  }
}

void BusMaster::displace() {
  if (!port_) {
    return;
  }
  const base::SimTime until = now() + kTmclTimeout;
  if (awaited_) {
    thread_.withhold(std::exchange(awaited_, {}), until);
  }
  for (const auto& [axis, owed] : std::exchange(owed_, {})) {
    const product::TmclAddress module = *members_[axis.first].tmcl;
    const tmcl::Instruction instruction = owed;
    thread_.withhold(
        [module, instruction](const can::Frame& frame) {
          const auto reply = reply_of(module, frame);
          return reply && reply->command == instruction.command &&
                 reply->value == instruction.value;
        },
        until);
    static_cast<void>(port_->put(request_to(module, instruction)));
  }
}

bool BusMaster::put(const can::Frame& frame, const IsAnswer& is_answer) {
  {
    const std::scoped_lock lock(running_.mutex);
    if (ended() || !port_) {
      return false;
    }
    while (port_->take()) {
      // What passed before the request is no answer to it.
    }
    running_.catch_up();
    awaited_ = is_answer;
    static_cast<void>(port_->put(frame));
  }
  thread_.wake();
  return true;
}

std::optional<can::Frame> BusMaster::ask(const can::Frame& request, const IsAnswer& is_answer,
                                         base::SimDuration timeout) {
  if (!put(request, is_answer)) {
    return std::nullopt;
  }
  const base::SimTime deadline = now() + timeout;
  while (!ended() && now() < deadline) {
    wait(kPoll);
    const std::scoped_lock lock(running_.mutex);
    running_.catch_up();
    while (const auto entry = port_->take()) {
      if (!entry->destroyed && is_answer(entry->frame)) {
        awaited_ = {};
        return entry->frame;
      }
    }
  }
  const std::scoped_lock lock(running_.mutex);
  awaited_ = {};
  return std::nullopt;
}

Result<void> BusMaster::cycle() {
  wait(kCycle);
  return ended() ? base::Unexpected{why_ended()} : Result<void>();
}

Result<std::unique_ptr<Axis>> BusMaster::axis(const AxisPlace& place) {
  const auto member = std::ranges::find(members_, place.device.device, &BusMember::device);
  const auto number = static_cast<std::size_t>(member - members_.begin());
  if (member->node_id) {
    return std::unique_ptr<Axis>(
        std::make_unique<Cia402Axis>(std::make_unique<NodePort>(*this, *member->node_id), place));
  }
  return std::unique_ptr<Axis>(std::make_unique<TmclAxis>(
      [this, module = *member->tmcl](const tmcl::Instruction& instruction) {
        return ask_module(module, instruction);
      },
      place,
      [this,
       axis = std::pair(number, static_cast<std::uint8_t>(place.number))](const auto& instruction) {
        const std::scoped_lock lock(running_.mutex);
        if (instruction) {
          owed_[axis] = *instruction;
        } else {
          owed_.erase(axis);
        }
      }));
}

Result<tmcl::Reply> BusMaster::ask_module(const product::TmclAddress& module,
                                          const tmcl::Instruction& instruction) {
  const auto answer = ask(
      request_to(module, instruction),
      [module, command = instruction.command](const can::Frame& frame) {
        const auto reply = reply_of(module, frame);
        return reply && reply->command == command;
      },
      kTmclTimeout);
  if (!answer) {
    return master::fail(ErrorCode::timeout, "the module did not answer a command over CAN");
  }
  return *reply_of(module, *answer);
}

}  // namespace stator::manual
