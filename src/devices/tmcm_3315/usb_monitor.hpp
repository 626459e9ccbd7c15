#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/event.hpp"
#include "base/sim_time.hpp"
#include "devices/tmcm_3315/module_io.hpp"
#include "devices/tmcm_3315/objects.hpp"
#include "dictionary/dictionary.hpp"
#include "tmcl/module_interface.hpp"

namespace stator::devices::tmcm_3315 {

/// An axis parameter of TMCL and the object whose value it shows; index of axis 0.
struct ReadableParameter {
  std::uint8_t number;
  std::string_view name;
  std::uint16_t index;
  std::uint8_t subindex = 0;
  std::uint8_t first_bit = 0;
  std::uint8_t bits = 32;
};

/// The axis parameters that can be read by USB, in ascending order of their numbers.
[[nodiscard]] std::span<const ReadableParameter> readable_parameters();

/// The USB interface of the module (L26): binary TMCL that reads values and moves nothing. Commands
/// and numbers are those of the maker's other stepper modules, since this module's document names
/// none: GAP, GGP, GIO and the firmware version. What would move or change something is answered
/// with "command not available". The command that starts the boot loader is obeyed: through it
/// firmware is loaded (L90), with the module's drives and its EtherCAT firmware at rest.
class UsbMonitor final : public tmcl::ModuleInterface {
 public:
  /// `dictionary` and `io` must outlive the monitor; `firmware_capacity`: of the memory, bytes.
  UsbMonitor(const dictionary::Dictionary& dictionary, const ModuleIo& io, FirmwareVersion firmware,
             std::size_t firmware_capacity, base::EventReporter reporter);

 private:
  [[nodiscard]] Answer execute(const tmcl::Request& request, base::SimTime now) override;
  [[nodiscard]] Answer get_axis_parameter(const tmcl::Request& request) const;
  [[nodiscard]] Answer get_input(const tmcl::Request& request) const;
  [[nodiscard]] static Answer get_global_parameter(const tmcl::Request& request, base::SimTime now);

  const ModuleIo& io_;
  /// In the order of readable_parameters(), for each axis.
  std::array<std::vector<const dictionary::Entry*>, kAxisCount> sources_;
};

}  // namespace stator::devices::tmcm_3315
