#pragma once

#include <cstdint>

#include "stator/control/foc/register_file.hpp"

namespace stator::control::foc {

/// The open-loop angle generator (L641-L649, reading A-40): whole electrical rpm ramp by
/// OPENLOOP_ACCELERATION rpm/s to OPENLOOP_VELOCITY_TARGET; the angle has 48 bits behind the 16 of
/// OPENLOOP_PHI. Velocity is exact, the angle drifts by less than 2e-10 of what it turned.
class OpenLoopGenerator {
 public:
  void configure(const RegisterFile& registers) {
    target_ = registers.get(field("OPENLOOP_VELOCITY_TARGET"));
    acceleration_ = registers.get_unsigned(field("OPENLOOP_ACCELERATION"));
    reversed_ = registers.get(field("OPENLOOP_PHI_DIRECTION")) != 0;
  }

  /// `ticks` of 10 ns pass.
  void step(std::int32_t ticks) {
    if (velocity_ != target_) [[unlikely]] {
      accelerate(ticks);
    }
    // Overflow is whole revolutions.
    const auto turned = static_cast<std::uint64_t>(std::int64_t{velocity_}) *
                        (kAngleOfRpmTick * static_cast<std::uint64_t>(ticks));
    angle_ += reversed_ ? 0 - turned : turned;
  }

  void set_velocity(std::int32_t rpm) {
    velocity_ = rpm;
    gained_ = 0;
  }
  void set_phi(std::uint16_t phi) { angle_ = std::uint64_t{phi} << 48U; }

  [[nodiscard]] std::int32_t velocity() const { return velocity_; }  ///< rpm
  [[nodiscard]] std::uint16_t phi() const { return static_cast<std::uint16_t>(angle_ >> 48U); }

 private:
  /// 2^64 / (60 s x 1e8): one rpm for 10 ns.
  static constexpr std::uint64_t kAngleOfRpmTick = 3'074'457'346;

  void accelerate(std::int32_t ticks) {
    constexpr std::uint64_t kTicksPerSecond = 100'000'000;
    gained_ += std::uint64_t{acceleration_} * static_cast<std::uint64_t>(ticks);
    const auto whole = static_cast<std::int64_t>(gained_ / kTicksPerSecond);
    gained_ %= kTicksPerSecond;
    const std::int64_t missing = std::int64_t{target_} - velocity_;
    if (missing > 0) {
      velocity_ += static_cast<std::int32_t>(missing < whole ? missing : whole);
    } else {
      velocity_ -= static_cast<std::int32_t>(-missing < whole ? -missing : whole);
    }
  }

  std::int32_t target_ = 0;
  std::int32_t velocity_ = 0;
  std::uint32_t acceleration_ = 0;
  bool reversed_ = false;
  std::uint64_t gained_ = 0;  ///< 1e-8 rpm not yet part of velocity_
  std::uint64_t angle_ = 0;   ///< 2^64 = one electrical revolution
};

}  // namespace stator::control::foc
