#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "stator/ethercat/standard/frame.hpp"
#include "stator/manual/network_master.hpp"
#include "stator/master/frame_port.hpp"
#include "stator/master/master.hpp"

namespace stator::manual {

/// An EtherCAT master inside a running rack: takes devices of a segment to Operational and
/// exchanges their process data. Those that wait for a firmware beside them it leaves in Init. As
/// long as it is there watchdogs of process data are patient, since the machine may be busy; then
/// each has the time again that it had.
class SegmentMaster final : public NetworkMaster, private master::FramePort {
 public:
  /// `devices`: those of segment `segment` that are taken to Operational, by their places.
  SegmentMaster(rack::RunningRack& running, rack::MasterSeat& seat, std::size_t segment,
                std::vector<std::size_t> devices);

  master::Result<std::unique_ptr<Axis>> axis(const AxisPlace& place) override;
  master::Result<void> set_outputs(rack::DeviceAddress device, std::size_t offset,
                                   std::span<const std::byte> data) override;
  /// Drives that have left Operational are brought back: on a machine that is busy their watchdog
  /// of process data expires now and then.
  master::Result<void> cycle() override;

 private:
  master::Result<void> begin() override;
  void finish() override;
  void displace() override;
  /// Notes where the scan has found each device.
  void find_devices();
  /// Notes the watchdogs' times and makes them patient.
  master::Result<void> set_watchdogs();
  /// Writes the time of watchdogs of process data (0420h), with the rack held.
  void write_watchdogs(ethercat::Command command, std::uint32_t address, std::uint16_t time);

  master::Result<std::size_t> exchange(std::span<const std::byte> frame, std::span<std::byte> reply,
                                       base::SimDuration timeout) override;
  void wait(base::SimDuration duration) override { NetworkMaster::wait(duration); }
  [[nodiscard]] base::SimTime now() override { return running_.machine_now(); }

  /// Whether a device is in Safe-Operational.
  master::Result<bool> left_operational();
  /// Where the scan found the device in that place of the segment, if it answers there still.
  master::Result<std::size_t> position(std::size_t device);

  std::size_t segment_;
  std::vector<std::size_t> devices_;
  master::Master master_;
  std::map<std::size_t, std::size_t> positions_;  ///< by device, of those that the scan has found
  /// What the watchdogs of the slaves had before, by station address; guarded by the rack's mutex.
  std::map<std::uint16_t, std::uint16_t> watchdogs_;
};

}  // namespace stator::manual
