#include "drive/homing_mode.hpp"

#include "drive/control_words.hpp"

namespace stator::drive {

namespace {
constexpr int kPresentPositionIsHome = 35;
}

void Homing::on_controlword(const ModeContext& context, std::uint16_t previous,
                            std::uint16_t present) {
  if ((present & ~previous & controlword::kHomingStart) == 0) {
    return;
  }
  attained_ = context.objects.homing_method.get() == kPresentPositionIsHome;
  if (attained_) {
    context.motion.set_position(0);
    context.feedback.set_position(0);
  }
}

std::uint16_t Homing::status(const ModeContext& /*context*/) const {
  return attained_ ? statusword::kTargetReached | statusword::kHomeAttained : std::uint16_t{0};
}

}  // namespace stator::drive
