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

/// Of process data, in steps of 100 us: as slave controllers leave their reset, and while this
/// master is there.
constexpr std::uint16_t kUsualWatchdog = 1'000;
constexpr std::uint16_t kPatientWatchdog = 20'000;

/// Of AL status: the state, without the error indication.
constexpr std::byte kAlStateMask{0x0F};

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
  {
    const std::scoped_lock lock(running_.mutex);
    if (ended()) {
      return base::Unexpected{why_ended()};
    }
    set_watchdogs(kPatientWatchdog);
    patient_ = true;
  }
  std::vector<std::size_t> positions;
  for (const std::size_t device : devices_) {
    // One that is switched off is told of when somebody wants it.
    if (const auto found = position(device)) {
      positions.push_back(*found);
    }
  }
  if (auto configured = master_.configure_process_data(positions); !configured) {
    return configured;
  }
  return master_.go_operational();
}

// One datagram to all, which comes back to nobody: who displaces this master finds the watchdogs
// as they leave their reset, whatever they were set to before, when its own first frame passes.
void SegmentMaster::set_watchdogs(std::uint16_t time) {
  std::array<std::byte, 2> data{};
  base::store_le(data.data(), time);
  std::array<std::byte, ethercat::kMinimumFrameLength> buffer{};
  ethercat::FrameBuilder frame(buffer, master_.options().source_mac);
  frame.append(ethercat::Command::bwr, 0,
               ethercat::physical_address(0, ethercat::register_address::kProcessDataWatchdogTime),
               data);
  const base::SimTime now = running_.now();
  static_cast<void>(running_.rack.process_frame(segment_, frame.finish(), now));
  running_.rack.handle_bus_events(segment_, now);
}

void SegmentMaster::displace() {
  if (patient_) {
    set_watchdogs(kUsualWatchdog);
  }
}

Result<void> SegmentMaster::cycle() {
  auto passed = master_.run_cycle();
  return passed && left_operational() ? master_.go_operational() : passed;
}

// Process data still pass in Safe-Operational, so the working counter does not tell.
bool SegmentMaster::left_operational() const {
  const std::scoped_lock lock(running_.mutex);
  return std::ranges::any_of(devices_, [this](std::size_t device) {
    std::array<std::byte, 1> status{};
    running_.rack.segment(segment_).slave(device).peek(ethercat::register_address::kAlStatus,
                                                       status);
    return static_cast<ethercat::AlState>(status[0] & kAlStateMask) ==
           ethercat::AlState::safe_operational;
  });
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

// The controller keeps the address that the scan gave it, as long as it has supply.
Result<std::size_t> SegmentMaster::position(std::size_t device) {
  std::array<std::byte, 2> bytes{};
  {
    const std::scoped_lock lock(running_.mutex);
    running_.rack.segment(segment_).slave(device).peek(ethercat::register_address::kStationAddress,
                                                       bytes);
  }
  const auto address = base::load_le<std::uint16_t>(bytes);
  const auto found = std::ranges::find(master_.slaves(), address, &master::Slave::station_address);
  if (found == master_.slaves().end()) {
    return master::fail(ErrorCode::no_slaves,
                        "the device does not answer on its segment: it is switched off, or a "
                        "cable before it is broken");
  }
  return std::size_t{found->position};
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
