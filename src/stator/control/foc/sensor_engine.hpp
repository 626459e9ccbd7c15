#pragma once

#include <array>
#include <cstdint>

#include "stator/control/foc/abn_decoder.hpp"
#include "stator/control/foc/analog_decoder.hpp"
#include "stator/control/foc/biquad.hpp"
#include "stator/control/foc/hall_decoder.hpp"
#include "stator/control/foc/open_loop_generator.hpp"
#include "stator/control/foc/register_file.hpp"
#include "stator/control/foc/velocity_meter.hpp"

namespace stator::control::foc {

/// Codes of PHI_E_SELECTION, VELOCITY_SELECTION and POSITION_SELECTION.
enum class AngleSource : std::uint8_t {
  phi_e = 0,  ///< what PHI_E_SELECTION chooses; for velocity and position only
  phi_e_external = 1,
  phi_e_open_loop = 2,
  phi_e_abn = 3,
  phi_e_hall = 5,
  phi_e_analog = 6,
  phi_a_analog = 7,
  phi_m_abn = 9,
  phi_m_abn_2 = 10,
  phi_m_analog = 11,
  phi_m_hall = 12,
};

/// All decoders, the choice of angles, and velocity and position made of them.
class SensorEngine {
 public:
  void configure(const RegisterFile& registers, std::int32_t hall_filter);

  /// `ticks` of 10 ns have passed; `pwm` is the period that ended.
  void step(const Inputs& inputs, const EncoderGroup& analog, const PwmPeriod& pwm,
            std::int32_t ticks) {
    abn_.step(inputs.abn);
    abn_2_.step(inputs.abn_2);
    hall_.step(inputs.halls, pwm, ticks);
    analog_.step(analog);
    open_loop_.step(ticks);
    phi_e_ = angle(phi_e_source_);
    const std::int32_t position =
        position_source_ == AngleSource::phi_e ? phi_e_ : angle(position_source_);
    position_ =
        wrap_s32(std::int64_t{position_} + wrap_s16(std::int64_t{position} - position_angle_));
    position_angle_ = position;
    std::int32_t velocity = position;
    if (velocity_source_ != position_source_) {
      velocity = velocity_source_ == AngleSource::phi_e ? phi_e_ : angle(velocity_source_);
    }
    const std::int32_t turned = wrap_s16(std::int64_t{velocity} - velocity_angle_);
    velocity_angle_ = velocity;
    velocity_ = velocity_filter_.step(meter_.step(turned, ticks));
  }

  /// Electrical angle for commutation, s16.
  [[nodiscard]] std::int32_t phi_e() const { return phi_e_; }
  [[nodiscard]] std::int32_t velocity() const { return velocity_; }  ///< rpm
  [[nodiscard]] std::int32_t position() const { return position_; }  ///< 65536 per revolution
  void set_position(std::int32_t position) { position_ = position; }

  [[nodiscard]] AbnDecoder& abn() { return abn_; }
  [[nodiscard]] const AbnDecoder& abn() const { return abn_; }
  [[nodiscard]] AbnDecoder& abn_2() { return abn_2_; }
  [[nodiscard]] const AbnDecoder& abn_2() const { return abn_2_; }
  [[nodiscard]] const HallDecoder& hall() const { return hall_; }
  [[nodiscard]] AnalogDecoder& analog() { return analog_; }
  [[nodiscard]] const AnalogDecoder& analog() const { return analog_; }
  [[nodiscard]] OpenLoopGenerator& open_loop() { return open_loop_; }
  [[nodiscard]] const OpenLoopGenerator& open_loop() const { return open_loop_; }
  [[nodiscard]] const VelocityMeter& meter() const { return meter_; }

 private:
  /// Angle of a source, s16; 0 of phi_e and of reserved codes.
  [[nodiscard]] std::int32_t angle(AngleSource source) const {
    switch (source) {
      case AngleSource::phi_e_abn:
        return abn_.phi_e();
      case AngleSource::phi_m_abn:
        return abn_.phi_m();
      case AngleSource::phi_e_hall:
        return hall_.phi_e_used();
      default:
        return rarer_angle(source);
    }
  }
  [[nodiscard]] std::int32_t rarer_angle(AngleSource source) const;

  AbnDecoder abn_;
  AbnDecoder abn_2_;
  HallDecoder hall_;
  AnalogDecoder analog_;
  OpenLoopGenerator open_loop_;
  VelocityMeter meter_;
  Biquad velocity_filter_;
  AngleSource phi_e_source_ = AngleSource::phi_e;
  AngleSource velocity_source_ = AngleSource::phi_e;
  AngleSource position_source_ = AngleSource::phi_e;
  std::int32_t external_ = 0;  ///< PHI_E_EXT
  std::int32_t phi_e_ = 0;
  std::int32_t velocity_angle_ = 0;
  std::int32_t velocity_ = 0;
  std::int32_t position_angle_ = 0;
  std::int32_t position_ = 0;
};

}  // namespace stator::control::foc
