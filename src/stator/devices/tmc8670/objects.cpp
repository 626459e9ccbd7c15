#include "stator/devices/tmc8670/objects.hpp"

#include "stator/devices/tmc8670/object_groups.hpp"

namespace stator::devices::tmc8670 {

void add_objects(dictionary::Dictionary& dictionary) {
  add_communication_objects(dictionary);
  add_pdo_objects(dictionary);
  add_foc_objects(dictionary);
  add_firmware_objects(dictionary);
  add_profile_drive_objects(dictionary);
  add_profile_motion_objects(dictionary);
  dictionary.finish();
}

}  // namespace stator::devices::tmc8670
