#pragma once

#include <cstdint>
#include <span>

#include "stator/base/event.hpp"
#include "stator/devices/tmcm_3315/module_io.hpp"
#include "stator/devices/tmcm_3315/objects.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/product/shell/tmcl_monitor.hpp"

namespace stator::devices::tmcm_3315 {

/// The axis parameters that can be read by USB, in ascending order of their numbers.
[[nodiscard]] std::span<const product::ReadableParameter> readable_parameters();

/// The USB interface of the module (L26). Commands and numbers are those of the maker's other
/// stepper modules, since this module's document names none; firmware is loaded through it (L90).
class UsbMonitor final : public product::TmclMonitor {
 public:
  using TmclMonitor::IndexOffsets;

  /// `dictionary` and `io` must outlive the monitor; `firmware_capacity`: of the memory, bytes.
  UsbMonitor(const dictionary::Dictionary& dictionary, const ModuleIo& io, FirmwareVersion firmware,
             std::size_t firmware_capacity, base::EventReporter reporter);

 private:
  [[nodiscard]] Answer get_input(const tmcl::Request& request) const override;

  const ModuleIo& io_;
};

}  // namespace stator::devices::tmcm_3315
