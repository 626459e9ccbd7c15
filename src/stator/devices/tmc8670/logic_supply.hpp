#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"

namespace stator::devices::tmc8670 {

/// What the document says of one of the chip's supplies, V.
struct LogicRail {
  base::StaticText name;
  double nominal = 0.0;
  double operating_minimum = 0.0;  ///< L2657-L2660
  double operating_maximum = 0.0;
  double absolute_minimum = 0.0;  ///< L2645-L2648
  double absolute_maximum = 0.0;
};
inline constexpr std::array<LogicRail, 2> kLogicRails{{
    {"VDD_3V3", 3.3, 3.15, 3.45, -0.3, 3.63},
    {"VDD_1V2", 1.2, 1.14, 1.26, -0.3, 1.32},
}};

/// The supplies of the chip's logic, which regulators of the board make (F-124). Outside the range
/// of operation the chip is held in reset; beyond the absolute maximum ratings it is damaged for
/// good.
class LogicSupply {
 public:
  explicit LogicSupply(base::EventReporter reporter) : reporter_(reporter) {}

  /// A regulator gives another voltage from `now` on. Nothing harms a chip whose board is off.
  void set_voltage(std::size_t rail, double volts, base::SimTime now);
  /// The board's regulators are switched on or off.
  void switch_on(bool on, base::SimTime now);

  /// The chip runs: regulators on, both supplies in range, never damaged.
  [[nodiscard]] bool good() const { return state_ == State::good; }
  [[nodiscard]] bool switched_on() const { return on_; }

 private:
  enum class State : std::uint8_t { good, off, low_or_high, damaged };

  void judge(base::SimTime now);

  base::EventReporter reporter_;
  std::array<double, kLogicRails.size()> volts_{kLogicRails[0].nominal, kLogicRails[1].nominal};
  bool on_ = true;
  State state_ = State::good;
};

}  // namespace stator::devices::tmc8670
