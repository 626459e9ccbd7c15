#include "stator/product/shell/boot_loading.hpp"

#include <cstddef>
#include <span>

namespace stator::product {

void keep_loaded_image(const tmcl::ModuleInterface& loader, FirmwareMemory& memory,
                       const base::EventRule& new_firmware, const base::EventReporter& reporter,
                       base::SimTime now) {
  const std::span<const std::byte> image = loader.loaded_image();
  if (image.empty()) {
    return;
  }
  // It fits, since the boot loader has no more memory; what cannot be kept leaves the old one.
  static_cast<void>(memory.open_for_writing("boot loader"));
  static_cast<void>(memory.append(image));
  static_cast<void>(memory.commit());
  reporter.report(now, new_firmware, {base::EventArgument(image.size())});
}

}  // namespace stator::product
