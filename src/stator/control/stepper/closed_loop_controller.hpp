#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "stator/base/sim_time.hpp"
#include "stator/control/stepper/rotor_observer.hpp"

namespace stator::control {

/// Parameters of a closed-loop stepper axis. Angles are in 1/256 full steps: 256 = 90 degree
/// electrical; velocities in 1/256 full steps per second.
struct ClosedLoopSettings {
  bool enabled = false;  ///< wanted (TMCM-3315: 2020h)

  // Load angle (2021h, 2022h, 2027h)
  std::uint32_t position_gain = 0;  ///< angle per deviation beyond the tolerance, 65536 = 1
  int tolerance = 0;                ///< deviation up to which the gain is 1
  int beta = 255;                   ///< largest load angle, 0..511

  // Field weakening (2034h, 2035h, 2036h)
  double weakening_start = 0.0;  ///< velocity up to which beta is the limit
  double weakening_range = 0.0;  ///< above it, until all of gamma is added; both 0: none
  int gamma = 255;

  // Current (2029h, 202Ah, 2030h, 2031h)
  int minimum_scale = 0;            ///< of 255, at load angle 0
  int maximum_scale = 255;          ///< of 255, at beta and beyond
  std::uint32_t upscale_delay = 0;  ///< clock cycles of 16 MHz for one scale step; 0 = at once
  std::uint32_t downscale_delay = 0;

  // Position catch-up (202Bh, 202Ch, 202Dh, 202Fh)
  std::uint32_t catch_up_gain = 0;      ///< velocity per lag, 256 = 1/s
  std::uint32_t catch_up_integral = 0;  ///< velocity per error sum, 65536 = 1/s
  std::uint32_t error_sum_limit = 0;    ///< of the sum taken at 125 kHz, in units of 65536
  double catch_up_velocity = 0.0;       ///< highest correction

  friend bool operator==(const ClosedLoopSettings&, const ClosedLoopSettings&) = default;
};

/// Commutates a stepper motor by its encoder, as the closed loop of the TMC4361 does: no cascade of
/// current controllers, but a limit for the load angle, which is the angle from the rotor to the
/// current vector, and a current that follows it.
///
///   deviation = set-point - rotor
///   vector    = rotor + clip(gain * deviation, -limit, +limit)
///   limit     = beta + gamma * clip((velocity - start) / range, 0, 1), at most 180 degree
///
/// The velocity of the limit counts in the direction of the angle: gamma makes up for the lag of
/// the current at speed where the motor drives; where it brakes the lag acts the other way.
///
/// With gain 1 the vector stands where the ramp says as long as the load angle stays within the
/// limit. An overload takes rotor and vector along; the set-point in force then lags behind the
/// ramp's and returns to it with the velocity of a PI regulator:
///   correction = clip(P * lag + I * sum, -v_max, +v_max),   sum += lag at 125 kHz, limited
/// The velocity of the set-point in force hence exceeds the ramp's by at most v_max. Until 50 ms
/// after it has arrived, the vector leads or trails it in proportion to the rotor's lack or excess
/// of velocity: a rotor would swing about a mere vector for long.
///
/// The current is a share of the run current: scale = min + (max - min) * |load angle| / beta,
/// followed up and down at the rates of the two delays.
///
/// Positions are those of the motor's own coordinate in 1/256 full steps, as StepperStage keeps
/// them. A step costs some 15 multiplications; what depends on settings is computed when they
/// change.
class ClosedLoopController {
 public:
  enum class Phase : std::uint8_t { off, initialising, active };

  struct Input {
    std::int64_t setpoint = 0;       ///< of the ramp at the end of this step
    double velocity = 0.0;           ///< of the ramp, 1/256 full steps per second
    std::int64_t encoder_count = 0;  ///< at its begin
    bool may_initialise = false;     ///< the set-point rests and nothing holds the shaft
    /// Torque control: share of the run current (signed, 1 = all) at the largest load angle
    /// instead of following the set-point.
    std::optional<double> torque;
  };
  struct Commutation {
    std::int64_t vector = 0;  ///< where the current vector has to stand
    double current = 1.0;     ///< share of the run current
  };

  ClosedLoopController() { prepare(); }

  /// Takes parameters and encoder; cheap when nothing has changed. With another encoder the
  /// commutation is unknown: off, until start().
  void configure(const ClosedLoopSettings& settings, const EncoderScale& scale);

  /// Begins the initialisation: the vector stays at the set-point with the run current until the
  /// encoder has been still for 100 ms; then the difference of the two is the commutation offset.
  void start();
  void stop() { phase_ = Phase::off; }
  /// Lets `duration` pass. Not to be called in phase off.
  Commutation advance(const Input& input, base::SimDuration duration);

  [[nodiscard]] Phase phase() const { return phase_; }
  [[nodiscard]] bool active() const { return phase_ == Phase::active; }
  /// 2028h: position of the vector at encoder count 0 (modulo 1024: the electrical angle).
  [[nodiscard]] std::int32_t commutation_offset() const { return offset_; }
  /// Overrides the measured one; turns the commutation angle by the difference at once.
  void set_commutation_offset(std::int32_t offset);
  /// Present factor of the current, 0..255.
  [[nodiscard]] std::uint8_t current_scale() const {
    constexpr double kRounding = 1e-6;  // of steps added up in binary
    return static_cast<std::uint8_t>(scale_ + kRounding);
  }
  /// Set-point minus rotor, 1/256 full steps.
  [[nodiscard]] double deviation() const { return deviation_; }
  /// What the set-point in force lags behind that of the ramp.
  [[nodiscard]] double lag() const { return lag_; }
  [[nodiscard]] double load_angle() const { return angle_; }
  /// Largest load angle at the present velocity, in its direction.
  [[nodiscard]] double angle_limit() const { return limit_at(std::fabs(rotor_.velocity())); }
  [[nodiscard]] const RotorObserver& rotor() const { return rotor_; }

 private:
  void prepare();
  void prepare_step(base::SimDuration duration);
  void await_stillness(const Input& input, base::SimDuration duration);
  void begin(const Input& input);
  [[nodiscard]] double limit_at(double velocity) const;
  [[nodiscard]] double limit_toward(double angle) const {
    return limit_at(angle < 0.0 ? -rotor_.velocity() : rotor_.velocity());
  }
  void catch_up();
  [[nodiscard]] double follow_set_point(double velocity);
  [[nodiscard]] double damped(double angle, double gain, double velocity);
  void scale_current();

  ClosedLoopSettings settings_;
  EncoderScale encoder_;
  RotorObserver rotor_;

  // Of the settings.
  double tolerance_ = 0.0;
  double gain_ = 0.0;
  double inverse_gain_ = 0.0;
  double beta_ = 255.0;
  double gamma_ = 0.0;
  double weakening_slope_ = 0.0;
  double minimum_scale_ = 0.0;
  double maximum_scale_ = 0.0;
  double scale_slope_ = 0.0;
  double catch_up_gain_ = 0.0;
  double catch_up_integral_ = 0.0;
  double error_sum_limit_ = 0.0;
  // Of the duration of a step.
  base::SimDuration duration_;
  double seconds_ = 0.0;
  double upscale_step_ = 0.0;
  double downscale_step_ = 0.0;
  double samples_per_step_ = 0.0;

  Phase phase_ = Phase::off;
  std::int64_t still_count_ = 0;
  base::SimDuration still_;
  std::int32_t offset_ = 0;
  double deviation_ = 0.0;
  double lag_ = 0.0;
  double error_sum_ = 0.0;
  double correction_ = 0.0;         ///< velocity with which lag_ shrinks
  base::SimDuration damping_left_;  ///< after the set-point in force has arrived
  double angle_ = 0.0;
  double scale_ = 0.0;
};

}  // namespace stator::control
