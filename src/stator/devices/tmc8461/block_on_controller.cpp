#include "stator/devices/tmc8461/block_on_controller.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::devices::tmc8461 {

namespace {

constexpr unsigned kStateMask = 0x0F;

}  // namespace

BlockOnController::BlockOnController(ethercat::SlaveController& controller, mfc::Block& block)
    : controller_(controller), block_(block) {
  controller_.set_memory_partner(this);
  block_.set_process_data(this);
  parameters_changed(controller_.now());
  std::array<std::byte, 2> status{};
  controller_.peek(ethercat::register_address::kAlStatus, status);
  al_status_changed(controller_.now(), base::load_le<std::uint16_t>(status));
}

BlockOnController::~BlockOnController() {
  controller_.set_memory_partner(nullptr);
  block_.set_process_data(nullptr);
}

void BlockOnController::advance(base::SimTime to) {
  for (;;) {
    const base::SimTime edge =
        std::min(controller_.next_sync_edge(0), controller_.next_sync_edge(1));
    if (edge > to || edge <= controller_.now()) {
      break;
    }
    controller_.advance(edge);
    advance_block(edge);
    tell_pulses();
  }
  controller_.advance(to);
  advance_block(to);
  tell_pulses();
}

// The board is not brought back: if `to` has passed, as the moment of a frame may have, all that
// was due at it is done already.
void BlockOnController::advance_block(base::SimTime to) {
  if (board_ == nullptr) {
    block_.advance(to);
  } else if (to >= board_->time()) {
    board_->advance(to);
  }
}

base::SimTime BlockOnController::next_event() {
  return std::min({controller_.next_sync_edge(0), controller_.next_sync_edge(1),
                   controller_.next_deadline(),
                   board_ != nullptr ? board_->next_event() : block_.next_event()});
}

void BlockOnController::tell_pulses() {
  constexpr std::array<mfc::Trigger, 2> kTriggers{mfc::Trigger::sync0, mfc::Trigger::sync1};
  for (unsigned output = 0; output < kTriggers.size(); ++output) {
    const std::uint64_t count = controller_.sync_pulse_count(output);
    for (pulses_[output] = std::min(pulses_[output], count); pulses_[output] < count;
         ++pulses_[output]) {
      block_.trigger(kTriggers[output]);
    }
  }
}

void BlockOnController::set_latch_input(unsigned input, bool level) {
  controller_.set_latch_input(input, level);
  advance_block(controller_.now());
  if (level && !latches_[input]) {
    block_.trigger(input == 0 ? mfc::Trigger::latch0 : mfc::Trigger::latch1);
  }
  latches_[input] = level;
}

void BlockOnController::start_of_frame(base::SimTime time) {
  advance_block(time);
  tell_pulses();
  block_.trigger(mfc::Trigger::start_of_frame);
}

void BlockOnController::end_of_frame(base::SimTime time) {
  advance_block(time);
  block_.trigger(mfc::Trigger::end_of_frame);
}

void BlockOnController::before_bus_read(base::SimTime time, std::uint16_t address,
                                        std::size_t length) {
  advance_block(time);
  block_.before_bus_read(address, length);
}

void BlockOnController::after_bus_write(base::SimTime time, std::uint16_t address,
                                        std::size_t length) {
  advance_block(time);
  block_.after_bus_write(address, length);
}

void BlockOnController::parameters_changed(base::SimTime time) {
  advance_block(time);
  std::array<std::byte, mfc::Configuration::kLength> parameters{};
  controller_.peek(mfc::Configuration::kAddress, parameters);
  block_.load_configuration(parameters);
}

void BlockOnController::al_status_changed(base::SimTime time, std::uint16_t al_status) {
  advance_block(time);
  block_.set_al_state(static_cast<std::uint8_t>(al_status & kStateMask));
}

void BlockOnController::controller_reset(base::SimTime time) {
  advance_block(time);
  block_.reset();
}

void BlockOnController::read(std::uint16_t address, std::span<std::byte> out) {
  controller_.read_process_data(address, out);
}

void BlockOnController::write(std::uint16_t address, std::span<const std::byte> data) {
  controller_.write_process_data(address, data);
}

void BlockOnController::finish(std::uint16_t address, std::size_t length) {
  controller_.finish_process_data(address, length);
}

}  // namespace stator::devices::tmc8461
