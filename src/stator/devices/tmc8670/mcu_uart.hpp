#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/event.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/product/shell/tmcl_monitor.hpp"

namespace stator::devices::tmc8670 {

/// The axis parameters that can be read by the MCU UART, in ascending order of their numbers.
[[nodiscard]] std::span<const product::ReadableParameter> readable_parameters();

/// The UART into the processor (L268, L734): TMCL at 115200 bit/s. Numbers are those of the
/// maker's servo modules, since the chip's document names none; GIO reads the reference switches.
/// Firmware is loaded through its boot loader, without a master.
class McuUart final : public product::TmclMonitor {
 public:
  static constexpr std::uint32_t kBaudRate = 115'200;

  /// `dictionary` outlives the UART; `firmware_capacity`: of the memory, bytes.
  McuUart(const dictionary::Dictionary& dictionary, std::size_t firmware_capacity,
          base::EventReporter reporter);

 private:
  [[nodiscard]] Answer get_input(const tmcl::Request& request) const override;

  dictionary::Variable<const std::uint32_t> digital_inputs_;  // 60FDh
  dictionary::Variable<const std::uint32_t> supply_voltage_;  // 6079h, mV
};

}  // namespace stator::devices::tmc8670
