#pragma once

#include <array>
#include <cstdint>

#include "stator/base/servo_signals.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/control/microstep_position.hpp"
#include "stator/control/servo/brake_chopper.hpp"
#include "stator/control/servo/current_controllers.hpp"
#include "stator/control/servo/electrical_angle.hpp"
#include "stator/control/servo/encoder_commutation.hpp"
#include "stator/control/servo/hall_decoder.hpp"
#include "stator/control/servo/i2t_monitor.hpp"
#include "stator/control/servo/pi_controller.hpp"
#include "stator/control/servo/servo_settings.hpp"
#include "stator/control/servo/space_vector.hpp"
#include "stator/control/servo/velocity_meter.hpp"

namespace stator::control {

/// Field-oriented control of a three-phase motor: a position P controller commands a velocity PI
/// controller, that one the PI controllers of torque (q) and flux (d) current, whose voltages the
/// space-vector modulation turns into duties.
///
///   once per 50 us: i_dq = Park(Clarke(i)), u_dq = PI(target - i_dq), |u| <= U / sqrt(3), d first;
///                   duties = modulation(inverse Park(u_dq, angle + 1.5 periods * velocity))
///   once per 1 ms:  velocity, position and velocity loop, limits, I2t, initialisation of the
///   encoder
///
/// The duties computed from the currents of one period act in the period after the next call, as
/// those of a timer with preload registers do: the loop has one period of delay and the half period
/// of its holding. There is no decoupling of the axes, no feed-forward of the back-EMF and no field
/// weakening: the product has no parameters for them; where the voltage ends, so does the velocity.
/// A motor that turns when the loop closes has an EMF of which the current controllers know
/// nothing: for 2 ms their integral time is 8 periods (P permitting), so that it is met before the
/// current it drives brakes the motor and charges the supply.
///
/// State is plain: a controller can be copied out and put back.
class ServoController {
 public:
  static constexpr base::SimDuration kPeriod{50'000};  ///< of the current loop
  static constexpr int kOuterLoopDivider = 20;         ///< current-loop periods per outer loop

  ServoController() { configure(ServoControllerSettings{}); }

  /// Takes parameters. Another commutation mode sets the position to 0 (TMCC160 A-46); another
  /// encoder resolution or direction needs a new initialisation, a changed offset acts at once.
  void configure(const ServoControllerSettings& settings);
  [[nodiscard]] const ServoControllerSettings& settings() const { return settings_; }

  /// Takes what the sensors told at the end of a period and answers for the next one.
  base::ServoActuation step(const ServoSetPoint& set_point, const base::ServoSensing& sensing);
  /// As good as `periods` calls of step() with the loop off, when the latest call had it off, too,
  /// and the sensors tell what they told then.
  void rest(int periods, const base::ServoSensing& sensing);
  /// The latest step() had the loop off.
  [[nodiscard]] bool switched_off() const { return !running_; }

  // Currents, mA (peak). With controlled commutation those of the d axis, which carries the
  // current.
  [[nodiscard]] std::int32_t actual_current() const { return actual_current_; }  ///< 2030h:01
  [[nodiscard]] std::int32_t target_current() const { return target_current_; }  ///< before limits
  [[nodiscard]] std::int32_t ramp_target_current() const {
    return ramp_target_current_;  // 2030h:03, what the controllers get
  }
  [[nodiscard]] std::int32_t torque_error() const { return current_pi_.torque().error; }
  [[nodiscard]] std::int32_t torque_error_sum() const;
  [[nodiscard]] std::int32_t flux_error() const { return current_pi_.flux().error; }
  [[nodiscard]] std::int32_t flux_error_sum() const;

  // Velocities, rpm.
  /// Measured, smoothed with 4 ms: what objects show.
  [[nodiscard]] double velocity() const { return smoothed_velocity_; }
  /// Measured anew each millisecond: what the velocity loop gets.
  [[nodiscard]] double measured_velocity() const { return velocity_; }
  /// Demand of the velocity loop after its limit.
  [[nodiscard]] double velocity_demand() const { return velocity_demand_; }
  [[nodiscard]] std::int32_t velocity_error() const;      ///< 2040h:07
  [[nodiscard]] std::int32_t velocity_error_sum() const;  ///< 2040h:08
  /// The smoothed velocity is not above the parameter's.
  [[nodiscard]] bool motor_halted() const;

  // Position, increments: 6 to an electrical turn with halls, encoder steps otherwise.
  [[nodiscard]] std::int64_t position() const { return origin_ + raw_position(); }
  /// Names the present position; not while the position loop is closed.
  void set_position(std::int64_t position) { origin_ = position - raw_position(); }
  [[nodiscard]] std::int32_t increments_per_revolution() const;
  [[nodiscard]] std::int32_t position_error() const;  ///< 2050h:05

  /// The velocity controller starts anew, from no torque.
  void forget_velocity_error() { velocity_pi_.preset(0); }
  /// The velocity controller asked for more torque than there is.
  [[nodiscard]] bool torque_limited() const { return velocity_pi_.cut() != 0; }

  // Angles, 65536 = one electrical turn, all three at any time.
  [[nodiscard]] std::int16_t open_loop_angle() const { return open_loop_angle_.object_value(); }
  [[nodiscard]] std::int16_t hall_angle() const { return halls_.angle(period_).object_value(); }
  [[nodiscard]] std::int16_t encoder_angle() const { return encoder_.angle().object_value(); }

  /// Halls are in use, and an impossible code or sequence came since the last clear_hall_error().
  [[nodiscard]] bool hall_error() const { return halls_used_ && halls_.error(); }
  void clear_hall_error() { halls_.clear_error(); }

  // Commutation by encoder.
  [[nodiscard]] bool initialised() const { return encoder_.initialised(); }
  [[nodiscard]] bool initialising() const { return encoder_.initialising(); }
  /// The initialisation failed: the bridge stays off until the loop was off and is closed anew.
  [[nodiscard]] bool init_error() const { return encoder_.failed(); }
  /// Commutation offset in force, encoder steps, 0 .. steps per revolution - 1 (2080h:03).
  [[nodiscard]] std::uint16_t encoder_offset() const { return encoder_.offset(); }
  /// Forgets the commutation angle: the next closing of a loop finds it anew.
  void forget_initialisation() { encoder_.forget(); }

  // I2t.
  [[nodiscard]] std::uint32_t i2t_sum() const { return i2t_.sum(); }   ///< A^2 ms
  [[nodiscard]] bool i2t_exceeded() const { return i2t_.exceeded(); }  ///< no current while set
  [[nodiscard]] std::uint32_t i2t_counter() const { return i2t_.counter(); }
  void set_i2t_counter(std::uint32_t value) { i2t_.set_counter(value); }
  void clear_i2t_exceeded() { i2t_.clear_exceeded(); }

  [[nodiscard]] bool brake_chopper_on() const { return chopper_.on(); }
  /// The voltage demanded in the last period was more than the supply gives.
  [[nodiscard]] bool voltage_limited() const { return voltage_limited_; }

 private:
  [[nodiscard]] std::int64_t raw_position() const;
  [[nodiscard]] ElectricalAngle commutation_angle() const;
  [[nodiscard]] EncoderCommutation::Observation observation(
      const base::ServoSensing& sensing) const;

  void sense(const base::ServoSensing& sensing);
  void begin(const ServoSetPoint& set_point, const base::ServoSensing& sensing);
  void catch_turning_motor();
  void end();
  void run_outer_loops(const ServoSetPoint& set_point, const base::ServoSensing& sensing);
  void measure_velocity();
  void initialise_encoder(const base::ServoSensing& sensing);
  void set_field(const EncoderCommutation::Field& field);
  void enter_loop(ServoLoop loop);
  void run_loop(const ServoSetPoint& set_point);
  void limit_torque_by_velocity();
  void set_current_targets(const ServoSetPoint& set_point);
  inline void control_currents(const ServoSetPoint& set_point, const base::ServoSensing& sensing);

  ServoControllerSettings settings_;

  // Of the settings.
  double rpm_of_rate_ = 0.0;                ///< rpm of one increment per period
  double advance_of_rpm_ = 0.0;             ///< electrical turns per rpm in 1.5 periods
  double rate_of_rpm_ = 0.0;                ///< electrical turns per rpm in one period
  double rpm_of_increment_ = 0.0;           ///< position loop
  double increments_of_rpm_ = 0.0;          ///< controlled: increments per rpm in one outer period
  double velocity_limit_ = 0.0;             ///< rpm
  double inverse_velocity_band_ = 0.0;      ///< of the torque's taper
  std::int64_t velocity_output_limit_ = 0;  ///< 2^-16 of velocity_output_unit_
  std::int32_t velocity_output_unit_ = 1;   ///< mA
  std::int32_t torque_limit_ = 0;           ///< mA
  std::int32_t field_current_ = 0;          ///< mA, of an open-loop field

  std::uint32_t period_ = 0;
  int until_outer_loops_ = 1;
  bool halls_used_ = true;  ///< to commutate, or to initialise the encoder
  bool placed_ = false;     ///< the sensors have been read once
  bool running_ = false;
  bool field_driven_ = false;        ///< an imposed angle turns, not the rotor's
  int catching_ = 0;                 ///< outer periods until the EMF of a turning motor is found
  bool targets_each_period_ = true;  ///< otherwise the outer loops alone change current_target_
  bool voltage_limited_ = false;
  ServoLoop loop_ = ServoLoop::off;

  HallDecoder halls_;
  EncoderCommutation encoder_;
  VelocityMeter velocity_meter_;
  ElectricalAngle open_loop_angle_;
  ElectricalAngle open_loop_step_;  ///< per period
  MicrostepPosition field_position_;
  std::int64_t origin_ = 0;

  double velocity_ = 0.0;
  double smoothed_velocity_ = 0.0;
  double velocity_demand_ = 0.0;
  double position_error_ = 0.0;

  VelocityPiController velocity_pi_;
  CurrentControllers current_pi_;
  base::SineCosine advance_{0.0, 1.0};  ///< of the angle in 1.5 periods
  RotorVector current_target_;          ///< mA, what the controllers get
  double square_current_ = 0.0;         ///< A^2, sum of the periods of this millisecond
  std::array<double, 3> duty_{0.5, 0.5, 0.5};
  std::int32_t torque_upper_ = 0;  ///< mA, bounds of the q current at present
  std::int32_t torque_lower_ = 0;
  std::int32_t outer_torque_ = 0;  ///< mA, of the velocity loop
  std::int32_t target_current_ = 0;
  std::int32_t ramp_target_current_ = 0;
  std::int32_t actual_current_ = 0;

  I2tMonitor i2t_;
  BrakeChopper chopper_;
};

}  // namespace stator::control
