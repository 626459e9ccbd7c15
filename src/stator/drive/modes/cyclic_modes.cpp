#include "stator/drive/modes/cyclic_modes.hpp"

#include "stator/drive/power/control_words.hpp"

namespace stator::drive {

void CyclicPosition::on_target(const ModeContext& context) {
  context.motion.follow_position(context.motion.cyclic(context.objects.target_position.get(),
                                                       context.objects.position_offset.get()));
  if (context.settings.behaviour.offsets_feed_forward) {
    context.motion.feed_forward(
        {.velocity = context.settings.velocity_of(context.objects.velocity_offset.get()),
         .torque = context.settings.torque_of(context.objects.torque_offset.get())});
  }
}

std::uint16_t CyclicPosition::status(const ModeContext& context) const {
  const bool followed = context.enabled && context.motion.follows_target();
  std::uint16_t bits = followed ? statusword::kTargetUsed : std::uint16_t{0};
  if (context.following_error) {
    bits |= statusword::kFollowingError;
  }
  return bits;
}

void CyclicVelocity::on_target(const ModeContext& context) {
  const std::int64_t target =
      std::int64_t{context.objects.target_velocity.get()} + context.objects.velocity_offset.get();
  context.motion.follow_velocity(context.settings.velocity_of(target));
  if (context.settings.behaviour.offsets_feed_forward) {
    context.motion.feed_forward(
        {.torque = context.settings.torque_of(context.objects.torque_offset.get())});
  }
}

std::uint16_t CyclicVelocity::status(const ModeContext& context) const {
  const bool followed = context.enabled && context.motion.follows_target();
  return followed ? statusword::kTargetUsed : std::uint16_t{0};
}

}  // namespace stator::drive
