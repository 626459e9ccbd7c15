#include "stator/manual/segment_master.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/manual/cia402_axis.hpp"
#include "stator/master/cia402/slave_drive_port.hpp"

namespace stator::manual {

using master::ErrorCode;
using master::Result;

namespace {

/// Well below the watchdogs of process data (100 ms as devices leave their boxes), so that a busy
/// machine may be late.
constexpr base::SimDuration kProcessDataCycle{4'000'000};

/// Of process data, in steps of 100 us, while this master is there.
constexpr std::uint16_t kPatientWatchdog = 20'000;

}  // namespace

SegmentMaster::SegmentMaster(rack::RunningRack& running, rack::MasterSeat& seat,
                             std::size_t segment, std::vector<std::size_t> devices)
    : NetworkMaster(running, seat),
      segment_(segment),
      devices_(std::move(devices)),
      master_(*this, {.cycle_time = kProcessDataCycle}) {}

Result<void> SegmentMaster::begin() {
  if (auto scanned = master_.scan(); !scanned) {
    return scanned;
  }
  find_devices();
  if (auto set = set_watchdogs(); !set) {
    return set;
  }
  std::vector<std::size_t> positions;
  for (const std::size_t device : devices_) {
    // One that is switched off is told of when somebody wants it.
    if (const auto found = positions_.find(device); found != positions_.end()) {
      positions.push_back(found->second);
    }
  }
  if (auto configured = master_.configure_process_data(positions); !configured) {
    return configured;
  }
  return master_.go_operational();
}

// Which of several equal devices is the one that a person means, no frame tells: as a person sees
// it in the cabinet, it is looked up in the rack, once, by the address that the scan has given it.
void SegmentMaster::find_devices() {
  const std::scoped_lock lock(running_.mutex);
  for (const std::size_t device : devices_) {
    std::array<std::byte, 2> address{};
    running_.rack.segment(segment_).slave(device).peek(ethercat::register_address::kStationAddress,
                                                       address);
    const auto found =
        std::ranges::find(master_.slaves(), base::load_le<std::uint16_t>(address.data()),
                          &master::Slave::station_address);
    if (found != master_.slaves().end()) {
      positions_[device] = found->position;
    }
  }
}

Result<void> SegmentMaster::set_watchdogs() {
  std::map<std::uint16_t, std::uint16_t> before;
  for (const master::Slave& slave : master_.slaves()) {
    std::array<std::byte, 2> time{};
    if (auto read = master_.read_registers(
            slave.position, ethercat::register_address::kProcessDataWatchdogTime, time);
        !read) {
      if (read.error().code == ErrorCode::working_counter) {
        continue;  // it has no such watchdog
      }
      return read;
    }
    before[slave.station_address] = base::load_le<std::uint16_t>(time.data());
  }
  const std::scoped_lock lock(running_.mutex);
  if (ended()) {
    return base::Unexpected{why_ended()};
  }
  watchdogs_ = std::move(before);
  write_watchdogs(
      ethercat::Command::bwr,
      ethercat::physical_address(0, ethercat::register_address::kProcessDataWatchdogTime),
      kPatientWatchdog);
  return {};
}

void SegmentMaster::write_watchdogs(ethercat::Command command, std::uint32_t address,
                                    std::uint16_t time) {
  std::array<std::byte, 2> data{};
  base::store_le(data.data(), time);
  std::array<std::byte, ethercat::kMinimumFrameLength> buffer{};
  ethercat::FrameBuilder frame(buffer, master_.options().source_mac);
  frame.append(command, 0, address, data);
  const base::SimTime now = running_.now();
  static_cast<void>(running_.rack.process_frame(segment_, frame.finish(), now));
  running_.rack.handle_bus_events(segment_, now);
}

// Frames that come back to nobody: who displaces this master finds the watchdogs as they were when
// its own first frame passes.
void SegmentMaster::displace() {
  for (const auto& [station, time] : std::exchange(watchdogs_, {})) {
    write_watchdogs(
        ethercat::Command::fpwr,
        ethercat::physical_address(station, ethercat::register_address::kProcessDataWatchdogTime),
        time);
  }
}

Result<void> SegmentMaster::cycle() {
  auto passed = master_.run_cycle();
  if (!passed) {
    return passed;
  }
  const auto left = left_operational();
  if (!left) {
    return base::Unexpected{left.error()};
  }
  return *left ? master_.go_operational() : passed;
}

// Process data still pass in Safe-Operational, so the working counter does not tell. Of all states
// only this one has its bit, so those of slaves that are left alone do not matter.
Result<bool> SegmentMaster::left_operational() {
  constexpr auto kSafeOperational = static_cast<std::uint16_t>(ethercat::AlState::safe_operational);
  const auto states = master_.al_status_of_all();
  return states ? Result<bool>((*states & kSafeOperational) != 0)
                : base::Unexpected{states.error()};
}

void SegmentMaster::finish() {
  {
    const std::scoped_lock lock(running_.mutex);
    if (!ended()) {
      displace();
    }
  }
  static_cast<void>(master_.stop());
}

Result<std::unique_ptr<Axis>> SegmentMaster::axis(const AxisPlace& place) {
  const auto found = position(place.device.device);
  if (!found) {
    return base::Unexpected{found.error()};
  }
  return std::unique_ptr<Axis>(std::make_unique<Cia402Axis>(
      std::make_unique<master::SlaveDrivePort>(master_, *found), place));
}

Result<void> SegmentMaster::set_outputs(rack::DeviceAddress device, std::size_t offset,
                                        std::span<const std::byte> data) {
  const auto found = position(device.device);
  if (!found) {
    return base::Unexpected{found.error()};
  }
  const std::span<std::byte> outputs = master_.outputs(*found);
  if (offset > outputs.size() || data.size() > outputs.size() - offset) {
    return master::fail(ErrorCode::argument, "the device has " + std::to_string(outputs.size()) +
                                                 " bytes of output process data");
  }
  std::ranges::copy(data, outputs.subspan(offset).begin());
  return {};
}

// A slave that has lost its supply has lost the address that the scan gave it, too.
Result<std::size_t> SegmentMaster::position(std::size_t device) {
  const auto found = positions_.find(device);
  if (found != positions_.end()) {
    const auto status = master_.al_status(found->second);
    if (status) {
      return found->second;
    }
    if (status.error().code != ErrorCode::working_counter) {
      return base::Unexpected{status.error()};
    }
  }
  return master::fail(ErrorCode::no_slaves,
                      "the device does not answer on its segment: it is switched off, or a "
                      "cable before it is broken");
}

Result<std::size_t> SegmentMaster::exchange(std::span<const std::byte> frame,
                                            std::span<std::byte> reply, base::SimDuration timeout) {
  bool answered = false;
  {
    const std::scoped_lock lock(running_.mutex);
    if (ended()) {
      return base::Unexpected{why_ended()};
    }
    if (!frame.empty()) {
      const auto passing = reply.first(frame.size());
      std::ranges::copy(frame, passing.begin());
      const base::SimTime now = running_.now();
      answered = running_.rack.process_frame(segment_, passing, now).has_value();
      running_.rack.handle_bus_events(segment_, now);
      running_.catch_up();
    }
  }
  if (!answered) {
    wait(timeout);
    return std::size_t{0};
  }
  return frame.size();
}

}  // namespace stator::manual
