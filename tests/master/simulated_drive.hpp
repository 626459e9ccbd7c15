#pragma once

#include <cstdint>

#include "stator/dictionary/dictionary.hpp"

namespace stator::master::test {

/// As much of a CiA 402 drive as a client can tell: the power state machine, and a position that
/// jumps towards its target by 100 per millisecond. Lives on the objects of one axis.
class SimulatedDrive {
 public:
  SimulatedDrive(dictionary::Dictionary& dictionary, unsigned axis);

  /// One millisecond.
  void tick();

  /// Falls into Fault with this error code.
  void fail(std::uint16_t error_code);
  /// Ignores all commands from now on.
  void freeze() { frozen_ = true; }
  void set_position(std::int32_t position) { position_.set(position); }

  /// Positions in Operation enabled, for tests that must not see a jump.
  [[nodiscard]] std::int32_t target_taken() const { return target_; }

 private:
  enum class State : std::uint16_t {
    switch_on_disabled = 0x40,
    ready_to_switch_on = 0x21,
    switched_on = 0x23,
    operation_enabled = 0x27,
    fault = 0x08,
  };
  void change_state(std::uint16_t controlword);
  void move(std::uint16_t controlword);

  dictionary::Variable<std::uint16_t> error_code_;
  dictionary::Variable<std::uint16_t> controlword_;
  dictionary::Variable<std::uint16_t> statusword_;
  dictionary::Variable<std::int8_t> mode_;
  dictionary::Variable<std::int8_t> mode_display_;
  dictionary::Variable<std::int32_t> position_;
  dictionary::Variable<std::int32_t> target_position_;
  State state_ = State::switch_on_disabled;
  std::uint16_t last_controlword_ = 0;
  std::int32_t target_ = 0;
  bool set_point_taken_ = false;
  bool frozen_ = false;
};

}  // namespace stator::master::test
