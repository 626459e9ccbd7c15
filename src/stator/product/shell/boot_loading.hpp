#pragma once

#include <cstddef>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/product/device/firmware_memory.hpp"
#include "stator/tmcl/sessions/module_interface.hpp"

namespace stator::product {

/// Tells that the firmware starts with a new image of `size` bytes, by the product's rule; null: by
/// the one of all that have none.
void report_new_firmware(std::size_t size, const base::EventRule* rule,
                         const base::EventReporter& reporter, base::SimTime now);

/// The boot loader of `loader` was told to start the firmware: the image that was loaded through
/// it, if any, is the one in `memory` from now on, which is told by report_new_firmware().
void keep_loaded_image(const tmcl::ModuleInterface& loader, FirmwareMemory& memory,
                       const base::EventRule* rule, const base::EventReporter& reporter,
                       base::SimTime now);

}  // namespace stator::product
