#include "master/simulated_drive.hpp"

#include <algorithm>

namespace stator::master::test {

namespace {

constexpr std::uint16_t kNewSetPoint = 0x10;
constexpr std::uint16_t kRelative = 0x40;
constexpr std::uint16_t kFaultReset = 0x80;
constexpr std::int32_t kStep = 100;

}  // namespace

SimulatedDrive::SimulatedDrive(dictionary::Dictionary& dictionary, unsigned axis) {
  const auto at = [axis](unsigned index) {
    return static_cast<std::uint16_t>(index + axis * 0x800);
  };
  error_code_ = dictionary.variable<std::uint16_t>(at(0x603F));
  controlword_ = dictionary.variable<std::uint16_t>(at(0x6040));
  statusword_ = dictionary.variable<std::uint16_t>(at(0x6041));
  mode_ = dictionary.variable<std::int8_t>(at(0x6060));
  mode_display_ = dictionary.variable<std::int8_t>(at(0x6061));
  position_ = dictionary.variable<std::int32_t>(at(0x6064));
  target_position_ = dictionary.variable<std::int32_t>(at(0x607A));
  statusword_.set(static_cast<std::uint16_t>(state_));
}

void SimulatedDrive::fail(std::uint16_t error_code) {
  error_code_.set(error_code);
  state_ = State::fault;
}

void SimulatedDrive::change_state(std::uint16_t controlword) {
  const bool reset_edge = (controlword & ~last_controlword_ & kFaultReset) != 0;
  switch (state_) {
    case State::fault:
      state_ = reset_edge ? State::switch_on_disabled : state_;
      return;
    case State::switch_on_disabled:
      state_ = (controlword & 0x87) == 0x06 ? State::ready_to_switch_on : state_;
      return;
    case State::ready_to_switch_on:
      state_ = (controlword & 0x8F) == 0x07 ? State::switched_on : state_;
      break;
    case State::switched_on:
      state_ = (controlword & 0x8F) == 0x0F ? State::operation_enabled : state_;
      break;
    case State::operation_enabled:
      break;
  }
  if ((controlword & 0x82) == 0) {
    state_ = State::switch_on_disabled;
  }
}

void SimulatedDrive::move(std::uint16_t controlword) {
  if (state_ != State::operation_enabled) {
    target_ = position_.get();
    set_point_taken_ = false;
    return;
  }
  if ((controlword & ~last_controlword_ & kNewSetPoint) != 0) {
    target_ = target_position_.get() + ((controlword & kRelative) != 0 ? target_ : 0);
  }
  set_point_taken_ = (controlword & kNewSetPoint) != 0;
  position_.set(position_.get() + std::clamp(target_ - position_.get(), -kStep, kStep));
}

void SimulatedDrive::tick() {
  const std::uint16_t controlword = frozen_ ? last_controlword_ : controlword_.get();
  change_state(controlword);
  move(controlword);
  last_controlword_ = controlword;
  mode_display_.set(frozen_ ? mode_display_.get() : mode_.get());
  const bool reached = state_ == State::operation_enabled && position_.get() == target_;
  statusword_.set(static_cast<std::uint16_t>(static_cast<unsigned>(state_) |
                                             (reached ? 1U << 10 : 0U) |
                                             (set_point_taken_ ? 1U << 12 : 0U)));
}

}  // namespace stator::master::test
