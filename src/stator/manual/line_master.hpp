#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
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
  /// Gives modules back what they are owed. The line is handed over once they have replied, as
  /// nobody else has asked for these replies.
  void displace() override;

  void disconnect();
  void hear(std::span<const std::byte> bytes);
  void send(std::uint8_t address, const tmcl::Instruction& instruction);
  master::Result<tmcl::Reply> ask(std::uint8_t address, const tmcl::Instruction& instruction);

  rack::SerialLineThread& thread_;
  std::size_t line_;
  std::vector<LineMember> members_;
  // Guarded by the rack's mutex.
  bool connected_ = false;
  std::vector<std::byte> heard_;
  std::size_t awaited_ = 0;  ///< bytes of replies to what was sent
  /// With which commands modules have again what they had before, by address and motor.
  std::map<std::pair<std::uint8_t, std::uint8_t>, tmcl::Instruction> owed_;
};

}  // namespace stator::manual
