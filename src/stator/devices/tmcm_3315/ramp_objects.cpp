#include "stator/devices/tmcm_3315/ramp_objects.hpp"

namespace stator::devices::tmcm_3315 {

RampObjects::RampObjects(const dictionary::Dictionary& dictionary, std::uint16_t index_offset) {
  const auto bind = [&]<typename T>(dictionary::Variable<const T>& variable, unsigned index) {
    variable = dictionary.variable<T>(static_cast<std::uint16_t>(index + index_offset), 0);
  };
  bind(start_velocity_, 0x2010);
  bind(start_acceleration_, 0x2011);
  bind(break_velocity_, 0x2012);
  bind(final_deceleration_, 0x2013);
  bind(stop_deceleration_, 0x2014);
  bind(bow_factor_, 0x2015);
}

void RampObjects::configure(drive::AxisSettings& settings) const {
  const drive::MotionUnits& units = settings.units;
  settings.ramp = {.start_velocity = units.velocity(start_velocity_.get()),
                   .start_acceleration = units.acceleration(start_acceleration_.get()),
                   .break_velocity = units.velocity(break_velocity_.get()),
                   .final_deceleration = units.acceleration(final_deceleration_.get()),
                   .stop_deceleration = units.acceleration(stop_deceleration_.get()),
                   .bow_factor = static_cast<double>(bow_factor_.get())};
}

}  // namespace stator::devices::tmcm_3315
