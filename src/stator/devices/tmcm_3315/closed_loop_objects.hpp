#pragma once

#include <cstdint>

#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/stepper/stepper_axis.hpp"

namespace stator::devices::tmcm_3315 {

/// The objects of closed-loop operation of one axis (document §1.5, §4.2.17-4.2.34, §4.2.63).
class ClosedLoopObjects {
 public:
  ClosedLoopObjects(dictionary::Dictionary& dictionary, std::uint16_t index_offset);

  /// Writes settings.closed_loop; settings.units and the microstep resolution must be there.
  void configure(const drive::MotionUnits& units, drive::StepperSettings& settings) const;
  /// Takes an offset that was written and shows the axis's own values.
  void exchange(drive::StepperAxis& axis);

 private:
  dictionary::Variable<std::uint8_t> mode_;                // 2020h
  dictionary::Variable<std::uint32_t> position_gain_;      // 2021h
  dictionary::Variable<std::uint8_t> tolerance_;           // 2022h
  dictionary::Variable<std::uint16_t> beta_;               // 2027h
  dictionary::Variable<std::int32_t> offset_;              // 2028h
  dictionary::Variable<std::uint8_t> minimum_scale_;       // 2029h
  dictionary::Variable<std::uint8_t> maximum_scale_;       // 202Ah
  dictionary::Variable<std::uint32_t> catch_up_gain_;      // 202Bh
  dictionary::Variable<std::uint32_t> catch_up_integral_;  // 202Ch
  dictionary::Variable<std::uint16_t> error_sum_limit_;    // 202Dh
  dictionary::Variable<std::uint32_t> catch_up_velocity_;  // 202Fh
  dictionary::Variable<std::uint32_t> upscale_delay_;      // 2030h
  dictionary::Variable<std::uint32_t> downscale_delay_;    // 2031h
  dictionary::Variable<std::uint8_t> actual_scale_;        // 2033h
  dictionary::Variable<std::uint32_t> weakening_start_;    // 2034h
  dictionary::Variable<std::uint32_t> weakening_range_;    // 2035h
  dictionary::Variable<std::uint8_t> gamma_;               // 2036h
  dictionary::Variable<std::uint8_t> initialised_;         // 2120h
  std::int32_t shown_offset_ = 0;
};

}  // namespace stator::devices::tmcm_3315
