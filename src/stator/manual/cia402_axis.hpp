#pragma once

#include <memory>

#include "stator/manual/axis.hpp"
#include "stator/manual/network_master.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/master/cia402/drive_port.hpp"

namespace stator::manual {

/// An axis of a drive of CiA 402, on EtherCAT or CANopen.
class Cia402Axis final : public Axis {
 public:
  /// Asks the drive for its modes and its profile velocity.
  Cia402Axis(std::unique_ptr<master::DrivePort> port, const AxisPlace& place);

  [[nodiscard]] const AxisDescription& description() const override { return description_; }
  master::Result<AxisStatus> look() override;
  master::Result<void> execute(const Command& command) override;
  master::Result<void> leave() override;

 private:
  [[nodiscard]] bool has(master::OperationMode mode) const;
  /// Gives the profile an acceleration where the drive has none, as it then would never move.
  master::Result<void> complete_profile();
  /// The same of a homing run's speeds and acceleration.
  master::Result<void> complete_homing();
  /// Writes an object that is there and 0.
  master::Result<void> complete(std::uint16_t index, std::uint8_t subindex, double value);
  master::Result<void> choose(master::OperationMode mode);
  master::Result<void> jog(std::int64_t velocity);
  master::Result<void> move(const Command& command);
  /// By the drive's method, which must be another one than 0.
  master::Result<void> home();
  master::Result<void> stop();

  std::unique_ptr<master::DrivePort> port_;
  master::Cia402Client client_;
  AxisDescription description_;
};

}  // namespace stator::manual
