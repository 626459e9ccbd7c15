#include "devices/tmcc160/objects.hpp"

#include "canopen/eds.hpp"
#include "devices/tmcc160/object_groups.hpp"

namespace stator::devices::tmcc160 {

void add_objects(dictionary::Dictionary& dictionary, bool serves_eds) {
  add_communication_objects(dictionary);
  add_pdo_objects(dictionary);
  add_controller_objects(dictionary);
  add_sensor_objects(dictionary);
  add_module_objects(dictionary);
  add_profile_drive_objects(dictionary);
  add_profile_motion_objects(dictionary);
  if (serves_eds) {
    canopen::add_eds_objects(dictionary);
  }
  dictionary.finish();
}

}  // namespace stator::devices::tmcc160
