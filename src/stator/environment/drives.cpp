#include "stator/environment/drives.hpp"

#include "stator/environment/servo_drives.hpp"
#include "stator/environment/stepper_drives.hpp"

namespace stator::environment {

std::size_t action_size(PlantKind plant, ActionKind action) {
  switch (action) {
    case ActionKind::current:
      return 1;
    case ActionKind::voltage:
      return 2;
    case ActionKind::duty:
      break;
  }
  return plant == PlantKind::servo ? 3 : 2;
}

std::unique_ptr<Drives> make_drives(const EnvironmentSettings& settings, const Scales& scales,
                                    std::size_t axes) {
  if (settings.plant == PlantKind::stepper) {
    return std::make_unique<StepperDrives>(settings, scales, axes);
  }
  if (settings.precision == Precision::single_precision) {
    return std::make_unique<ServoDrives<float>>(settings, scales, axes);
  }
  return std::make_unique<ServoDrives<double>>(settings, scales, axes);
}

}  // namespace stator::environment
