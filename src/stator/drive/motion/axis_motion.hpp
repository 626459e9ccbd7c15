#pragma once

#include <cstdint>
#include <optional>

#include "stator/base/sim_time.hpp"
#include "stator/control/ramp/ramp_generator.hpp"
#include "stator/drive/motion/axis_objects.hpp"
#include "stator/drive/motion/axis_settings.hpp"

namespace stator::drive {

/// Limit switches that a homing motion may pass.
struct PassedSwitches {
  bool negative_limit = false;
  bool positive_limit = false;
};

/// What reaches the loops inside beside what the outer ones ask for.
struct FeedForward {
  double velocity = 0.0;  ///< pps
  double torque = 0.0;    ///< A
};

/// What the shaft of a servo axis does now, as its sensors tell it.
struct ShaftState {
  std::int64_t position = 0;  ///< increments
  double velocity = 0.0;      ///< pps
  double standstill = 0.0;    ///< pps below which the shaft counts as standing
  /// s by which the demand has to be ahead of the shaft for the position loop to ask for the
  /// demand's velocity: 0 where that velocity is fed forward.
  double lead = 0.0;
  bool free = false;  ///< no current holds it
};

/// Which loop of a servo axis takes the set-point. A stepper axis turns every position into
/// currents, whatever it was made from.
enum class ControlLoop : std::uint8_t { position, velocity, torque };

/// What the modes of operation may do with the motor: every set-point passes here, where software
/// position limits (607Dh) and limit switches hold for all modes.
///
/// What stops, limits and answers "does it stand" is the shaft. A servo axis tells it with
/// follow_shaft(); the shaft of an axis that never does is its counter, the demand. A stop takes
/// over from the shaft where the demand has left it: the velocity loop brings it down from the
/// velocity it has, and out of a mode with positions the position loop holds it where it comes to
/// rest; out of the others it stands under velocity control.
///
/// Positions are 64-bit increments: microsteps of a stepper axis, encoder counts or hall steps of a
/// servo axis; the objects show the lower 32 bits. An absolute target means the position with these
/// lower bits in the present turn of the 32-bit counter. With a position scale (homing methods -5
/// and -6) objects show scaled increments and the counter has one turn.
class AxisMotion {
 public:
  /// Everything must outlive the object; `period` is the time between two calls of supervise().
  AxisMotion(const AxisObjects& objects, const AxisSettings& settings,
             const AxisConditions& conditions, base::SimDuration period)
      : objects_(objects), settings_(settings), conditions_(conditions), period_(period) {}

  /// Scaled increments of position objects per increment of the position; more than 0.
  void set_position_scale(double scale) { scale_ = scale; }
  [[nodiscard]] double position_scale() const { return scale_; }
  /// What a position object shows for `increments`, and the reverse; also for distances.
  [[nodiscard]] std::int64_t scaled(std::int64_t increments) const;
  [[nodiscard]] std::int64_t unscaled(std::int64_t object) const;

  /// Absolute target of profile position in 64 bits.
  [[nodiscard]] std::int64_t absolute(std::int32_t object) const;
  /// Cyclic target in 64 bits: the position nearest to the present one with the lower bits of
  /// `target` plus `offset`, whatever turn of the 32-bit counter that is in. A software limit is
  /// compared with the sum, which does not wrap.
  [[nodiscard]] std::int64_t cyclic(std::int32_t target, std::int32_t offset) const;

  /// Travels on the profile of 6081h to 6084h, 6086h and 60A4h; the target is clamped to the
  /// software limits. Returns the target in force. Without RampSettings::active the set-point is on
  /// the target at once.
  std::int64_t move_to(std::int64_t target);
  /// Takes up `velocity` (pps) with 6083h, 6084h, 6086h and 60A4h, as far as the ramp generator
  /// goes. One that would run into a software limit is not taken: the axis travels to the limit and
  /// rests there, however often such velocities come. With stops_behind_software_limits it is
  /// stopped where the position has passed the limit.
  void move_at_velocity(double velocity);
  /// Interpolates to a cyclic target within 60C2h; clamped to the software limits. Outside them the
  /// axis may stay or return, it is not pulled back. A target in force is a command in every cycle:
  /// once a limit switch, a changed limit or a stop has held the axis back, it catches the target
  /// up with 6081h, 6083h and 6084h, and follows it again from there on.
  void follow_position(std::int64_t target);
  /// Interpolates to `velocity` (pps) within 60C2h; at a software limit as move_at_velocity(), with
  /// 6084h. Caught up with 6083h and 6084h as a position is.
  void follow_velocity(double velocity);
  /// The cyclic target is what the axis works at: nothing holds it back.
  [[nodiscard]] bool follows_target() const;
  /// Accompanies the cyclic set-point that was followed just now, until anything else is commanded;
  /// one that is held back at a limit goes without.
  void feed_forward(const FeedForward& ahead) { ahead_ = limited() ? FeedForward{} : ahead; }
  [[nodiscard]] const FeedForward& feed_forward() const { return ahead_; }
  /// Homing: takes up `velocity` (pps) with 609Ah. Software limits do not hold, for the position
  /// means nothing yet; a limit switch that may not be passed stops the motor.
  void search_at_velocity(double velocity, const PassedSwitches& passed);
  /// Homing: travels to `target` in the same way; `velocity` is not negative.
  void search_to(std::int64_t target, double velocity, const PassedSwitches& passed);
  /// Homing: search_at_velocity() by the velocity loop of a servo axis, which may be held up.
  void push_at_velocity(double velocity, const PassedSwitches& passed);

  /// cst: `amperes` of phase current (signed) at the largest load angle instead of a set-point. At
  /// a limit the axis brakes and holds its position until the torque points away from the limit, or
  /// the limit has gone.
  void apply_torque(double amperes);
  /// The torque in force; none while set-points are.
  [[nodiscard]] std::optional<double> torque() const { return torque_; }
  /// While a torque is in force the set-point follows the rotor, which is `deviation` microsteps
  /// behind and turns with `velocity` (pps): whatever comes next starts from where the motor is.
  /// Call every control period.
  void follow_rotor(double deviation, double velocity);

  /// Of a servo axis, every control period. Outside the position loop, and while the shaft is free
  /// of current, the demand follows it, so that whatever comes next starts from there.
  void follow_shaft(const ShaftState& shaft);
  /// The loop that the set-point is for.
  [[nodiscard]] ControlLoop loop() const {
    return torque_ ? ControlLoop::torque : loop_without_torque_;
  }
  /// The position loop takes over at once, also in motion: from a demand that makes it ask for the
  /// velocity there is.
  void hold_position();
  /// A mode begins: a shaft that turns is braked with 6084h first, one that stands is held. A
  /// cyclic target is followed at once, as the profile has it, but behind a
  /// stop that was taken back, or under halt.
  void settle(bool behind_stop);
  /// Gives a motion up that went wrong: the demand rests where the shaft of a servo axis is.
  void rest_at_shaft();

  /// Brakes with 6084h (and the bows of a profile under way), after a homing motion with 609Ah, by
  /// the quick stop ramp with 6085h, or at once, from the velocity of the shaft on. A torque
  /// without a deceleration to brake with ends in coasting.
  void brake(Braking braking);
  /// How often a stop has taken over from a shaft that did not follow: what the loops inside have
  /// summed up until then was for another demand.
  [[nodiscard]] std::uint32_t takeovers() const { return takeovers_; }
  /// The latest command was to stop.
  [[nodiscard]] bool stopping() const;
  /// Renames the present position; a motion under way ends at once.
  void set_position(std::int64_t microsteps) { ramp_.set_position(microsteps); }

  /// Applies changed profile objects, software limits and limit switches. Call every control
  /// period.
  void supervise();
  /// Stops a motion into a limit switch that is pressed now; returns whether there was one. A
  /// target away from the switch that comes while the axis still slows down is kept.
  bool obey_limit_switches();
  void advance(base::SimDuration duration) { ramp_.advance(duration); }
  /// Of a stepper axis, whose shaft is its counter: what its ramp generator can hold (pps), with
  /// which a stop begins after a cyclic target that asked for more.
  void set_maximum_velocity(double velocity) { ramp_.set_maximum_velocity(velocity); }

  [[nodiscard]] const control::RampGenerator& ramp() const { return ramp_; }
  [[nodiscard]] std::int64_t position() const { return ramp_.position().microsteps; }
  /// The position at which the motor had made `motor_microsteps` since power-on.
  [[nodiscard]] std::int64_t position_of(std::int64_t motor_microsteps) const {
    return position() - (ramp_.motor_microsteps() - motor_microsteps);
  }
  [[nodiscard]] double velocity() const { return ramp_.velocity(); }
  /// The demand rests.
  [[nodiscard]] bool at_rest() const { return ramp_.at_rest(); }
  /// The demand rests and the shaft stands.
  [[nodiscard]] bool stands() const;
  /// The same as of now, without waiting that it lasts: nothing has to be braked.
  [[nodiscard]] bool settled() const;
  /// pps of the shaft of a servo axis, 0 where it counts as standing; 0 of others.
  [[nodiscard]] double shaft_velocity() const { return is_slow() ? 0.0 : shaft_velocity_; }
  /// Target of profile position as far as limits let it be.
  [[nodiscard]] std::int64_t target() const { return passed_target_; }
  /// Profile position has passed its target and goes on with the end velocity.
  [[nodiscard]] bool goes_on() const { return goes_on_; }
  /// Takes the end velocity up in `direction`, as behind a target that was passed.
  void go_on(double direction);
  /// What was commanded last is held back: it was cut down to a software limit or to what the ramp
  /// generator holds, or a limit switch blocks it now.
  [[nodiscard]] bool limited() const { return clamped_ || blocked_direction_ != 0.0; }

  /// 607Dh corrected by the home offset, in the present turn of the 32-bit counter and not beyond
  /// its ends. The extreme values of INTEGER32 are no limit: none if both are in force, else the
  /// counter's end.
  [[nodiscard]] std::optional<std::int64_t> lower_limit() const;
  [[nodiscard]] std::optional<std::int64_t> upper_limit() const;

 private:
  /// What is under way: a motion whose limits follow changed profile objects, or the way to a
  /// software limit instead of a velocity.
  enum class Profile : std::uint8_t {
    none,
    positioning,
    velocity,
    search,
    to_limit,
    immediate,  ///< to the target without a ramp; the shaft is still on its way
  };

  /// What is commanded anew in every cycle.
  enum class Cyclic : std::uint8_t { none, position, velocity };

  [[nodiscard]] std::int64_t turn() const;
  [[nodiscard]] bool has_limits() const;
  [[nodiscard]] std::int64_t between_limits(std::int64_t target) const;
  [[nodiscard]] bool switch_blocks(double direction) const;
  [[nodiscard]] bool blocked_by_switch(double direction);
  void stop_at_switch(double direction);
  [[nodiscard]] bool pulls(double direction) const;
  [[nodiscard]] double way_into_switch() const;
  void take_over_from_shaft();
  void bring_demand_down();
  void stop_on(double deceleration);
  void end_stop();
  [[nodiscard]] bool stood() const;
  [[nodiscard]] bool is_slow() const;
  [[nodiscard]] bool is_held(double velocity) const;
  void keep_target_within_limits();
  void follow_profile_objects(const control::RampLimits& limits);
  [[nodiscard]] double within_largest(double velocity) const;
  void note_cyclic(std::int64_t target);
  [[nodiscard]] std::int64_t within_limits(std::int64_t target) const;
  [[nodiscard]] bool has_ramp() const;
  void catch_up();
  void catch_up_position();
  void catch_up_velocity();
  void approach(double way);
  void resume_velocity();
  [[nodiscard]] double lead_way(double velocity) const;
  [[nodiscard]] bool hold_has_ended() const;
  [[nodiscard]] bool limit_blocks(double direction) const;
  [[nodiscard]] control::RampLimits profile_limits() const;
  [[nodiscard]] control::RampLimits velocity_limits() const;
  [[nodiscard]] control::RampLimits search_limits(double velocity) const;
  [[nodiscard]] control::RampLimits limits_before_limit(bool on_profile) const;
  [[nodiscard]] double switch_deceleration() const;
  [[nodiscard]] double profile_velocity() const;
  [[nodiscard]] double end_velocity() const;
  [[nodiscard]] std::int64_t overrun(double way) const;
  void go_on_behind_target();
  void stop_behind_limit(double direction);
  [[nodiscard]] bool search_blocked(double direction, const PassedSwitches& passed);
  [[nodiscard]] bool turns_back() const;
  void rest_at(std::int64_t position, double velocity);
  void take_up(double velocity, bool on_profile);
  [[nodiscard]] double limit_passed_by(const control::RampGenerator& ramp, bool on_profile) const;
  void travel_to_limit(double direction, bool on_profile);
  void watch_software_limits();
  void end_torque() {
    torque_.reset();
    held_direction_ = 0.0;
    ahead_ = {};
    goes_on_ = false;
  }
  /// A limit ends the torque in force.
  void hold_against(double direction);

  const AxisObjects& objects_;
  const AxisSettings& settings_;
  const AxisConditions& conditions_;
  base::SimDuration period_;
  control::RampGenerator ramp_;
  FeedForward ahead_;
  double scale_ = 1.0;                           ///< of position objects
  double blocked_direction_ = 0.0;               ///< in which a limit switch blocks; 0 = none does
  double commanded_velocity_ = 0.0;              ///< pps, the last one, as it came
  double wanted_velocity_ = 0.0;                 ///< pps, the same, within the largest velocity
  double limit_direction_ = 0.0;                 ///< in Profile::to_limit
  std::optional<std::int64_t> travelled_limit_;  ///< in Profile::to_limit
  std::int64_t passed_target_ = 0;               ///< of positioning with an end velocity
  std::optional<double> torque_;                 ///< A
  double held_direction_ = 0.0;                  ///< of the torque that ran into a limit, 0 = none
  std::optional<std::int64_t> held_limit_;       ///< software limit there at that time

  // The shaft of a servo axis, as last told, and the stop that has taken over from it.
  std::int64_t shaft_position_ = 0;
  double shaft_velocity_ = 0.0;                ///< pps
  double filtered_velocity_ = 0.0;             ///< pps, the same
  base::SimDuration standing_{1'000'000'000};  ///< for how long it has been slow, or held
  double standstill_ = 0.0;                    ///< pps
  double lead_ = 0.0;                          ///< s, see ShaftState
  double stop_deceleration_ = 0.0;             ///< of the latest stop, pps/s

  std::int64_t cyclic_target_ = 0;   ///< as it came
  std::int64_t cyclic_allowed_ = 0;  ///< within the limits
  double cyclic_way_ = 0.0;          ///< from the cyclic target before, or the position
  base::SimDuration cyclic_age_;     ///< since it came

  std::uint32_t takeovers_ = 0;
  Profile profile_ = Profile::none;
  ControlLoop loop_without_torque_ = ControlLoop::position;
  Cyclic cyclic_ = Cyclic::none;
  PassedSwitches passed_;    ///< in Profile::search
  bool clamped_ = false;     ///< the last command was not taken as it came
  bool goes_on_ = false;     ///< behind the target of positioning with an end velocity
  bool measured_ = false;    ///< the axis tells what its shaft does
  bool free_ = true;         ///< no current holds the shaft
  bool stopping_ = false;    ///< a stop has taken over from the shaft
  bool holds_then_ = false;  ///< and the position loop takes over from it
  bool held_back_ = false;   ///< something other than the cyclic target moved the axis
};

}  // namespace stator::drive
