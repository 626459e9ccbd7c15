#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "stator/control/foc/foc_block.hpp"
#include "stator/drive/axis/axis.hpp"
#include "stator/drive/foc/foc_commutation.hpp"
#include "stator/drive/foc/foc_settings.hpp"
#include "stator/drive/foc/touch_probe.hpp"

namespace stator::drive {

/// What the firmware sees in a PWM period beside the FOC block.
struct FocObservation {
  std::array<bool, 2> probe{};  ///< levels of the touch probe inputs 1 and 2
  base::SimTime now;            ///< what touch probe time stamps count, e.g. system time
};

/// A CiA 402 axis whose stage is a FOC block, as the firmware of a TMC8670 makes it: motor and
/// sensors exist for it only as registers of the block. See Axis for the calls; tick() every 125 us
/// writes set-points, in between the block runs alone.
///
/// Positions are units of 608Fh; PID_POSITION_ACTUAL, of 65536 per revolution, is counted on beyond
/// its 32 bits. Targets reach the block with the ramp's fraction of a unit. Which loop is closed:
/// position in pp, hm and csp, velocity in pv and csv and for every stop, whatever mode it ends,
/// torque in tq and cst. Registers that others may write as well (a UART) are written when
/// the axis wants something else than before; targets, while the bridge is on, in every period.
///
/// Objects that belong to the firmware loop (6063h, 6074h, 6078h, 6079h, 60B9h to 60BDh and the
/// time stamps 60D1h to 60D4h) are kept up to date where the dictionary has them.
class FocAxis final : public Axis {
 public:
  /// Binds the axis to its objects; `block` outlives it. Throws std::logic_error if an object is
  /// missing.
  FocAxis(dictionary::Dictionary& dictionary, const AxisConfiguration& configuration,
          base::EventReporter reporter, control::foc::FocBlock& block);

  /// To be brought up to date before apply() and tick(), with settings(). Of those the axis makes
  /// itself: units, position_end, torque_unit, maximum_torque, velocity_reversed, windows and
  /// thresholds of velocity. The reference switches start as active low; left and right
  /// there are the pins.
  [[nodiscard]] FocSettings& foc_settings() { return foc_settings_; }
  [[nodiscard]] const FocSettings& foc_settings() const { return foc_settings_; }

  /// After each step of the block: captures of homing and touch probes.
  void observe(const FocObservation& seen) {
    if (homing_capture_.armed() || touch_probe_.armed()) [[unlikely]] {
      capture(seen);
    }
  }

  /// The commutation is known; false again after a failed search, until the fault reset.
  [[nodiscard]] bool commutation_known() const { return commutation_.known(); }
  /// Searches the commutation again at the next start of the bridge, e.g. because its settings have
  /// changed.
  void forget_commutation() { commutation_.forget(); }
  [[nodiscard]] const TouchProbe& touch_probe() const { return touch_probe_; }

  [[nodiscard]] double actual_velocity() const override;                   ///< units/s
  [[nodiscard]] double supply_voltage() const { return supply_voltage_; }  ///< V, 6079h
  /// A, peak, in Q: what the actual torque 6077h is made from.
  [[nodiscard]] double quadrature_current() const { return current_; }
  /// Switches as CiA 402 counts directions, after polarity: bits 0 to 2 of 60FDh.
  [[nodiscard]] SwitchStates switches() const { return conditions_.switches(); }

 private:
  static constexpr std::int64_t kBlockCounts = 65536;  ///< per revolution, of the block's positions

  /// MODE_MOTION as the axis commands it.
  enum class MotionMode : std::uint8_t { stopped = 0, torque = 1, velocity = 2, position = 3 };

  /// Objects that only this stage has; a product may lack any of them.
  struct ShownObjects {
    ShownObjects(dictionary::Dictionary& dictionary, std::uint16_t index_offset);

    OptionalVariable<std::int16_t> torque_demand;                  // 6074h
    OptionalVariable<std::int16_t> current_actual;                 // 6078h
    OptionalVariable<std::uint32_t> supply_voltage;                // 6079h, mV
    OptionalVariable<std::uint16_t> probe_function;                // 60B8h
    OptionalVariable<std::uint16_t> probe_status;                  // 60B9h
    std::array<OptionalVariable<std::int32_t>, 4> probe_position;  // 60BAh to 60BDh
    std::array<OptionalVariable<std::int16_t>, 2> probe_source;    // 60D0h:01 and :02
    std::array<OptionalVariable<std::uint32_t>, 4> probe_time;     // 60D1h to 60D4h, ns
  };

  /// What the touch probes were told.
  struct ProbeCommand {
    std::uint16_t function = 0;
    std::array<std::int16_t, 2> source{};
    friend bool operator==(const ProbeCommand&, const ProbeCommand&) = default;
  };

  /// Registers that are written on a change only, as the axis left them; empty where the bridge
  /// has just come on.
  struct Written {
    MotionMode mode = MotionMode::stopped;
    std::optional<std::int32_t> torque_flux_limit;
    std::optional<std::uint32_t> velocity_limit;
    std::optional<std::int32_t> velocity_offset;
    std::optional<std::int32_t> torque_offset;
  };

  void begin_period(base::SimTime now) override;
  void supervise_stage(base::SimTime now) override;
  void end_period() override;
  [[nodiscard]] StageStatus stage_status() const override;
  void fault_was_reset() override;
  [[nodiscard]] double torque_current() const override;
  [[nodiscard]] bool voltage_enabled() const override;
  [[nodiscard]] double shown_velocity() const override;

  void configure();
  void configure_probes();
  [[nodiscard]] double position_lead() const;
  void read_block();
  void read_switches();
  void update_conditions();
  void switch_bridge();
  void write_limits();
  void write_targets();
  void write_feed_forward(const FeedForward& ahead);
  void set_mode(MotionMode mode);
  void show();
  void capture(const FocObservation& seen);

  [[nodiscard]] std::int64_t count_at(std::int32_t position) const;
  [[nodiscard]] std::int32_t target_count() const;
  [[nodiscard]] std::int32_t block_velocity(double pps) const;
  [[nodiscard]] std::int32_t block_current(double amperes) const;
  [[nodiscard]] std::int32_t signed_block_current(double amperes) const;
  [[nodiscard]] double tapered(double torque) const;
  [[nodiscard]] double rpm() const;
  [[nodiscard]] double pps_of_rpm(double rpm) const;
  [[nodiscard]] double demanded_torque() const;
  [[nodiscard]] std::int16_t torque_object(double amperes) const;
  [[nodiscard]] SwitchLevels switch_levels_of_block() const;
  [[nodiscard]] ReferenceSettings reference() const;

  FocSettings foc_settings_;
  control::foc::FocBlock& block_;
  ShownObjects shown_;
  FocCommutation commutation_;
  TouchProbe touch_probe_;
  ProbeCommand probe_command_;
  Written written_;
  AxisErrors stage_errors_;  ///< present; shorts until the fault reset
  bool supply_low_ = true;   ///< below the limit, with hysteresis
  bool supply_high_ = false;
  bool bridge_on_ = false;         ///< as the block was told
  std::uint32_t counts_ = 0;       ///< position units per revolution, as obeyed
  bool reversed_ = false;          ///< 607Eh bit 7 as obeyed: the axis counts against the block
  std::int64_t count_ = 0;         ///< PID_POSITION_ACTUAL in 64 bits
  std::int32_t rpm_ = 0;           ///< PID_VELOCITY_ACTUAL
  double current_ = 0.0;           ///< A in Q, positive drives the axis forward
  double filtered_current_ = 0.0;  ///< A, what homing on a hard stop looks at
  double torque_demand_ = 0.0;     ///< A, as written last in tq or cst
  double supply_voltage_ = 0.0;    ///< V
  std::uint32_t index_passages_ = 0;
  std::int64_t index_count_ = 0;  ///< as count_, at the latest index pulse seen
  base::SimTime now_;
};

}  // namespace stator::drive
