#pragma once

#include <cstdint>

namespace stator::mfc {

/// One step and direction channel in ticks of its 25 MHz clock, in closed form (TMC8461 datasheet
/// L9563-L9753): any time passes in a few operations, except that each compare match and each
/// reached target takes some of its own.
///
/// Steps come at start + ceil(k 2^32 / |c|) ticks for k = 1, 2, ..., with c the step rate and
/// start = write + SD_DELAY + 3 (A-54; decisions G-10 and following). What was written is at once
/// in force.
class StepChannel {
 public:
  static constexpr std::int64_t kNever = INT64_MAX;

  /// SD_CFG of one channel.
  struct Configuration {
    bool enable = false;
    bool continuous = false;
    bool use_next_rate = false;
    friend constexpr bool operator==(const Configuration&, const Configuration&) = default;
  };
  /// What happened at a step.
  struct Event {
    std::int64_t tick = kNever;
    bool target_reached = false;
    bool compare = false;
  };

  /// Makes the next event (target, compare) up to and at `tick`, with all steps before it;
  /// event.tick is kNever if there is none: then all steps up to `tick` have been made.
  Event advance(std::int64_t tick);

  void write_rate(std::int32_t rate);
  void write_target(std::uint32_t steps);
  void write_configuration(Configuration configuration);
  void write_compare(std::int32_t compare) {
    compare_ = compare;
    plan();
  }
  void write_next_rate(std::int32_t rate) { next_rate_ = rate; }
  void write_length(std::uint16_t ticks) { length_ = ticks; }
  void write_delay(std::uint16_t ticks) { delay_ = ticks; }
  void clear_count() {
    count_ = 0;
    plan();
  }
  /// With false a new rate of the same sign keeps the accumulator and waits for nothing (G-11).
  void set_restart_on_new_rate(bool restart) { restart_on_new_rate_ = restart; }

  [[nodiscard]] std::int32_t rate() const { return rate_; }
  [[nodiscard]] std::uint32_t remaining() const { return remaining_; }
  [[nodiscard]] std::int32_t count() const { return static_cast<std::int32_t>(count_); }
  [[nodiscard]] std::int32_t compare() const { return compare_; }
  [[nodiscard]] std::int32_t next_rate() const { return next_rate_; }
  [[nodiscard]] std::uint16_t length() const { return length_; }
  [[nodiscard]] std::uint16_t delay() const { return delay_; }
  [[nodiscard]] const Configuration& configuration() const { return configuration_; }
  /// Steps since power-on, forwards minus backwards; nothing clears it.
  [[nodiscard]] std::int64_t total_steps() const { return total_; }
  /// Whether steps come by themselves: enabled, a rate, and something left to do.
  [[nodiscard]] bool running() const;

  /// The pulse of the last step has not ended.
  [[nodiscard]] bool pulse() const { return now_ < pulse_end_; }
  /// Backwards: rate below 0.
  [[nodiscard]] bool direction() const { return rate_ < 0; }

  /// Tick of the next step; kNever if none comes.
  [[nodiscard]] std::int64_t next_step() const;
  /// Tick at which pulse() next changes. Pulses that touch are one.
  [[nodiscard]] std::int64_t next_edge() const;
  /// Tick of the next reached target or compare match.
  [[nodiscard]] std::int64_t next_event() const { return event_; }

 private:
  void start();
  void plan();
  [[nodiscard]] std::uint64_t steps_until(std::int64_t tick) const;
  [[nodiscard]] std::int64_t tick_of_step(std::uint64_t step) const;
  [[nodiscard]] std::uint64_t steps_to_event() const;
  void make_steps(std::uint64_t steps);
  void pass_to(std::int64_t tick);
  void pulse_from_last_step();

  Configuration configuration_;
  std::int32_t rate_ = 0;
  std::int32_t next_rate_ = 0;
  std::int32_t compare_ = 0;
  std::uint32_t remaining_ = 0;
  std::uint32_t count_ = 0;
  std::int64_t total_ = 0;
  std::uint16_t length_ = 0;
  std::uint16_t delay_ = 0;
  bool restart_on_new_rate_ = true;
  std::int64_t now_ = 0;
  std::int64_t origin_ = 0;        ///< the accumulator had this value then, at now_ or later
  std::uint32_t accumulator_ = 0;  ///< magnitude: |c| is added, and each carry is a step
  std::int64_t pulse_end_ = 0;
  std::int64_t event_ = kNever;  ///< next_event(): steps on the way to it do not move it
};

}  // namespace stator::mfc
