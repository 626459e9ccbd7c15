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
              return bus_.ask(request, CanSdoClient::kAnswer + node_id_, kSdoTimeout);
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

bool BusMaster::put(const can::Frame& frame) {
  {
    const std::scoped_lock lock(running_.mutex);
    if (ended() || !port_) {
      return false;
    }
    while (port_->take()) {
      // What passed before the request is no answer to it.
    }
    running_.catch_up();
    static_cast<void>(port_->put(frame));
  }
  thread_.wake();
  return true;
}

std::optional<can::Frame> BusMaster::ask(const can::Frame& request, std::uint32_t identifier,
                                         base::SimDuration timeout) {
  if (!put(request)) {
    return std::nullopt;
  }
  const base::SimTime deadline = now() + timeout;
  while (!ended() && now() < deadline) {
    wait(kPoll);
    const std::scoped_lock lock(running_.mutex);
    running_.catch_up();
    while (const auto entry = port_->take()) {
      const can::Frame& frame = entry->frame;
      if (!entry->destroyed && !frame.extended && !frame.remote && frame.identifier == identifier) {
        return frame;
      }
    }
  }
  return std::nullopt;
}

Result<void> BusMaster::cycle() {
  wait(kCycle);
  return ended() ? base::Unexpected{why_ended()} : Result<void>();
}

Result<std::unique_ptr<Axis>> BusMaster::axis(const AxisPlace& place) {
  const auto member = std::ranges::find(members_, place.device.device, &BusMember::device);
  if (member->node_id) {
    return std::unique_ptr<Axis>(
        std::make_unique<Cia402Axis>(std::make_unique<NodePort>(*this, *member->node_id), place));
  }
  return std::unique_ptr<Axis>(std::make_unique<TmclAxis>(
      [this, module = *member->tmcl](const tmcl::Instruction& instruction) {
        return ask_module(module, instruction);
      },
      place));
}

// On CAN the telegram goes without address and checksum.
Result<tmcl::Reply> BusMaster::ask_module(const product::TmclAddress& module,
                                          const tmcl::Instruction& instruction) {
  constexpr std::size_t kCanBytes = 7;
  const tmcl::Telegram telegram = tmcl::encode(tmcl::Request{.address = module.serial,
                                                             .command = instruction.command,
                                                             .type = instruction.type,
                                                             .motor = instruction.motor,
                                                             .value = instruction.value});
  const auto answer =
      ask(can::data_frame(module.can, std::span<const std::byte>(telegram).subspan(1, kCanBytes)),
          module.can_reply, kTmclTimeout);
  if (!answer || answer->length < kCanBytes) {
    return master::fail(ErrorCode::timeout, "the module did not answer a command over CAN");
  }
  tmcl::Telegram reply{};
  std::ranges::copy(answer->payload().first(kCanBytes), reply.begin() + 1);
  return tmcl::decode_reply(reply);
}

}  // namespace stator::manual
