// Distributed clocks as the controller follows them: their events, their SYNC outputs and latch
// inputs, time stamps of buffers.

#include "stator/ethercat/controller/slave_controller.hpp"

namespace stator::ethercat {

void SlaveController::follow_clocks(unsigned work) {
  if ((work & ClockWork::kTakeEvents) != 0) {
    al_event_request_ =
        (al_event_request_ & ~DistributedClockUnit::kAlEvents) | clock_unit_.al_events();
    set_ecat_event(ecat_event::kDcLatch, clock_unit_.bus_event());
  }
  if ((work & ClockWork::kUpdateDeadline) != 0) {
    update_deadline();
  }
}

void SlaveController::set_clock_deviation(std::int32_t ppb) {
  configuration_.clock_deviation_ppb = ppb;
  take_clock_work(clock_unit_.set_deviation(ppb, now_));
  ports_.note_topology_change();
}

base::SimTime SlaveController::next_sync_edge(unsigned output) {
  if (!clock_unit_.knows_sync_edge(output, now_)) {
    advance_sync();
  }
  return clock_unit_.next_sync_edge(output, now_);
}

std::uint64_t SlaveController::sync_pulse_count(unsigned output) {
  advance_sync();
  return clock_unit_.sync_pulse_count(output);
}

bool SlaveController::sync_output(unsigned output) {
  advance_sync();
  return clock_unit_.sync_output(output, now_);
}

PinLevel SlaveController::sync_pin(unsigned output) {
  advance_sync();
  return clock_unit_.sync_pin(output, now_);
}

void SlaveController::set_latch_input(unsigned input, bool level) {
  take_clock_work(clock_unit_.set_latch_input(input, level, now_));
}

void SlaveController::latch_buffer_event(Side side, std::size_t channel, bool start, bool change) {
  const std::uint8_t activation = activations_[channel];
  if (side == Side::bus && change && (activation & kLatchBusEvents) != 0) {
    clock_unit_.latch_bus_change(frame_start_);
  }
  if (side == Side::host && (activation & kLatchHostEvents) != 0) {
    clock_unit_.latch_host_access(start, change, now_);
  }
}

}  // namespace stator::ethercat
