#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "stator/can/frame.hpp"
#include "stator/manual/network_master.hpp"
#include "stator/product/catalogue/parts.hpp"
#include "stator/rack/core/bus_port.hpp"
#include "stator/rack/run/bus_thread.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::manual {

/// A device on a CAN bus, by what reaches it.
struct BusMember {
  std::size_t device = 0;  ///< its place on the bus
  std::optional<std::uint8_t> node_id{};
  std::optional<product::TmclAddress> tmcl{};
};

/// A master on a CAN bus inside a running rack: starts the nodes of CANopen and reads and writes
/// their objects by SDO, and sends commands of TMCL to modules.
class BusMaster final : public NetworkMaster {
 public:
  using IsAnswer = rack::BusThread::FramePredicate;

  /// `thread` is that of bus `bus` and outlives the master.
  BusMaster(rack::RunningRack& running, rack::BusThread& thread, std::size_t bus,
            std::vector<BusMember> members);
  ~BusMaster() override;

  master::Result<std::unique_ptr<Axis>> axis(const AxisPlace& place) override;
  master::Result<void> cycle() override;

  /// Sends `request` and waits for the next frame that is its answer; nothing: none came in time.
  std::optional<can::Frame> ask(const can::Frame& request, const IsAnswer& is_answer,
                                base::SimDuration timeout);
  [[nodiscard]] base::SimTime now() const { return running_.machine_now(); }

 private:
  master::Result<void> begin() override;
  void finish() override;
  /// Gives modules back what they are owed. These answers and one that is waited for are nobody
  /// else's, who would take them for those to his own commands.
  void displace() override;

  /// `is_answer`: of what is waited for then, if it is a request.
  bool put(const can::Frame& frame, const IsAnswer& is_answer = {});
  master::Result<tmcl::Reply> ask_module(const product::TmclAddress& module,
                                         const tmcl::Instruction& instruction);

  rack::BusThread& thread_;
  std::size_t bus_;
  std::vector<BusMember> members_;
  // Guarded by the rack's mutex.
  std::optional<rack::BusPort> port_;
  IsAnswer awaited_;  ///< empty: nothing is waited for
  /// With which commands modules have again what they had before, by member and motor.
  std::map<std::pair<std::size_t, std::uint8_t>, tmcl::Instruction> owed_;
};

}  // namespace stator::manual
