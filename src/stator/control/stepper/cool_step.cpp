#include "stator/control/stepper/cool_step.hpp"

#include <algorithm>
#include <array>

namespace stator::control {

namespace {

constexpr std::array<int, 4> kMeasurementsPerStepDown{32, 8, 2, 1};
constexpr std::array<int, 4> kStepsUp{1, 2, 4, 8};

}  // namespace

void CoolStep::measured(const CoolStepSettings& settings, std::uint8_t run_current,
                        int stall_guard) {
  const int full = run_current / 8;
  const int lowest = full / (settings.minimum == 0 ? 2 : 4);
  int reduction = reduction_;
  if (stall_guard < settings.lower_threshold()) {
    reduction -= kStepsUp[settings.up_step & 3U];
    high_measurements_ = 0;
  } else if (stall_guard > settings.upper_threshold()) {
    if (++high_measurements_ >= kMeasurementsPerStepDown[settings.down_step & 3U]) {
      high_measurements_ = 0;
      ++reduction;
    }
  } else {
    high_measurements_ = 0;
  }
  reduction_ = static_cast<std::uint8_t>(std::clamp(reduction, 0, full - lowest));
}

}  // namespace stator::control
