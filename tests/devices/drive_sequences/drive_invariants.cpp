#include "devices/drive_sequences/drive_invariants.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <numbers>
#include <sstream>

namespace stator::tests {

namespace {

constexpr double kPeriod = 1e-3;  // s between two samples
constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kMoreTime = 1.2;      // a ramp may take a fifth longer than it says
constexpr double kUsableTorque = 0.8;  // of the limit, in spite of ripple and regulation
constexpr double kLag = 2e-3;          // s from sampling a position to showing it
constexpr int kBitTime = 20;           // ms in which a bit of the statusword follows

struct InvariantRow {
  Invariant invariant;
  std::string_view name;
  std::string_view reason;
};
constexpr std::array<InvariantRow, kInvariants> kRows{{
    {Invariant::stops, "stops",
     "CiA 402-2 605Ah to 605Eh: the motor comes to rest on the ramp named, or as hard as torque "
     "and supply allow"},
    {Invariant::demand_on_ramp, "demand on its ramp",
     "CiA 402-2 6083h to 6085h, 609Ah: no demand changes faster than its acceleration"},
    {Invariant::behind_switch, "behind a switch",
     "a pressed limit switch lets nothing move outward but for the way to stop"},
    {Invariant::behind_software_limit, "behind a software limit",
     "CiA 402-2 607Dh: behind a limit nothing moves outward but for the way to stop"},
    {Invariant::power_off, "power off",
     "CiA 402-2 8.3: a ramp ends before the drive function is disabled"},
    {Invariant::halt_reached, "halt reached", "CiA 402-2 6041h: bit 10 in halt: velocity 0"},
    {Invariant::target_reached, "target reached",
     "CiA 402-2 6041h bit 10, 6067h, 606Dh: actual value within the window"},
    {Invariant::follows, "follows", "CiA 402-2 6041h bit 12: drive follows the command value"},
    {Invariant::internal_limit, "internal limit",
     "CiA 402-2 6041h bit 11: an internal limit is active"},
    {Invariant::shown_position, "position shown", "CiA 402-2 6064h is where the shaft is"},
    {Invariant::shown_velocity, "velocity shown", "CiA 402-2 606Ch is how fast the shaft is"},
    {Invariant::current, "current", "CiA 402-2 6072h, 6073h: no more current than allowed"},
    {Invariant::supply, "supply",
     "a motor feeds back what shaft and load give, and nothing into a supply that is too high"},
    {Invariant::numbers, "numbers", "everything recorded is a number"},
    {Invariant::runs_for_ever, "runs for ever", "a shaft that nothing drives comes to rest"},
    {Invariant::works_afterwards, "works afterwards",
     "after fault reset and enabling a drive moves to a target"},
}};

template <typename... Parts>
std::string joined(const Parts&... parts) {
  std::ostringstream text;
  text << std::setprecision(5);
  (text << ... << parts);
  return text.str();
}

}  // namespace

std::string_view to_text(StopCause cause) {
  constexpr std::array<std::string_view, kStopCauses> kNames{
      "no stop",        "halt",    "quick stop",  "shutdown", "disable operation",
      "fault reaction", "network", "mode change", "command"};
  return kNames[static_cast<std::size_t>(cause)];
}

std::string_view to_text(Invariant invariant) {
  return kRows[static_cast<std::size_t>(invariant)].name;
}

std::string_view reason_of(Invariant invariant) {
  return kRows[static_cast<std::size_t>(invariant)].reason;
}

void StoppingEnvelope::begin(double speed, double position) {
  begin_position_ = position;
  allowed_way_ = 0.0;
  active_ = true;
  begin_speed_ = ramp_ = allowed_ = std::max(0.0, speed);
  gentlest_ = std::numeric_limits<double>::infinity();
  waited_ = excess_ = 0.0;
}

bool StoppingEnvelope::exceeded(const DriveTraits& traits, double speed, double tolerance) {
  const double above = speed - allowed_ - tolerance;
  excess_ = above > 0.0 ? excess_ + (speed - allowed_) * kPeriod : 0.0;
  return excess_ > traits.settle;
}

bool StoppingEnvelope::overrun(const DriveTraits& traits, double way, double speed,
                               double disturbance) {
  constexpr double kMoreSettle = 4.0;  // a target that was overshot is found again
  const bool moves = allowed_ > traits.standstill;
  allowed_way_ += (disturbance + (moves ? allowed_ + traits.standstill : 0.0)) * kPeriod;
  const bool creeps = !moves && speed > traits.standstill + disturbance;
  excess_ = creeps ? excess_ + speed * kPeriod : 0.0;
  return (speed > 0.0 && way > allowed_way_ + traits.settle) ||
         excess_ > kMoreSettle * traits.settle;
}

void StoppingEnvelope::pass(const Sample& sample, const DriveTraits& traits, double deceleration,
                            double speed, double direction) {
  gentlest_ = std::min(gentlest_, deceleration);
  const double lag = traits.lag * std::max(1.0, sample.inertia / traits.inertia);
  if (waited_ < traits.reaction) {
    waited_ += kPeriod;
    // The current is reversed within milliseconds; until then the motor may drive on.
    const double torque = sample.torque_limit + std::max(0.0, sample.load * direction);
    const double more = traits.reversal * torque / sample.inertia / kTurn;
    ramp_ = std::max(ramp_, std::min(speed, begin_speed_ + more));
    allowed_ = std::max(allowed_, ramp_);
    return;
  }
  const double capability =
      kUsableTorque * sample.torque_limit + sample.friction - sample.load * direction;
  const bool held =
      capability > 0.05 * sample.torque_limit &&
      std::abs(sample.velocity) < traits.no_load_velocity * std::min(sample.supply, sample.source);
  if (!held) {  // a load drives it that the motor cannot hold, or the supply cannot
    ramp_ = std::max(ramp_, speed);
    allowed_ = std::max(allowed_, speed);
    return;
  }
  const double achievable = capability / sample.inertia / kTurn;
  ramp_ = std::max(0.0, ramp_ - std::min(gentlest_, achievable) * kPeriod / kMoreTime);
  allowed_ += (ramp_ - allowed_) * kPeriod / (lag + kPeriod);
}

void DriveInvariants::violate(Invariant invariant, base::SimTime time, std::string text) {
  if (!violation_ && !excepted_.contains(invariant)) {
    violation_ = DriveViolation{invariant, time, std::move(text)};
  }
}

void DriveInvariants::see(const Sample& now) {
  if (violation_) {
    return;
  }
  if (!numbers_are_finite(now)) {
    violate(Invariant::numbers, now.time, "a value is not finite");
    return;
  }
  if (!before_) {
    before_ = now;
    before_->power = false;
    before_->load = 0.0;
  }
  speeds_[speed_] = now.velocity;
  speed_ = (speed_ + 1) % speeds_.size();
  follow_disturbance(now);
  since_change_ = now.reference_changed ? 0 : since_change_ + 1;
  since_power_ = now.power != before_->power ? 0 : since_power_ + 1;
  judge_stop(now);
  judge_switches(now);
  judge_software_limits(now);
  judge_demand(now);
  judge_power(now);
  judge_bits(now);
  judge_actual_values(now);
  judge_stage(now);
  before_ = now;
}

bool DriveInvariants::numbers_are_finite(const Sample& now) const {
  const std::array values{now.position,        now.velocity,       now.current,
                          now.supply,          now.demand,         now.supplied_energy,
                          now.demand_velocity, now.shown_position, now.shown_velocity,
                          now.shown_torque};
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

// A step of the load moves the shaft against the stiffness of the velocity loop; the integrator and
// the position loop bring it back.
void DriveInvariants::follow_disturbance(const Sample& now) {
  disturbance_ -= disturbance_ * kPeriod / traits_.integral_time;
  if (now.load != before_->load) {
    disturbance_ +=
        2.0 * std::abs(now.load - before_->load) / (traits_.inertia * traits_.bandwidth) / kTurn;
  }
}

void DriveInvariants::judge_stop(const Sample& now) {
  const StopState& stop = now.stop;
  ++since_stop_;
  if (traits_.shaft_is_counter && !now.power && since_power_ > 2 && now.velocity != 0.0) {
    violate(Invariant::stops, now.time,
            joined("the motor has no power, its counter runs with ", now.velocity, " rev/s"));
    return;
  }
  if (stop.cause == StopCause::none || stop.unbounded || !now.power) {
    stop_.end();
    return;
  }
  const double speed = std::abs(now.velocity);
  if (!stop_.active() || before_->stop.cause != stop.cause) {
    const double allowed = stop_.active() ? stop_.allowed() : std::abs(before_->velocity);
    stop_.begin(std::max(allowed, before_->stop.cause == StopCause::none ? speed : 0.0));
    since_stop_ = 0;
  }
  const double direction = now.velocity < 0.0 ? -1.0 : 1.0;
  stop_.pass(now, traits_, stop.deceleration, speed, direction);
  const double tolerance = traits_.standstill + disturbance_;
  if (stop_.exceeded(traits_, speed, tolerance)) {
    violate(Invariant::stops, now.time,
            joined(to_text(stop.cause), ": the shaft turns with ", now.velocity, " rev/s ",
                   since_stop_, " ms after a begin with ", stop_.begin_speed(),
                   " rev/s; by now it may have ", stop_.allowed(), " (ramp ", stop.deceleration,
                   " rev/s², torque limit ", now.torque_limit, " N m, load ", now.load,
                   " N m, inertia ", now.inertia, " kg m²)"));
  }
}

void DriveInvariants::judge_outward(Invariant invariant, StoppingEnvelope& envelope,
                                    const Sample& now, bool holds, double outward,
                                    double deceleration) {
  if (!holds || !now.power || now.searching || now.stop.unbounded) {
    envelope.end();
    return;
  }
  const double speed = std::max(0.0, outward * now.velocity);
  if (!envelope.active()) {
    envelope.begin(std::max(speed, outward * before_->velocity), before_->position);
    since_stop_ = 0;
  }
  const double weaker = now.stop.cause == StopCause::none
                            ? deceleration
                            : std::min(deceleration, now.stop.deceleration);
  envelope.pass(now, traits_, weaker, speed, outward);
  const double way = outward * (now.position - envelope.begin_position());
  if (envelope.overrun(traits_, way, speed, disturbance_)) {
    violate(invariant, now.time,
            joined(outward < 0.0 ? "negative" : "positive", " limit: the shaft is ", way,
                   " rev behind where it was with ", envelope.begin_speed(), " rev/s, ",
                   envelope.allowed_way(), " rev are the way to stop; it goes outward with ", speed,
                   " rev/s (ramp ", weaker, " rev/s², mode ", now.mode, ", ",
                   to_text(now.stop.cause), ", statusword ", now.statusword, ")"));
  }
}

void DriveInvariants::judge_switches(const Sample& now) {
  for (std::size_t side = 0; side < 2; ++side) {
    const double outward = side == 0 ? -1.0 : 1.0;
    const bool pressed = side == 0 ? now.negative_switch : now.positive_switch;
    if (!switch_[side].active()) {
      stopped_by_switch_[side] = outward * before_->demand_velocity > 0.0;
    }
    judge_outward(Invariant::behind_switch, switch_[side], now, pressed, outward,
                  now.switch_deceleration);
  }
}

void DriveInvariants::judge_software_limits(const Sample& now) {
  for (std::size_t side = 0; side < 2; ++side) {
    const double beyond =
        side == 0 ? now.lower_limit - now.shown_position : now.shown_position - now.upper_limit;
    judge_outward(Invariant::behind_software_limit, limit_[side], now,
                  beyond > 0.0 && !now.reference_changed && now.mode != 0, side == 0 ? -1.0 : 1.0,
                  now.limit_deceleration);
  }
}

/// Whether the demand starts from what the shaft does, as a sensor with a filter of a few
/// milliseconds tells it.
bool DriveInvariants::takes_over_shaft(const Sample& now, double limit) const {
  constexpr std::size_t kFilter = 5;  // ms
  const double tolerance = traits_.velocity_error + 2.0 * limit * kPeriod;
  double lowest = std::min({now.velocity, now.shown_velocity, before_->shown_velocity});
  double highest = std::max({now.velocity, now.shown_velocity, before_->shown_velocity});
  for (std::size_t i = 1; i <= kFilter; ++i) {
    const double velocity = speeds_[(speed_ + speeds_.size() - i) % speeds_.size()];
    lowest = std::min(lowest, velocity);
    highest = std::max(highest, velocity);
  }
  if (now.stop.cause != StopCause::none) {
    // On its way there: a stop brings the demand down to a shaft that something else has braked.
    lowest = std::min(lowest, before_->demand_velocity);
    highest = std::max(highest, before_->demand_velocity);
  }
  return now.demand_velocity >= lowest - tolerance && now.demand_velocity <= highest + tolerance;
}

void DriveInvariants::judge_demand(const Sample& now) {
  const Sample& before = *before_;
  const bool stopping = now.stop.cause != StopCause::none || before.stop.cause != StopCause::none;
  const bool guided = now.guidance == Guidance::ramp && before.guidance == Guidance::ramp;
  const bool torque = now.guidance == Guidance::torque || before.guidance == Guidance::torque;
  if (!now.power || !before.power || since_power_ < 3 || since_change_ < 3 || torque ||
      (!guided && !stopping) || now.stop.unbounded || before.stop.unbounded) {
    return;
  }
  double limit = std::max(before.acceleration, now.acceleration);
  for (const StopState& stop : {before.stop, now.stop}) {
    if (stop.cause != StopCause::none) {
      limit = std::max(limit, stop.deceleration);
    }
  }
  // A stop that is taken back may come down to 0 on its ramp first.
  const bool comes_down = std::abs(now.demand_velocity) < std::abs(before.demand_velocity);
  stop_ramp_ = stopping || comes_down ? std::max(stop_ramp_, limit) : 0.0;
  limit = comes_down ? std::max(limit, stop_ramp_) : limit;
  const double change = std::abs(now.demand_velocity - before.demand_velocity);
  // Within a millisecond a ramp may come down to 0 and go up on the other side.
  const bool turns = now.demand_velocity * before.demand_velocity < 0.0;
  if (change <= (turns ? 2.2 : 1.1) * limit * kPeriod + 1e-6) {
    return;
  }
  if (!traits_.shaft_is_counter && takes_over_shaft(now, limit)) {
    return;
  }
  if (now.demand_velocity == 0.0 && std::abs(before.demand_velocity) <= 1.01 * now.end_velocity) {
    return;
  }
  violate(Invariant::demand_on_ramp, now.time,
          joined("the demand changes from ", before.demand_velocity, " to ", now.demand_velocity,
                 " rev/s in 1 ms, ", limit, " rev/s² are in force (mode ", now.mode, ", ",
                 to_text(now.stop.cause), ", shaft ", now.velocity, " rev/s)"));
}

void DriveInvariants::judge_power(const Sample& now) {
  powered_although_ = now.power && now.has_to_be_off ? powered_although_ + 1 : 0;
  constexpr int kSwitchingTime = 5;  // ms
  if (powered_although_ > kSwitchingTime) {
    violate(Invariant::power_off, now.time,
            joined("Disable voltage is commanded, the bridge is still on (statusword ",
                   now.statusword, ")"));
  }
  if (!before_->power || now.power || now.power_off != PowerOff::not_allowed) {
    return;
  }
  // A sensor that sees no motion yet, within a step of its own, cannot be asked for more.
  const double seen = std::max(std::abs(now.shown_velocity), std::abs(before_->shown_velocity));
  if (std::min(std::abs(now.velocity), seen) > traits_.standstill + disturbance_) {
    const double capability = kUsableTorque * now.torque_limit + now.friction - std::abs(now.load);
    if (capability > 0.0) {
      violate(Invariant::power_off, now.time,
              joined("the bridge goes off at ", now.velocity,
                     " rev/s (before: ", to_text(before_->stop.cause), ", statusword ",
                     before_->statusword, " -> ", now.statusword, ")"));
    }
  }
}

void DriveInvariants::judge_bits(const Sample& now) {
  if (!traits_.has_statusword) {
    return;
  }
  const auto count = [](int& milliseconds, bool wrong) {
    milliseconds = wrong ? milliseconds + 1 : 0;
    return milliseconds > kBitTime;
  };
  const double tolerance = traits_.standstill + disturbance_;
  double slowest = std::abs(now.velocity);
  for (const double speed : speeds_) {
    slowest = std::min(slowest, std::abs(speed));
  }
  const bool reached = (now.statusword & 0x0400) != 0;
  if (count(halted_bit_, now.stop.cause == StopCause::halt && reached && slowest > tolerance)) {
    violate(Invariant::halt_reached, now.time,
            joined("bit 10 is 1 in halt, the shaft turns with ", now.velocity, " rev/s (mode ",
                   now.mode, ")"));
  }
  const bool position_mode = now.mode == 1;
  const bool velocity_mode = now.mode == 3;
  const double off = std::abs(now.shown_position - now.target);
  const double too_fast = std::abs(now.shown_velocity - now.target_velocity);
  const bool off_target =
      (position_mode && off > now.window + 1e-9) ||
      (velocity_mode && too_fast > now.velocity_window + traits_.velocity_error);
  if (count(reached_bit_, now.target_reached_bit && reached && off_target)) {
    violate(Invariant::target_reached, now.time,
            joined("bit 10 is 1, ",
                   position_mode ? joined(off, " rev from the target, the window has ", now.window)
                                 : joined(too_fast, " rev/s from the target"),
                   " (mode ", now.mode, ")"));
  }
  // What is commanded leads into a limit that holds the axis.
  const double lead = now.mode == 9 || now.mode == 3
                          ? now.target_velocity
                          : (std::abs(now.target - now.shown_position) > traits_.follows_within
                                 ? now.target - now.shown_position
                                 : 0.0);
  const std::size_t side = lead < 0.0 ? 0 : 1;
  const bool pressed = lead < 0.0 ? now.negative_switch : lead > 0.0 && now.positive_switch;
  // What a switch stopped in pv waits for a new target when it is released.
  const bool inward = now.demand_velocity * lead < 0.0;  // still on its way to rest
  // So is what a stop that was taken back brings to rest first.
  constexpr int kRest = 20;  // ms for which it has to be slow
  const bool slow = std::abs(now.velocity) < 0.1 * traits_.standstill;
  coming_to_rest_ = now.stop.cause != StopCause::none ? kRest
                    : slow                            ? std::max(coming_to_rest_ - 1, 0)
                    : coming_to_rest_ > 0             ? kRest
                                                      : 0;
  const bool held = pressed && !inward && coming_to_rest_ == 0 && now.enabled &&
                    now.stop.cause == StopCause::none &&
                    (now.mode == 8 || now.mode == 9 || (now.mode == 3 && stopped_by_switch_[side]));
  const bool follows = now.follows_bit && (now.statusword & 0x1000) != 0;
  if (count(follows_bit_, follows && (held || now.stop.cause != StopCause::none || !now.enabled))) {
    violate(Invariant::follows, now.time,
            joined("bit 12 is 1 although ",
                   held ? std::string_view("a limit switch") : to_text(now.stop.cause),
                   " holds the axis (mode ", now.mode, ", statusword ", now.statusword, ")"));
  }
  if (count(limit_missing_, held && (now.statusword & 0x0800) == 0)) {
    violate(Invariant::internal_limit, now.time,
            joined("bit 11 is 0 although a limit switch holds the axis (mode ", now.mode,
                   ", statusword ", now.statusword, ")"));
  }
}

void DriveInvariants::judge_actual_values(const Sample& now) {
  const auto count = [](int& milliseconds, bool wrong) {
    milliseconds = wrong ? milliseconds + 1 : 0;
    return milliseconds > kBitTime;
  };
  if (traits_.shaft_is_counter) {
    return;
  }
  if (now.position_renamed || !reference_) {
    position_off_ = 0;
    reference_ = now.shown_position - now.position;
    reference_error_ = kLag * std::abs(now.velocity);
  }
  const double error = now.shown_position - now.position - *reference_;
  if (count(position_off_, std::abs(error) > traits_.position_error + reference_error_ +
                                                 kLag * std::abs(now.velocity))) {
    violate(Invariant::shown_position, now.time, joined("6064h is ", error, " rev from the shaft"));
  }
  const auto [slowest, fastest] = std::minmax_element(speeds_.begin(), speeds_.end());
  if (count(velocity_off_, now.shown_velocity < *slowest - traits_.velocity_error ||
                               now.shown_velocity > *fastest + traits_.velocity_error)) {
    violate(Invariant::shown_velocity, now.time,
            joined("606Ch is ", now.shown_velocity, " rev/s, the shaft turns with ", now.velocity));
  }
}

void DriveInvariants::judge_stage(const Sample& now) {
  const auto count = [](int& milliseconds, bool wrong) {
    milliseconds = wrong ? milliseconds + 1 : 0;
    return milliseconds > 5;
  };
  // Above its no-load speed the EMF drives currents that no voltage of the bridge holds up, and the
  // regulators need some time to be of use again. A shaft that stands in a moment leaves the angle
  // behind that the drive works with.
  constexpr int kAfterJam = 100;  // ms
  since_jam_ = now.jammed ? 0 : since_jam_ + 1;
  const bool too_fast =
      std::abs(now.velocity) >= 0.75 * traits_.no_load_velocity * std::min(now.supply, now.source);
  const bool too_much = now.current > now.current_limit + traits_.current_allowance;
  saturated_ = now.power && (too_fast || (saturated_ && too_much));
  const bool regulated = since_jam_ > kAfterJam && !saturated_;
  if (count(current_off_, now.power && regulated && too_much)) {
    violate(Invariant::current, now.time,
            joined("the motor has ", now.current, " A, ", now.current_limit, " are allowed"));
  }
  if (count(overvoltage_on_, now.power && now.supply > traits_.overvoltage)) {
    violate(Invariant::supply, now.time,
            joined("the bridge feeds a supply of ", now.supply, " V, it has to be off above ",
                   traits_.overvoltage));
  }
  work_ += std::max(0.0, now.load * now.velocity * kTurn) * kPeriod;
  if (now.supplied_energy < -work_ - 0.5) {
    violate(Invariant::supply, now.time,
            joined("the motor has fed back ", -now.supplied_energy, " J, the load gave ", work_));
  }
}

}  // namespace stator::tests
