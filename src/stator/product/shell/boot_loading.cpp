#include "stator/product/shell/boot_loading.hpp"

#include <cstddef>
#include <span>

namespace stator::product {

namespace {

/// Argument: {0} bytes.
constexpr base::EventRule kNewFirmware{
    "new-firmware", base::Severity::information,
    "restarting with a new firmware image, {0} bytes; the virtual device keeps the image and "
    "behaves as before, it does not run it"};

}  // namespace

void report_new_firmware(std::size_t size, const base::EventRule* rule,
                         const base::EventReporter& reporter, base::SimTime now) {
  reporter.report(now, rule != nullptr ? *rule : kNewFirmware, {base::EventArgument(size)});
}

void keep_loaded_image(const tmcl::ModuleInterface& loader, FirmwareMemory& memory,
                       const base::EventRule* rule, const base::EventReporter& reporter,
                       base::SimTime now) {
  const std::span<const std::byte> image = loader.loaded_image();
  if (image.empty()) {
    return;
  }
  // The image fits, since the boot loader's memory is no larger; if it cannot be kept the old one
  // stays.
  static_cast<void>(memory.open_for_writing("boot loader"));
  static_cast<void>(memory.append(image));
  static_cast<void>(memory.commit());
  report_new_firmware(image.size(), rule, reporter, now);
}

}  // namespace stator::product
