#include "stator/devices/tmcm_3315/closed_loop_objects.hpp"

namespace stator::devices::tmcm_3315 {

ClosedLoopObjects::ClosedLoopObjects(dictionary::Dictionary& dictionary,
                                     std::uint16_t index_offset) {
  const auto bind = [&]<typename T>(dictionary::Variable<T>& variable, unsigned index) {
    variable = dictionary.variable<T>(static_cast<std::uint16_t>(index + index_offset), 0);
  };
  bind(mode_, 0x2020);
  bind(position_gain_, 0x2021);
  bind(tolerance_, 0x2022);
  bind(beta_, 0x2027);
  bind(offset_, 0x2028);
  bind(minimum_scale_, 0x2029);
  bind(maximum_scale_, 0x202A);
  bind(catch_up_gain_, 0x202B);
  bind(catch_up_integral_, 0x202C);
  bind(error_sum_limit_, 0x202D);
  bind(catch_up_velocity_, 0x202F);
  bind(upscale_delay_, 0x2030);
  bind(downscale_delay_, 0x2031);
  bind(actual_scale_, 0x2033);
  bind(weakening_start_, 0x2034);
  bind(weakening_range_, 0x2035);
  bind(gamma_, 0x2036);
  bind(initialised_, 0x2120);
}

void ClosedLoopObjects::configure(const drive::MotionUnits& units,
                                  drive::StepperSettings& settings) const {
  const auto fine_steps = static_cast<double>(
      1U << (settings.microstep_resolution < 8U ? 8U - settings.microstep_resolution : 0U));
  const auto velocity = [&](std::uint32_t object) { return units.velocity(object) * fine_steps; };
  settings.closed_loop = {.enabled = mode_.get() == 1,
                          .position_gain = position_gain_.get(),
                          .tolerance = tolerance_.get(),
                          .beta = beta_.get(),
                          .weakening_start = velocity(weakening_start_.get()),
                          .weakening_range = velocity(weakening_range_.get()),
                          .gamma = gamma_.get(),
                          .minimum_scale = minimum_scale_.get(),
                          .maximum_scale = maximum_scale_.get(),
                          .upscale_delay = upscale_delay_.get(),
                          .downscale_delay = downscale_delay_.get(),
                          .catch_up_gain = catch_up_gain_.get(),
                          .catch_up_integral = catch_up_integral_.get(),
                          .error_sum_limit = error_sum_limit_.get(),
                          .catch_up_velocity = velocity(catch_up_velocity_.get())};
}

void ClosedLoopObjects::exchange(drive::StepperAxis& axis) {
  if (offset_.get() != shown_offset_) {
    axis.set_commutation_offset(offset_.get());
  }
  const control::ClosedLoopController& loop = axis.closed_loop();
  shown_offset_ = loop.commutation_offset();
  offset_.set(shown_offset_);
  actual_scale_.set(loop.active() ? loop.current_scale() : std::uint8_t{0});
  initialised_.set(loop.active() ? 1 : 0);
}

}  // namespace stator::devices::tmcm_3315
