#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "devices/drive_sequences/recording.hpp"

namespace stator::tests {

/// What holds for every drive at every moment, whatever it is commanded.
enum class Invariant : std::uint8_t {
  stops,
  demand_on_ramp,
  behind_switch,
  behind_software_limit,
  power_off,
  halt_reached,
  target_reached,
  follows,
  internal_limit,
  shown_position,
  shown_velocity,
  current,
  supply,
  numbers,
  runs_for_ever,
  works_afterwards,
};
inline constexpr std::size_t kInvariants = 16;
[[nodiscard]] std::string_view to_text(Invariant invariant);
/// The clause or the reason it rests on.
[[nodiscard]] std::string_view reason_of(Invariant invariant);

struct DriveViolation {
  Invariant invariant{};
  base::SimTime time;
  std::string text;
};

/// The speed that a shaft may still have while it is being stopped: what it had at the begin, minus
/// what the weaker of ramp and motor takes away, with a fifth more time and the drive's reaction.
class StoppingEnvelope {
 public:
  void begin(double speed, double position = 0.0);
  void end() { active_ = false; }
  [[nodiscard]] bool active() const { return active_; }
  [[nodiscard]] double begin_speed() const { return begin_speed_; }
  /// A millisecond passes; `speed` in the direction (-1 or 1) that is judged.
  void pass(const Sample& sample, const DriveTraits& traits, double deceleration, double speed,
            double direction);
  [[nodiscard]] double allowed() const { return allowed_; }
  /// The shaft has moved on by more than DriveTraits::settle, faster than allowed all the time:
  /// what overshoots on a loop's way to rest is none.
  [[nodiscard]] bool exceeded(const DriveTraits& traits, double speed, double tolerance);
  /// The same of a limit, which allows a way: the shaft went further, or goes on at the end of it.
  [[nodiscard]] bool overrun(const DriveTraits& traits, double way, double speed,
                             double disturbance);
  [[nodiscard]] double begin_position() const { return begin_position_; }
  [[nodiscard]] double allowed_way() const { return allowed_way_; }

 private:
  bool active_ = false;
  double begin_speed_ = 0.0;
  double gentlest_ = 0.0;  ///< rev/s², since the begin: a drive need not take up a changed ramp
  double ramp_ = 0.0;      ///< rev/s, where the ramp is
  double allowed_ = 0.0;   ///< and the shaft behind it
  double waited_ = 0.0;    ///< s of the reaction time
  double excess_ = 0.0;    ///< rev
  double begin_position_ = 0.0;
  double allowed_way_ = 0.0;  ///< rev
};

/// Looks at a recording sample by sample, a millisecond each, and stops at the first violation.
class DriveInvariants {
 public:
  explicit DriveInvariants(const DriveTraits& traits, std::set<Invariant> excepted = {})
      : traits_(traits), excepted_(std::move(excepted)) {}

  void see(const Sample& now);
  [[nodiscard]] const std::optional<DriveViolation>& violation() const { return violation_; }
  /// For what is found otherwise, as at the end of a sequence.
  void violate(Invariant invariant, base::SimTime time, std::string text);

 private:
  void judge_stop(const Sample& now);
  void judge_demand(const Sample& now);
  [[nodiscard]] bool takes_over_shaft(const Sample& now, double limit) const;
  void judge_switches(const Sample& now);
  void judge_software_limits(const Sample& now);
  /// What moves against a limit that `holds` in the direction `outward`.
  void judge_outward(Invariant invariant, StoppingEnvelope& envelope, const Sample& now, bool holds,
                     double outward, double deceleration);
  void judge_power(const Sample& now);
  void judge_bits(const Sample& now);
  void judge_actual_values(const Sample& now);
  void judge_stage(const Sample& now);
  [[nodiscard]] bool numbers_are_finite(const Sample& now) const;
  /// rev/s that a change of load can still be seen with.
  void follow_disturbance(const Sample& now);

  DriveTraits traits_;
  std::set<Invariant> excepted_;
  std::optional<DriveViolation> violation_;
  std::optional<Sample> before_;
  std::array<bool, 2> stopped_by_switch_{};  ///< it was pressed while the demand led outward
  StoppingEnvelope stop_;
  std::array<StoppingEnvelope, 2> switch_;  ///< outward at the negative and the positive one
  std::array<StoppingEnvelope, 2> limit_;
  double disturbance_ = 0.0;
  int since_stop_ = 1000;     ///< ms since a stop began, or a limit began to hold
  int since_change_ = 1000;   ///< ms since the demand might be anything
  int since_power_ = 1000;    ///< ms since power came on or went off
  int halted_bit_ = 0;        ///< ms for which bit 10 has been 1 in halt with a turning shaft
  int reached_bit_ = 0;       ///< ms for which bit 10 has been 1 off the target
  int follows_bit_ = 0;       ///< ms for which bit 12 has been 1 although something holds the axis
  int limit_missing_ = 0;     ///< ms for which bit 11 has been 0 in the same way
  int position_off_ = 0;      ///< ms for which 6064h has been wrong
  int velocity_off_ = 0;      ///< ms
  int current_off_ = 0;       ///< ms
  int coming_to_rest_ = 0;    ///< ms for which the shaft has to be slow after a stop
  double stop_ramp_ = 0.0;    ///< rev/s², of a stop whose demand has not come down yet
  int powered_although_ = 0;  ///< ms for which the bridge has been on against a command
  bool saturated_ = false;    ///< the current is what the EMF makes of it
  int since_jam_ = 1000;      ///< ms
  int overvoltage_on_ = 0;    ///< ms
  double work_ = 0.0;         ///< J the load did on the shaft
  std::optional<double> reference_;  ///< 6064h minus the position of the plant
  double reference_error_ = 0.0;     ///< rev by which it may be wrong
  std::array<double, 20> speeds_{};  ///< rev/s, of the last 20 ms
  std::size_t speed_ = 0;
};

}  // namespace stator::tests
