#include "stator/devices/tmcc160/objects.hpp"

#include "stator/canopen/eds/eds.hpp"
#include "stator/devices/tmcc160/object_groups.hpp"

namespace stator::devices::tmcc160 {

void add_objects(dictionary::Dictionary& dictionary, const Options& options) {
  add_communication_objects(dictionary, options);
  add_pdo_objects(dictionary);
  add_controller_objects(dictionary);
  add_sensor_objects(dictionary);
  add_module_objects(dictionary, options);
  add_profile_drive_objects(dictionary, options);
  add_profile_motion_objects(dictionary, options);
  if (options.eds) {
    canopen::add_eds_objects(dictionary);
  }
  dictionary.finish();
}

}  // namespace stator::devices::tmcc160
