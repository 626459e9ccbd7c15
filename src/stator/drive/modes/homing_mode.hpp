#pragma once

#include <cstdint>

#include "stator/drive/modes/hard_stop_search.hpp"
#include "stator/drive/modes/homing_methods.hpp"
#include "stator/drive/modes/operating_mode.hpp"

namespace stator::drive {

/// Homing (CiA 402-2 §11). Bit 4 of the controlword runs the method of 6098h once: its rising edge
/// in this mode or its level, as ProfileBehaviour::homing_starts_on_edge says; 0 stops it. A method
/// that moves needs an enabled drive, methods 35 and 37 do not: they wait until the motor stands.
///
/// The switch is searched with 6099h:01. Once it is pressed the motor turns round with 609Ah and
/// leaves it with 6099h:02, where PositionCapture holds the point; an edge passed faster does not
/// count, the switch is searched again. The motor then stops, goes back to the point and stands on
/// home, and the positions become relative to it: -607Ch there. Methods on hard stops are
/// HardStopSearch's. Whatever method begins ends the scaling of positions by an earlier one. How
/// fast the motor is and whether it is there, a servo axis asks its shaft.
///
/// Statusword bits 10 and 12: both 0 while homing runs, both 1 on home, 10 alone when homing was
/// stopped before and the motor stands. A start clears what the run before left. With
/// ProfileBehaviour::homing_by_profile halt holds a run, with bit 10 once the motor stands, and its
/// end continues it; an error sets bit 13 and ends the run, with bit 10 once the motor stands; and
/// bit 10 is set before the first start too.
class Homing final : public OperatingMode {
 public:
  [[nodiscard]] ModeCode code() const override { return ModeCode::homing; }
  void enter(const ModeContext& context) override;
  /// The run stays; tick() only looks until halt ends.
  void resume(const ModeContext& context) override;
  void start(const ModeContext& context) override;
  void on_controlword(const ModeContext& context, std::uint16_t previous,
                      std::uint16_t present) override;
  void tick(const ModeContext& context) override;
  [[nodiscard]] std::uint16_t status(const ModeContext& context) const override;
  /// How often home was found.
  [[nodiscard]] std::uint32_t completions() const { return completions_; }
  /// A method is under way.
  [[nodiscard]] bool runs() const { return outcome_ == Outcome::running; }

 private:
  enum class Stage : std::uint8_t {
    waiting,    ///< for bit 4
    naming,     ///< the present position, once the motor stands
    searching,  ///< fast, for the switch
    leaving,    ///< slowly, for the point where the switch is released, and for the index behind
    indexing,   ///< slowly, for the index alone
    returning,  ///< to the point held
    pushing,    ///< against hard stops
    done,       ///< until bit 4 is 0
  };
  enum class Outcome : std::uint8_t { none, running, interrupted, failed, attained };

  void begin(const ModeContext& context);
  void interrupt(const ModeContext& context);
  void fail(const ModeContext& context, const base::EventRule& rule);
  void name_present_position(const ModeContext& context);
  void look(const ModeContext& context);
  void search(const ModeContext& context);
  void leave(const ModeContext& context);
  void await_capture(const ModeContext& context);
  void command_motion(const ModeContext& context);
  void finish(const ModeContext& context);
  void attain();
  /// What keeps the method from starting; null: nothing does.
  [[nodiscard]] const base::EventRule* obstacle(const ModeContext& context) const;
  void explain(const ModeContext& context, const base::EventRule& rule) const;

  [[nodiscard]] PassedSwitches passed_switches() const;
  [[nodiscard]] bool is_home(const ModeContext& context) const;
  [[nodiscard]] static std::int64_t home_position(const ModeContext& context);
  [[nodiscard]] bool pressed(const ModeContext& context) const;
  [[nodiscard]] bool limit_reached(const ModeContext& context) const;
  [[nodiscard]] double velocity(const ModeContext& context) const;
  [[nodiscard]] bool travels_forward(const ModeContext& context) const;
  [[nodiscard]] bool slow_enough(const ModeContext& context) const;
  [[nodiscard]] std::int64_t captured_position(const ModeContext& context) const;

  const HomingMethod* method_ = nullptr;  ///< in force while running
  Stage stage_ = Stage::waiting;
  Outcome outcome_ = Outcome::none;
  int direction_ = 0;         ///< of travel, 1 or -1
  bool was_pressed_ = false;  ///< leaving: in the control period before
  int limits_met_ = 0;        ///< limit switches that have turned the search round
  HardStopSearch hard_stop_;
  std::uint32_t completions_ = 0;
};

}  // namespace stator::drive
