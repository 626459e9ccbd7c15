#pragma once

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/product/device/firmware_memory.hpp"
#include "stator/tmcl/sessions/module_interface.hpp"

namespace stator::product {

/// The boot loader of `loader` was told to start the firmware: the image that was loaded through
/// it, if any, is the one in `memory` from now on, which `new_firmware` reports with its size in
/// bytes.
void keep_loaded_image(const tmcl::ModuleInterface& loader, FirmwareMemory& memory,
                       const base::EventRule& new_firmware, const base::EventReporter& reporter,
                       base::SimTime now);

}  // namespace stator::product
