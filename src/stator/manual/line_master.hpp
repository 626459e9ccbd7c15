#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/manual/network_master.hpp"
#include "stator/rack/run/serial_line_thread.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::manual {

/// A module on a serial line.
struct LineMember {
  rack::DeviceAddress device;
  std::uint8_t address = 1;  ///< global parameter 66
};

/// A host on a serial line inside a running rack, which sends commands of TMCL. What devices send
/// meanwhile goes to it and not to the line's link.
class LineMaster final : public NetworkMaster {
 public:
  /// `thread` is that of line `line` and outlives the master.
  LineMaster(rack::RunningRack& running, rack::SerialLineThread& thread, std::size_t line,
             std::vector<LineMember> members);
  ~LineMaster() override;

  master::Result<std::unique_ptr<Axis>> axis(const AxisPlace& place) override;
  master::Result<void> cycle() override;

 private:
  master::Result<void> begin() override;
  void finish() override;
  void displace() override { disconnect(); }

  void disconnect();
  void hear(std::span<const std::byte> bytes);
  master::Result<tmcl::Reply> ask(std::uint8_t address, const tmcl::Instruction& instruction);

  rack::SerialLineThread& thread_;
  std::size_t line_;
  std::vector<LineMember> members_;
  // Guarded by the rack's mutex.
  bool connected_ = false;
  std::vector<std::byte> heard_;
};

}  // namespace stator::manual
